#pragma once

#include "fpbm/bound/clearance.hpp"
#include "fpbm/bound/speed_bounds.hpp"
#include "fpbm/bound/task_bounds.hpp"
#include "model.hpp"

namespace fpbm::bindings {

/// The bounds of a motion. Bounds that are not given are empty.
using AnyBounds = Bounds<Clearance<kDynamic>, TaskBounds<kDynamic>, SpeedBounds<kDynamic>>;

}  // namespace fpbm::bindings
