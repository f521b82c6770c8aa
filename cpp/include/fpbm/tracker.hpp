#pragma once

/// Headers for a control loop: Tracker with SerialArm, the presets, the schemes and simple paths. Compiles in less time
/// and memory than <fpbm/fpbm.hpp>.

#include "fpbm/model/presets.hpp"
#include "fpbm/model/serial_arm.hpp"
#include "fpbm/realtime/tracker.hpp"
#include "fpbm/scheme/schemes.hpp"
#include "fpbm/task/in_plane.hpp"
#include "fpbm/task/path.hpp"
#include "fpbm/task/shapes.hpp"
#include "fpbm/task/with_rotation.hpp"
