#pragma once

#include "lanes.hpp"

namespace fpbm::bindings {

// The code of each task space is compiled alone, which bounds the memory of a compiler.
[[nodiscard]] RunInLanes<Position<2>> plane_in_lanes() noexcept;
[[nodiscard]] RunInLanes<Position<3>> position_in_lanes() noexcept;
[[nodiscard]] RunInLanes<Pose> pose_in_lanes() noexcept;

}  // namespace fpbm::bindings
