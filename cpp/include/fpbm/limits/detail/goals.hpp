#pragma once

#include <algorithm>
#include <cmath>

#include "fpbm/limits/limits.hpp"
#include "fpbm/linalg/detail/entrywise.hpp"

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

/// Fraction of the change from qd to `goal` in a tick with which the accelerations can decrease to zero before the
/// velocities pass `goal`. The fraction is the same for all joints, so the change keeps its direction.
template <int N, typename Scalar>
[[nodiscard]] Scalar approach_fraction(const Limits<Level::kVelocity, N, Scalar>& limits, const Vector<N, Scalar>& qd,
                                       const Vector<N, Scalar>& goal) noexcept {
  Scalar fraction(1);
  for (Eigen::Index i = 0; i < goal.size(); ++i) {
    if (!limits.bounds_jerk(i)) continue;
    const Scalar change = std::abs(goal(i) - qd(i));
    const Scalar most = limits.tick() * limits.jerk_limited(i).change(change);
    if (fraction * change > most) fraction = most / change;
  }
  return fraction;
}

/// Goals of the first level alone and of all levels.
template <int N, typename Scalar>
struct Goals {
  Vector<N, Scalar> first;
  Vector<N, Scalar> all;
};

/// At velocity level, reduces the changes from qd to the goals by approach_fraction(). all − first does not change the
/// first level, and is reduced separately, so that the lower levels do not slow the first level. At acceleration level,
/// returns the goals.
template <Level kLevel, int N, typename Scalar>
[[nodiscard]] Goals<N, Scalar> approach(const Limits<kLevel, N, Scalar>& limits, const Vector<N, Scalar>& qd,
                                        const Vector<N, Scalar>& first, const Vector<N, Scalar>& all) noexcept {
  if constexpr (kLevel == Level::kAcceleration) {
    return {first, all};
  } else {
    const Scalar fraction = approach_fraction(limits, qd, first);
    const Scalar lower = std::min(fraction, approach_fraction(limits, qd, all));
    const Vector<N, Scalar> to = entrywise(qd, [&](Eigen::Index i) { return qd(i) + fraction * (first(i) - qd(i)); });
    return {to, entrywise(to, [&](Eigen::Index i) { return to(i) + lower * (all(i) - first(i)); })};
  }
}

}  // namespace fpbm
