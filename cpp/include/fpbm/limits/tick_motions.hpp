#pragma once

#include <cmath>

#include "fpbm/limits/limits.hpp"
#include "fpbm/linalg/entrywise.hpp"

namespace fpbm {

/// Motions of a tick with the given accelerations: the accelerations, or the velocities at the end of the tick at
/// velocity level.
template <Level kLevel, int N, typename Scalar>
[[nodiscard]] Vector<N, Scalar> motions(const Limits<kLevel, N, Scalar>& limits, const Vector<N, Scalar>& qd,
                                        const Vector<N, Scalar>& accelerations) noexcept {
  if constexpr (kLevel == Level::kVelocity) {
    return entrywise(qd, [&](Eigen::Index i) { return qd(i) + limits.tick() * accelerations(i); });
  } else {
    return accelerations;
  }
}

/// At velocity level, reduces the change from qd to `goal` in a tick to a fraction with which the accelerations can
/// decrease to zero before the velocities pass `goal`. The fraction is the same for all joints, so the change keeps its
/// direction. At acceleration level, returns `goal`.
template <Level kLevel, int N, typename Scalar>
[[nodiscard]] Vector<N, Scalar> approach(const Limits<kLevel, N, Scalar>& limits, const Vector<N, Scalar>& qd,
                                         const Vector<N, Scalar>& goal) noexcept {
  if constexpr (kLevel == Level::kAcceleration) {
    return goal;
  } else {
    Scalar fraction(1);
    for (Eigen::Index i = 0; i < goal.size(); ++i) {
      if (!limits.bounds_jerk(i)) continue;
      const Scalar change = std::abs(goal(i) - qd(i));
      const Scalar most = limits.tick() * limits.jerk_limited(i).change(change);
      if (fraction * change > most) fraction = most / change;
    }
    return entrywise(qd, [&](Eigen::Index i) { return qd(i) + fraction * (goal(i) - qd(i)); });
  }
}

}  // namespace fpbm
