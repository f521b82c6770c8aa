#pragma once

#include <variant>

#include "fpbm/target/target_filter.hpp"

namespace fpbm::bindings {

/// A filter of targets in any task space.
struct PyTargetFilter {
  std::variant<TargetFilter<Position<2>>, TargetFilter<PlanarPose>, TargetFilter<Position<3>>, TargetFilter<Pose>> any;
};

}  // namespace fpbm::bindings
