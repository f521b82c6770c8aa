#pragma once

#include "lanes.hpp"

namespace fpbm::bindings {

// Positions and poses are compiled in separate units (CMakeLists.txt), which limits the memory of the compiler.
[[nodiscard]] RunInLanes<Position<2>> plane_in_lanes() noexcept;
[[nodiscard]] RunInLanes<Position<3>> position_in_lanes() noexcept;
[[nodiscard]] RunInLanes<Pose> pose_in_lanes() noexcept;

}  // namespace fpbm::bindings
