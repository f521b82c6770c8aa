#pragma once

#include <cmath>
#include <limits>

#include "fpbm/core/types.hpp"
#include "fpbm/geometry/detail/rotation_vector.hpp"
#include "fpbm/geometry/rotation.hpp"
#include "fpbm/linalg/detail/sums.hpp"

namespace fpbm {

/// Task space of directions: unit vectors. Displacements are rotation vectors along the axes of the base frame [rad].
struct Direction {
  static constexpr int kRows = 3;
  static constexpr int kTurns = 3;
  static constexpr int kSize = 3;

  template <typename Scalar>
  using Point = Vector<3, Scalar>;

  template <typename Scalar>
  [[nodiscard]] static Point<Scalar> origin() noexcept {
    return {Scalar(0), Scalar(0), Scalar(1)};
  }

  /// x ⊖ y: the rotation vector of the smallest rotation from y to x, perpendicular to x and y [rad]. If x = −y, the
  /// rotation is by π about an axis perpendicular to y.
  template <typename Scalar>
  [[nodiscard]] static Vector<3, Scalar> difference(const Point<Scalar>& x, const Point<Scalar>& y) noexcept {
    using std::atan2;
    Vector<3, Scalar> axis = cross(y, x);
    const Scalar square = squared_norm(axis);
    const Scalar cosine = dot(x, y);
    // Small angles between unit vectors need no square root and no division.
    const bool unit = std::abs(cosine * cosine + square - Scalar(1)) <
                      Scalar(kUnitTolerance) * std::numeric_limits<Scalar>::epsilon();
    if (unit && cosine > Scalar(0) && square < Scalar(kLargestSquare)) {
      const Scalar factor = angle_over_sine(square);
      return entrywise(axis, [&](Eigen::Index i) { return factor * axis.coeff(i); });
    }
    const Scalar sine = std::sqrt(square);
    if (!(sine > Scalar(0))) {
      if (!(cosine < Scalar(0))) return axis;
      Eigen::Index least = 0;
      for (Eigen::Index i = 1; i < 3; ++i) {
        if (std::abs(y(i)) < std::abs(y(least))) least = i;
      }
      Vector<3, Scalar> aside(Scalar(0), Scalar(0), Scalar(0));
      aside(least) = Scalar(1);
      axis = normalized(cross(y, aside));
      return entrywise(axis, [&](Eigen::Index i) { return static_cast<Scalar>(kPi) * axis.coeff(i); });
    }
    const Scalar factor = atan2(sine, cosine) / sine;
    return entrywise(axis, [&](Eigen::Index i) { return factor * axis.coeff(i); });
  }

  /// y ⊕ d: y rotated by the rotation vector d.
  template <typename Scalar>
  [[nodiscard]] static Point<Scalar> displace(const Point<Scalar>& y, const Vector<3, Scalar>& d) noexcept {
    return times(rotation(d), y);
  }

  /// y rotated by the smallest rotation from the z axis to x.
  template <typename Scalar>
  [[nodiscard]] static Point<Scalar> compose(const Point<Scalar>& y, const Point<Scalar>& x) noexcept {
    return displace<Scalar>(y, difference<Scalar>(x, origin<Scalar>()));
  }

  template <typename Scalar>
  static void store(const Point<Scalar>& x, Scalar* out) noexcept {
    for (int i = 0; i < 3; ++i) out[i] = x(i);
  }

 private:
  static constexpr double kPi = 3.14159265358979323846;

  /// Largest |sin² + cos² − 1| of unit vectors [epsilon]. The round-off errors of normalized() and displace() cause
  /// values of up to 8. A value of 16 causes a relative error of only 8 epsilon in a small angle.
  static constexpr int kUnitTolerance = 16;
};

}  // namespace fpbm
