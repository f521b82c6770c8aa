#pragma once

#include "fpbm/model/chain.hpp"
#include "fpbm/model/detail/dh_presets.hpp"
#include "fpbm/model/detail/frame_presets.hpp"
#include "fpbm/model/detail/franka_presets.hpp"
#include "fpbm/model/detail/ur_presets.hpp"

/// Arms as specified by their manufacturers, from the base frame to the flange frame.
///
/// Each preset is a chain. Build a SerialArm<7> or SerialArm<6> from the chain, or change the chain first: chain.tip =
/// chain.tip * tool adds a tool. All presets run in a Tracker without changes. If a manufacturer publishes no bounds on
/// acceleration, the values are from the source in the comment of the preset: set chain.joints[i].bounds.acceleration
/// to your own values. Only Franka publishes bounds on jerk. Inertias of the links and efforts are from the source in
/// the comment. Tools are not included. No preset has friction: the published files have values for simulators.
namespace fpbm::presets {

/// Preset with its name, for programs that read the name at run time.
struct Preset {
  const char* name;
  Chain<> (*chain)();
};
inline constexpr Preset kAll[] = {
    {"panda", panda}, {"fr3", fr3},     {"iiwa14", iiwa14}, {"gen3", gen3},       {"ur5e", ur5e},
    {"ur10e", ur10e}, {"xarm7", xarm7}, {"so101", so101},   {"openarm", openarm}, {"z1", z1},
};

}  // namespace fpbm::presets
