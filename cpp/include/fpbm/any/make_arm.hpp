#pragma once

#include <algorithm>

#include "fpbm/any/any_arm.hpp"
#include "fpbm/model/chain.hpp"
#include "fpbm/model/coupled_arm.hpp"
#include "fpbm/model/planar_arm.hpp"
#include "fpbm/model/serial_arm.hpp"

/// Arms for programs that learn the number of joints at run time.
///
/// All run in code of run-time size: behind AnyArm, where kinematics are copied into matrices of run-time size, code of
/// a fixed number of joints was measured to be no faster (planar 4, serial 6 and 7: 0.8 to 1.2 times).
namespace fpbm {

/// The planar arm of these link lengths [m].
/// Throws ParameterError unless there are 2 to kMaxDof lengths, all positive and finite.
[[nodiscard]] inline AnyArm<Position<2>> make_planar_arm(const Vector<Eigen::Dynamic>& lengths) {
  return AnyArm<Position<2>>(PlanarArm<Eigen::Dynamic>(lengths));
}

/// The arm of this chain: a CoupledArm where joints mimic others, else a SerialArm. Throws ParameterError where these
/// do.
[[nodiscard]] inline AnyArm<Position<3>> make_arm(const Chain<>& chain) {
  const auto mimics = [](const Joint<>& joint) { return joint.mimic.joint >= 0; };
  if (std::any_of(chain.joints.begin(), chain.joints.end(), mimics)) {
    return AnyArm<Position<3>>(CoupledArm<Eigen::Dynamic>(chain));
  }
  return AnyArm<Position<3>>(SerialArm<Eigen::Dynamic>(chain));
}

}  // namespace fpbm
