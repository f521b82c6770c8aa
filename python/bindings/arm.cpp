#include "arm.hpp"

#include "fpbm/any/make_arm.hpp"

namespace fpbm::bindings {
namespace {

/// An arm in the plane: joints about z at each link's start, with the links along x.
Chain<> chain_of(const JointVector& lengths) {
  Chain<> chain;
  for (const double length : lengths) {
    Joint<> joint;
    joint.placement = chain.tip;
    joint.name = "joint_" + std::to_string(chain.joints.size() + 1);
    chain.joints.push_back(joint);
    chain.tip.p = {length, 0.0, 0.0};
  }
  return chain;
}

}  // namespace

Arm::Arm(const JointVector& lengths) : Arm(make_planar_arm(lengths), lengths, chain_of(lengths), true) {}
Arm::Arm(const Chain<>& chain) : Arm(make_arm(chain), chain, chain, false) {}

}  // namespace fpbm::bindings
