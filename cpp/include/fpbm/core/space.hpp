#pragma once

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

}  // namespace fpbm
