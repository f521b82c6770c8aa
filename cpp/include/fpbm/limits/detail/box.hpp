#pragma once

#include <algorithm>

#include "fpbm/core/types.hpp"
#include "fpbm/linalg/detail/entrywise.hpp"

namespace fpbm {

/// Interval of motions of a joint.
template <typename Scalar>
struct Interval {
  Scalar low;
  Scalar high;
};

/// Bounds on the motion of each joint in one tick: accelerations, or velocities at velocity level.
template <int N, typename Scalar = double>
struct Box {
  Vector<N, Scalar> lower;
  Vector<N, Scalar> upper;

  [[nodiscard]] bool contains(const Vector<N, Scalar>& u) const noexcept {
    bool inside = true;
    for (Eigen::Index i = 0; i < u.size(); ++i) {
      inside = inside && lower.coeff(i) <= u.coeff(i) && u.coeff(i) <= upper.coeff(i);
    }
    return inside;
  }

  [[nodiscard]] Vector<N, Scalar> nearest(const Vector<N, Scalar>& u) const noexcept {
    return entrywise(u, [&](Eigen::Index i) { return std::max(std::min(u.coeff(i), upper.coeff(i)), lower.coeff(i)); });
  }
};

}  // namespace fpbm
