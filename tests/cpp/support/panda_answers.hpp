#pragma once

#include "fpbm/model/serial_arm.hpp"
#include "fpbm/scheme/schemes.hpp"

/// Single evaluations of the types that trackers_fixed.cpp compiles for other purposes.
namespace fpbm::test {

[[nodiscard]] Kinematics<Pose, 7> kinematics_of(const SerialArm<7>& arm, const State<7>& state);
[[nodiscard]] Status resolve(const AccelerationScheme<7>& scheme, const Kinematics<Pose, 7>& kinematics,
                             const Reference<Pose>& reference, const State<7>& state, Vector<7>& qdd);

}  // namespace fpbm::test
