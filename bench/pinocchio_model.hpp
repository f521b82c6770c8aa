#pragma once

#include <pinocchio/multibody/model.hpp>
#include <string>

#include "fpbm/model/chain.hpp"

namespace bench {

/// Pinocchio's model of a chain of revolute joints about z, with a frame "tip".
inline pinocchio::Model pinocchio_model(const fpbm::Chain<>& chain) {
  pinocchio::Model model;
  pinocchio::JointIndex parent = 0;
  for (const auto& joint : chain.joints) {
    const pinocchio::SE3 placement(joint.placement.R, joint.placement.p);
    parent = model.addJoint(parent, pinocchio::JointModelRZ(), placement, std::to_string(parent + 1));
    model.appendBodyToJoint(parent, pinocchio::Inertia::Identity());
  }
  const pinocchio::SE3 end(chain.tip.R, chain.tip.p);
  model.addFrame(pinocchio::Frame("tip", parent, 0, end, pinocchio::OP_FRAME));
  return model;
}

}  // namespace bench
