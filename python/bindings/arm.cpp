#include "arm.hpp"

#include "fpbm/any/make_arm.hpp"

namespace fpbm::bindings {

Arm::Arm(const JointVector& lengths) : any(make_planar_arm(lengths)), source(lengths) {
  for (Eigen::Index i = 1; i <= lengths.size(); ++i) joint_names.push_back("joint_" + std::to_string(i));
}

Arm::Arm(const Chain<>& chain) : any(make_arm(chain)), source(chain) {
  for (const Joint<>& joint : chain.joints) {
    if (joint.mimic.joint < 0) joint_names.push_back(joint.name);
  }
}

Chain<> Arm::chain() const {
  if (const auto* chain = std::get_if<Chain<>>(&source)) return *chain;
  Chain<> chain;
  for (const double length : std::get<JointVector>(source)) {
    Joint<> joint;
    joint.placement = chain.tip;
    joint.name = joint_names[chain.joints.size()];
    chain.joints.push_back(joint);
    chain.tip.p = {length, 0.0, 0.0};
  }
  return chain;
}

}  // namespace fpbm::bindings
