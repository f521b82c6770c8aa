#pragma once

/// Capsules of the arms and robots of model/presets.hpp.
#include "fpbm/bound/detail/arm_capsules.hpp"
#include "fpbm/bound/detail/robot_capsules.hpp"
