#pragma once

#include "fpbm/core/types.hpp"

namespace fpbm {

/// Bounds on each joint's motion over one tick: accelerations, or velocities for a scheme of that level.
template <int N, typename Scalar = double>
struct Box {
  Vector<N, Scalar> lower;
  Vector<N, Scalar> upper;

  [[nodiscard]] bool contains(const Vector<N, Scalar>& u) const noexcept {
    return (lower.array() <= u.array()).all() && (u.array() <= upper.array()).all();
  }

  [[nodiscard]] Vector<N, Scalar> nearest(const Vector<N, Scalar>& u) const noexcept {
    return u.cwiseMin(upper).cwiseMax(lower);
  }
};

}  // namespace fpbm
