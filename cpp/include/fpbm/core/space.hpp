#pragma once

#include "fpbm/core/rotation.hpp"
#include "fpbm/core/types.hpp"

namespace fpbm {

/// Task space of tip positions: M = 2 in the plane, M = 3 in space [m].
///
/// A task space tells the resolvers three things: how many rows the task has, what a point of it is, and what
/// x ⊖ y means.
template <int M>
struct Position {
  static constexpr int kRows = M;

  template <typename Scalar>
  using Point = Vector<M, Scalar>;

  /// x ⊖ y: the displacement that leads from y to x.
  template <typename Scalar>
  [[nodiscard]] static Vector<M, Scalar> difference(const Point<Scalar>& x, const Point<Scalar>& y) noexcept {
    return x - y;
  }

  /// y ⊕ d: the point that the displacement d leads to from y.
  template <typename Scalar>
  [[nodiscard]] static Point<Scalar> displace(const Point<Scalar>& y, const Vector<M, Scalar>& d) noexcept {
    return y + d;
  }
};

/// Task space of tip poses: linear rows first, then angular, in the base frame's axes at the tip.
struct Pose {
  static constexpr int kRows = 6;

  template <typename Scalar>
  using Point = Transform<Scalar>;

  /// x ⊖ y: from y's origin to x's [m], then the rotation vector of R_x R_yᵀ [rad].
  template <typename Scalar>
  [[nodiscard]] static Vector<6, Scalar> difference(const Point<Scalar>& x, const Point<Scalar>& y) noexcept {
    const Matrix<3, 3, Scalar> turn = x.R.lazyProduct(y.R.transpose());
    Vector<6, Scalar> result;
    result.template head<3>() = x.p - y.p;
    result.template tail<3>() = rotation_vector(turn);
    return result;
  }

  /// y ⊕ d: y moved by d's first three rows and turned by the rotation vector in its last three.
  template <typename Scalar>
  [[nodiscard]] static Point<Scalar> displace(const Point<Scalar>& y, const Vector<6, Scalar>& d) noexcept {
    const Vector<3, Scalar> turn = d.template tail<3>();
    return {y.p + d.template head<3>(), rotation(turn).lazyProduct(y.R)};
  }
};

}  // namespace fpbm
