#pragma once

#include <algorithm>

#include "fpbm/any/any_arm.hpp"
#include "fpbm/model/chain.hpp"
#include "fpbm/model/coupled_arm.hpp"
#include "fpbm/model/planar_arm.hpp"
#include "fpbm/model/serial_arm.hpp"

/// Arms for programs that learn the number of joints at run time.
///
/// Six and seven joints in space run in code of fixed size: a simulated step of the Panda then takes 15 % (position) or
/// 10 % (pose) fewer instructions. Four joints in the plane would gain 5 %.
///
/// Templates, so that they compile only where they are called: otherwise every unit that includes them takes 4 s
/// longer.
namespace fpbm {

/// The planar arm of these link lengths [m].
/// Throws ParameterError unless there are 2 to kMaxDof lengths, all positive and finite.
template <typename = void>
[[nodiscard]] AnyArm<Position<2>> make_planar_arm(const Vector<Eigen::Dynamic>& lengths) {
  return AnyArm<Position<2>>(PlanarArm<Eigen::Dynamic>(lengths));
}

/// The arm of this chain: a CoupledArm where joints mimic others, else a SerialArm. Throws ParameterError where these
/// do.
template <typename = void>
[[nodiscard]] AnyArm<Position<3>> make_arm(const Chain<>& chain) {
  using Any = AnyArm<Position<3>>;
  const auto mimics = [](const Joint<>& joint) { return joint.mimic.joint >= 0; };
  if (std::any_of(chain.joints.begin(), chain.joints.end(), mimics)) return Any(CoupledArm<Eigen::Dynamic>(chain));
  if (chain.joints.size() == 6) return Any(SerialArm<6>(chain));
  if (chain.joints.size() == 7) return Any(SerialArm<7>(chain));
  return Any(SerialArm<Eigen::Dynamic>(chain));
}

}  // namespace fpbm
