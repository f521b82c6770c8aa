#pragma once

#include <fpbm/model/chain.hpp>
#include <stdexcept>
#include <string>
#include <vector>
#if __has_include(<moveit/robot_model/robot_model.hpp>)
#include <moveit/robot_model/robot_model.hpp>
#else
#include <moveit/robot_model/robot_model.h>
#endif

namespace fpbm_moveit {

[[nodiscard]] inline fpbm::Joint<> joint_of(const moveit::core::JointModel& model, const fpbm::Transform<>& placement) {
  const auto* revolute = dynamic_cast<const moveit::core::RevoluteJointModel*>(&model);
  const auto* prismatic = dynamic_cast<const moveit::core::PrismaticJointModel*>(&model);
  if ((revolute == nullptr && prismatic == nullptr) || model.getMimic() != nullptr) {
    throw std::invalid_argument("joint '" + model.getName() +
                                "': must be revolute, continuous, prismatic or fixed, and must not follow another "
                                "joint: give a group without this joint");
  }
  const auto& bounds = model.getVariableBounds().front();
  fpbm::Joint<> joint{prismatic != nullptr       ? fpbm::JointType::kPrismatic
                      : bounds.position_bounded_ ? fpbm::JointType::kRevolute
                                                 : fpbm::JointType::kContinuous,
                      placement, prismatic != nullptr ? prismatic->getAxis() : revolute->getAxis()};
  joint.name = model.getName();
  if (bounds.position_bounded_) {
    joint.bounds.lower = bounds.min_position_;
    joint.bounds.upper = bounds.max_position_;
  }
  return joint;
}

/// The joints from link `base`, or from the frame of the model, to link `tip`. Throws std::invalid_argument.
[[nodiscard]] inline fpbm::Chain<> chain_of(const moveit::core::RobotModel& model, const std::string& base,
                                            const std::string& tip) {
  std::vector<const moveit::core::LinkModel*> links;
  const auto* link = model.getLinkModel(tip);
  for (; link != nullptr && link->getName() != base; link = link->getParentLinkModel()) links.push_back(link);
  if (link == nullptr && (links.empty() || base != model.getModelFrame())) {
    throw std::invalid_argument("no joints from '" + base + "' to '" + tip + "': give links of one chain");
  }
  fpbm::Chain<> chain;
  for (auto each = links.rbegin(); each != links.rend(); ++each) {
    const Eigen::Isometry3d& origin = (*each)->getJointOriginTransform();
    chain.tip = chain.tip * fpbm::Transform<>{origin.translation(), origin.linear()};
    const moveit::core::JointModel& joint = *(*each)->getParentJointModel();
    if (joint.getType() == moveit::core::JointModel::FIXED) continue;
    chain.joints.push_back(joint_of(joint, chain.tip));
    chain.tip = {};
  }
  return chain;
}

}  // namespace fpbm_moveit
