#pragma once

/// Headers for a control loop: Tracker with SerialArm, the presets, the schemes and simple paths. Compiles in less time
/// and memory than <fpbm/fpbm.hpp>.

#include "fpbm/model/presets.hpp"
#include "fpbm/model/serial_arm.hpp"
#include "fpbm/path/path.hpp"
#include "fpbm/path/placed.hpp"
#include "fpbm/path/shapes.hpp"
#include "fpbm/realtime/tracker.hpp"
#include "fpbm/scheme/schemes.hpp"
