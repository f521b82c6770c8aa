#pragma once

#include <algorithm>

#include "fpbm/geometry/detail/direction.hpp"
#include "fpbm/geometry/space.hpp"
#include "fpbm/linalg/detail/product.hpp"
#include "fpbm/linalg/detail/sums.hpp"

namespace fpbm {

/// Largest distance of a rotation from π [rad] at which FrameSpace::turn_fraction() reduces an error. The value
/// is a choice: the error at angle φ is φ (π − φ)/kTurnBand, which changes by at most π/kTurnBand = 6.3 times as much
/// as φ, so that the gain of the feedback increases by at most this factor.
template <typename Scalar>
inline constexpr Scalar kTurnBand = Scalar(0.5);
/// Selected rotation error [rad] above which a reduced error counts as slowed.
template <typename Scalar>
inline constexpr Scalar kSelectedError = Scalar(1e-4);

/// Task space of any task of a frame: poses [m, rad], or directions, which are the z axes of poses. Linear rows are
/// above angular rows, along the axes of the base frame.
struct FrameSpace {
  static constexpr int kRows = 6;
  static constexpr int kTurns = 3;
  using HasSlowedFraction = void;

  template <typename Scalar>
  struct Point {
    Transform<Scalar> at;
    bool is_axis = false;
    bool is_empty = false;        ///< For a task without rows, which has no error and no displacement.
    bool has_free_turns = false;  ///< Whether one or two of the three rotations are rows.
  };

  template <typename Scalar>
  [[nodiscard]] static Point<Scalar> origin() noexcept {
    return {};
  }

  /// Pose::difference(), or for directions Direction::difference() with zeros in the linear rows. If y has free
  /// rotations, the rotation vector is multiplied by turn_fraction().
  template <typename Scalar>
  [[nodiscard]] static Vector<6, Scalar> difference(const Point<Scalar>& x, const Point<Scalar>& y) noexcept {
    if (y.is_empty) return filled<Vector<6, Scalar>>(6);
    if (!y.is_axis) {
      Vector<6, Scalar> result = Pose::difference<Scalar>(x.at, y.at);
      const Scalar fraction = y.has_free_turns ? turn_fraction(result) : Scalar(1);
      for (int i = 3; i < 6 && fraction < Scalar(1); ++i) result(i) *= fraction;
      return result;
    }
    const Vector<3, Scalar> turn = Direction::difference<Scalar>(column(x.at.R, 2), column(y.at.R, 2));
    auto result = filled<Vector<6, Scalar>>(6);
    for (int i = 0; i < 3; ++i) result(3 + i) = turn(i);
    return result;
  }

  template <typename Scalar>
  [[nodiscard]] static Point<Scalar> displace(const Point<Scalar>& y, const Vector<6, Scalar>& d) noexcept {
    if (y.is_empty) return y;
    return {Pose::displace<Scalar>(y.at, d), y.is_axis, false, y.has_free_turns};
  }

  /// Fraction of the rotation vector r in an error with free rotations: 1 for |r| ≤ π − kTurnBand, then decreasing
  /// linearly to 0 at |r| = π. At π, the rotation vector changes its sign, so that a constant fraction would make the
  /// error discontinuous. If all three rotations are rows, the error decreases and |r| does not stay at π.
  template <typename Scalar>
  [[nodiscard]] static Scalar turn_fraction(const Vector<6, Scalar>& difference) noexcept {
    constexpr auto kPi = static_cast<Scalar>(kTwoPi / 2.0);
    const Scalar angle = norm(Vector<3, Scalar>(difference(3), difference(4), difference(5)));
    return angle > kPi - kTurnBand<Scalar> ? (kPi - std::min(angle, kPi)) / kTurnBand<Scalar> : Scalar(1);
  }

  /// turn_fraction() of the error x ⊖ y, or 1 if the selected rows S have no rotation error.
  template <typename Scalar, typename Selection>
  [[nodiscard]] static Scalar slowed_fraction(const Point<Scalar>& x, const Point<Scalar>& y,
                                              const Selection& S) noexcept {
    if (!y.has_free_turns) return Scalar(1);
    Vector<6, Scalar> turn = Pose::difference<Scalar>(x.at, y.at);
    const Scalar fraction = turn_fraction(turn);
    if (!(fraction < Scalar(1))) return Scalar(1);
    for (int i = 0; i < 3; ++i) turn(i) = Scalar(0);
    return (S * turn).norm() > kSelectedError<Scalar> * S.norm() ? fraction : Scalar(1);
  }
};

}  // namespace fpbm
