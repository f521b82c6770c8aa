#pragma once

#include <algorithm>

#include "fpbm/any/any_arm.hpp"
#include "fpbm/model/chain.hpp"
#include "fpbm/model/coupled_arm.hpp"
#include "fpbm/model/planar_arm.hpp"
#include "fpbm/model/serial_arm.hpp"

/// Arms for programs that read the number of joints at run time.
///
/// Arms in space with six and seven joints use code of fixed size: a simulated step of the Panda then needs 15 %
/// (position) or 10 % (pose) fewer instructions. For four joints in the plane, the gain would be 5 %.
///
/// The functions are templates, so that only translation units that call a function compile the function. Otherwise,
/// every translation unit with this header would need 4 s more.
namespace fpbm {

/// Planar arm with the given link lengths [m]. Throws ParameterError unless there are 2 to kMaxDof lengths, all
/// positive and finite.
template <typename = void>
[[nodiscard]] AnyArm<Position<2>> make_planar_arm(const Vector<Eigen::Dynamic>& lengths) {
  return AnyArm<Position<2>>(PlanarArm<Eigen::Dynamic>(lengths));
}

/// Arm of a chain: a CoupledArm if joints mimic other joints, else a SerialArm. Throws ParameterError under the
/// conditions of CoupledArm and SerialArm.
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
