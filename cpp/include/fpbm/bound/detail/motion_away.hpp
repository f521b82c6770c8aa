#pragma once

#include <algorithm>

#include "fpbm/bound/detail/separation.hpp"

namespace fpbm {

/// Null-space motion away from shapes [rad/s², or rad/s at velocity level]:
///
///   Σ gain (1 − s/range)² ∇s   over all pairs with a gap s < range beyond the margin.
///
/// The motion is the negative gradient of the potential gain·range/3 Σ (1 − s/range)³. The sum contains both ends of a
/// capsule, so that the motion is continuous if the nearest points jump from one end to the other. placed: the bodies
/// of the clearance.
template <typename Clearance>
[[nodiscard]] typename Clearance::JointVector motion_away(const Clearance& clearance,
                                                          const typename Clearance::Placement& placed) noexcept {
  using Scalar = typename Clearance::Scalar;
  using AllJoints = typename Clearance::AllJoints;
  const Away<Scalar>& away = clearance.away();
  AllJoints sum = AllJoints::Zero(clearance.robot().joints());
  for (const ShapePair& pair : clearance.pairs()) {
    if (clearance.distance_lower_bound(placed, pair) >= clearance.margin() + away.range) continue;
    const Nearest<Scalar> found = clearance.nearest_of(placed, pair);
    const Separation<Clearance> plane(clearance, placed, pair, found);
    for (int e = 0; e < 2; ++e) {
      const Scalar near = Scalar(1) - (plane.gap(e) - clearance.margin()) / away.range;
      if (!(near > Scalar(0))) continue;
      const Scalar fraction = std::min(near, Scalar(1));
      sum += away.gain * fraction * fraction * plane.gradient_of(e);
    }
  }
  return clearance.robot().drives().by_drive(sum);
}

}  // namespace fpbm
