#pragma once

#include "fpbm/core/types.hpp"
#include "fpbm/geometry/detail/rotation_vector.hpp"
#include "fpbm/geometry/rotation.hpp"

namespace fpbm {

/// Task space of orientations: rotation matrices. Displacements are rotation vectors, and velocities are angular
/// velocities, along the axes of the base frame [rad].
struct Orientation {
  static constexpr int kRows = 3;
  static constexpr int kTurns = 3;
  static constexpr int kSize = 9;

  template <typename Scalar>
  using Point = Matrix<3, 3, Scalar>;

  template <typename Scalar>
  [[nodiscard]] static Point<Scalar> origin() noexcept {
    return identity<Point<Scalar>>();
  }

  /// x ⊖ y: the rotation vector of x yᵀ.
  template <typename Scalar>
  [[nodiscard]] static Vector<3, Scalar> difference(const Point<Scalar>& x, const Point<Scalar>& y) noexcept {
    return rotation_between(x, y);
  }

  /// y ⊕ d: y rotated by the rotation vector d.
  template <typename Scalar>
  [[nodiscard]] static Point<Scalar> displace(const Point<Scalar>& y, const Vector<3, Scalar>& d) noexcept {
    return times(rotation(d), y);
  }

  template <typename Scalar>
  [[nodiscard]] static Point<Scalar> compose(const Point<Scalar>& y, const Point<Scalar>& x) noexcept {
    return times(x, y);
  }

  /// Writes the nine entries row by row.
  template <typename Scalar>
  static void store(const Point<Scalar>& x, Scalar* out) noexcept {
    for (int i = 0; i < 9; ++i) out[i] = x(i / 3, i % 3);
  }
};

}  // namespace fpbm
