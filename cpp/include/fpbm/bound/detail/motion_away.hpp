#pragma once

#include <algorithm>

#include "fpbm/bound/detail/away.hpp"
#include "fpbm/bound/detail/separation.hpp"

namespace fpbm {

/// Null-space motion away from shapes [rad/s², or rad/s at velocity level]:
///
///   Σ gain (1 − s/range)² ∇s   over all pairs with a gap s < range beyond the margin.
///
/// The motion is the negative gradient of the potential gain·range/3 Σ (1 − s/range)³. The sum contains both ends of a
/// capsule, so that the motion is continuous if the nearest points jump from one end to the other. placed: the bodies
/// of the shapes.
template <typename Shapes>
[[nodiscard]] typename Shapes::JointVector motion_away(const Shapes& shapes, const typename Shapes::Placement& placed,
                                                       const Away<typename Shapes::Scalar>& away) noexcept {
  using Scalar = typename Shapes::Scalar;
  using AllJoints = typename Shapes::AllJoints;
  AllJoints sum = AllJoints::Zero(shapes.robot().joints());
  for (const ShapePair& pair : shapes.pairs()) {
    if (shapes.distance_lower_bound(placed, pair) >= shapes.margin() + away.range) continue;
    const Nearest<Scalar> found = shapes.nearest_of(placed, pair);
    const Separation<Shapes> plane(shapes, placed, pair, found);
    for (int e = 0; e < 2; ++e) {
      const Scalar near = Scalar(1) - (plane.gap(e) - shapes.margin()) / away.range;
      if (!(near > Scalar(0))) continue;
      const Scalar fraction = std::min(near, Scalar(1));
      sum += away.gain * fraction * fraction * plane.gradient_of(e);
    }
  }
  return shapes.robot().drives().by_drive(sum);
}

}  // namespace fpbm
