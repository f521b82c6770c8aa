#pragma once

#include <cmath>

#include "fpbm/core/detail/mask.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/geometry/detail/rotation_vector.hpp"
#include "fpbm/geometry/rotation.hpp"
#include "fpbm/linalg/detail/entrywise.hpp"
#include "fpbm/linalg/detail/product.hpp"

namespace fpbm {

inline constexpr double kTwoPi = 6.28318530717958647692;

/// A task space defines a Point, the number of rows of its velocities (kRows), and
///
///   difference(x, y)   x ⊖ y: the displacement from y to x, along the axes of the base frame
///   displace(y, d)     y ⊕ d: the point y after the displacement d
///   compose(y, x)      the point y after the displacement from origin() to the point x
///   kTurns             the number of angular rows, which are the last rows; the other rows are linear
///   store(x, out)      writes a point as kSize numbers

/// Task space of tip positions: M = 2 in the plane, M = 3 in space [m].
template <int M>
struct Position {
  static constexpr int kRows = M;
  static constexpr int kTurns = 0;
  static constexpr int kSize = M;

  template <typename Scalar>
  using Point = Vector<M, Scalar>;

  template <typename Scalar>
  [[nodiscard]] static Point<Scalar> origin() noexcept {
    return filled<Point<Scalar>>(kRows);
  }

  template <typename Scalar>
  [[nodiscard]] static Vector<M, Scalar> difference(const Point<Scalar>& x, const Point<Scalar>& y) noexcept {
    if constexpr (M == Eigen::Dynamic) {
      return entrywise(x, [&](Eigen::Index i) { return x.coeff(i) - y.coeff(i); });
    } else {
      return by_rows<M, Scalar>([&](const auto& rows) { return rows(x.data()) - rows(y.data()); });
    }
  }

  template <typename Scalar>
  [[nodiscard]] static Point<Scalar> displace(const Point<Scalar>& y, const Vector<M, Scalar>& d) noexcept {
    return entrywise(y, [&](Eigen::Index i) { return y.coeff(i) + d.coeff(i); });
  }

  template <typename Scalar>
  [[nodiscard]] static Point<Scalar> compose(const Point<Scalar>& y, const Point<Scalar>& x) noexcept {
    return entrywise(y, [&](Eigen::Index i) { return y.coeff(i) + x.coeff(i); });
  }

  template <typename Scalar>
  static void store(const Point<Scalar>& x, Scalar* out) noexcept {
    for (int i = 0; i < M; ++i) out[i] = x(i);
  }
};

/// Task space of tip poses in the plane: x, y [m] and the angle from the x axis of the base frame to the x axis of the
/// tip [rad].
struct PlanarPose : Position<3> {
  static constexpr int kTurns = 1;

  /// x ⊖ y, with the angle in [−π, π].
  template <typename Scalar>
  [[nodiscard]] static Vector<3, Scalar> difference(const Point<Scalar>& x, const Point<Scalar>& y) noexcept {
    using std::round;
    constexpr auto kRound = static_cast<Scalar>(kTwoPi);
    Vector<3, Scalar> result = Position<3>::difference<Scalar>(x, y);
    result(2) -= kRound * round(result(2) / kRound);
    return result;
  }
};

/// Task space of tip poses: linear rows above angular rows, at the tip and along the axes of the base frame.
struct Pose {
  static constexpr int kRows = 6;
  static constexpr int kTurns = 3;
  static constexpr int kSize = 16;

  template <typename Scalar>
  using Point = Transform<Scalar>;

  template <typename Scalar>
  [[nodiscard]] static Point<Scalar> origin() noexcept {
    return {};
  }

  /// x ⊖ y: the vector from the origin of y to the origin of x [m], then the rotation vector of R_x R_yᵀ [rad].
  template <typename Scalar>
  [[nodiscard]] static Vector<6, Scalar> difference(const Point<Scalar>& x, const Point<Scalar>& y) noexcept {
    Vector<6, Scalar> result;
    using Two = Pair<Scalar>;
    const Vector<3, Scalar> turn = rotation_between(x.R, y.R);
    (Two::load(x.p.data()) - Two::load(y.p.data())).store(result.data());
    Two(x.p(2) - y.p(2), turn(0)).store(result.data() + 2);
    Two(turn(1), turn(2)).store(result.data() + 4);
    return result;
  }

  /// y ⊕ d: y translated by the first three rows of d, and rotated by the rotation vector in the last three rows.
  template <typename Scalar>
  [[nodiscard]] static Point<Scalar> displace(const Point<Scalar>& y, const Vector<6, Scalar>& d) noexcept {
    const Vector<3, Scalar> turned(d.coeff(3), d.coeff(4), d.coeff(5));
    const Vector<3, Scalar> p = entrywise(y.p, [&](Eigen::Index i) { return y.p.coeff(i) + d.coeff(i); });
    const Scalar none(0);
    if (all_of(turned(0) == none && turned(1) == none && turned(2) == none)) return {p, y.R};
    return {p, times(rotation(turned), y.R)};
  }

  /// y translated by x.p and rotated by x.R, both along the axes of the base frame.
  template <typename Scalar>
  [[nodiscard]] static Point<Scalar> compose(const Point<Scalar>& y, const Point<Scalar>& x) noexcept {
    return {entrywise(y.p, [&](Eigen::Index i) { return y.p.coeff(i) + x.p.coeff(i); }), times(x.R, y.R)};
  }

  /// Writes a homogeneous 4 × 4 matrix row by row.
  template <typename Scalar>
  static void store(const Point<Scalar>& x, Scalar* out) noexcept {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) out[4 * i + j] = x.R(i, j);
      out[4 * i + 3] = x.p(i);
    }
    out[12] = out[13] = out[14] = Scalar(0);
    out[15] = Scalar(1);
  }
};

/// The pose space whose positions are in Space.
template <typename Space>
struct PoseOver;
template <>
struct PoseOver<Position<2>> {
  using type = PlanarPose;
};
template <>
struct PoseOver<Position<3>> {
  using type = Pose;
};

}  // namespace fpbm
