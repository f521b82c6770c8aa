#pragma once

#include <algorithm>

#include "fpbm/clearance/separation.hpp"

namespace fpbm {

/// The joint motion gain Σ (1 − s/range)² ∇s over the gaps s of all pairs that are nearer than the range beyond their
/// margin: up the gradient of −gain range/3 Σ (1 − s/range)³. Both ends of a capsule
/// count, so that it is continuous where the nearest points jump.
/// placed: the bodies of the clearance.
template <typename Clearance>
[[nodiscard]] typename Clearance::JointVector motion_away(const Clearance& clearance,
                                                          const typename Clearance::Placement& placed) noexcept {
  using Scalar = typename Clearance::Scalar;
  using AllJoints = typename Clearance::AllJoints;
  const Away<Scalar>& away = clearance.away();
  AllJoints sum = AllJoints::Zero(clearance.robot().joints());
  for (const ShapePair& pair : clearance.pairs()) {
    if (clearance.roughly(placed, pair) >= clearance.margin() + away.range) continue;
    const Nearest<Scalar> found = clearance.nearest_of(placed, pair);
    const Separation<Clearance> plane(clearance, placed, pair, found);
    for (int e = 0; e < 2; ++e) {
      const Scalar near = Scalar(1) - (plane.gap(e) - clearance.margin()) / away.range;
      if (!(near > Scalar(0))) continue;
      const Scalar share = std::min(near, Scalar(1));
      sum += away.gain * share * share * plane.gradient_of(e);
    }
  }
  return clearance.robot().drives().by_drive(sum);
}

}  // namespace fpbm
