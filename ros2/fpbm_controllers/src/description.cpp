#include "fpbm_controllers/description.hpp"

#include <algorithm>
#include <memory>
#include <stdexcept>
#include <vector>

#include "fpbm_controllers/urdf_model.hpp"

namespace fpbm_controllers {

namespace {

/// The joints from the root to a link.
[[nodiscard]] std::vector<std::shared_ptr<const urdf::Joint>> joints_to(const urdf::Model& model,
                                                                        const NamedLink& named) {
  const auto link = model.getLink(named.link);
  if (!link) {
    throw std::invalid_argument(named.parameter + ": robot_description has no link '" + named.link +
                                "': give one of its links");
  }
  std::vector<std::shared_ptr<const urdf::Joint>> joints;
  for (std::shared_ptr<const urdf::Joint> joint = link->parent_joint; joint;
       joint = model.getLink(joint->parent_link_name)->parent_joint) {
    joints.push_back(joint);
  }
  std::reverse(joints.begin(), joints.end());
  return joints;
}

[[nodiscard]] fpbm::JointType type_of(const urdf::Joint& joint) {
  switch (joint.type) {
    case urdf::Joint::REVOLUTE: return fpbm::JointType::kRevolute;
    case urdf::Joint::CONTINUOUS: return fpbm::JointType::kContinuous;
    case urdf::Joint::PRISMATIC: return fpbm::JointType::kPrismatic;
    default: break;
  }
  throw std::invalid_argument(
      "joint '" + joint.name +
      "': is between base_frame and a frame, and is not revolute, continuous, prismatic or fixed: give another frame");
}

[[nodiscard]] fpbm::Joint<> joint_of(const urdf::Joint& described, const fpbm::Transform<>& placement) {
  fpbm::Joint<> joint{type_of(described), placement, {described.axis.x, described.axis.y, described.axis.z}};
  joint.name = described.name;
  if (described.limits) {
    if (described.limits->velocity != 0.0) joint.bounds.velocity = described.limits->velocity;  // 0: not given.
    if (described.limits->effort > 0.0) joint.bounds.effort = described.limits->effort;
    if (joint.type != fpbm::JointType::kContinuous) {
      joint.bounds.lower = described.limits->lower;
      joint.bounds.upper = described.limits->upper;
    }
  }
  return joint;
}

[[nodiscard]] fpbm::Mimic<> mimic_of(const urdf::Joint& joint, const fpbm::Tree<>& tree) {
  const auto leader = std::find_if(tree.joints.begin(), tree.joints.end(),
                                   [&](const auto& other) { return other.joint.name == joint.mimic->joint_name; });
  if (leader == tree.joints.end()) {
    throw std::invalid_argument(
        "joint '" + joint.name + "': follows joint '" + joint.mimic->joint_name +
        "', which must also be between base_frame and a frame: give another base_frame or frame");
  }
  return {static_cast<int>(leader - tree.joints.begin()), joint.mimic->multiplier, joint.mimic->offset};
}

}  // namespace

fpbm::Tree<> tree_of(const std::string& robot_description, const std::string& base,
                     const std::vector<NamedLink>& links) {
  const urdf::Model model = model_of(robot_description);
  const auto to_base = joints_to(model, {"base_frame", base});
  fpbm::Tree<> tree;
  std::vector<std::shared_ptr<const urdf::Joint>> moving;  // The joints of the tree.
  for (const NamedLink& named : links) {
    const auto to_link = joints_to(model, named);
    auto [down, up] = std::mismatch(to_base.begin(), to_base.end(), to_link.begin(), to_link.end());
    fpbm::Transform<> base_in_fork;  // The fork is the last link before both base and link.
    for (; down != to_base.end(); ++down) {
      if ((*down)->type != urdf::Joint::FIXED) {
        throw std::invalid_argument("base_frame: moves with joint '" + (*down)->name + "', which is not before " +
                                    named.parameter + ": give a link that does not move");
      }
      base_in_fork = base_in_fork * origin_of(**down);
    }
    fpbm::Transform<> place = inverse(base_in_fork);  // In the frame of the link that carries the next joint.
    int carrier = 0;
    for (; up != to_link.end(); ++up) {
      place = place * origin_of(**up);
      if ((*up)->type == urdf::Joint::FIXED) continue;
      const auto known = std::find(moving.begin(), moving.end(), *up);
      const auto number = static_cast<int>(known - moving.begin());
      if (known == moving.end()) {
        moving.push_back(*up);
        tree.joints.push_back({joint_of(**up, place), carrier});
      }
      carrier = number + 1;
      place = {};
    }
    tree.frames.push_back({named.link, carrier, place});
  }
  for (std::size_t i = 0; i < moving.size(); ++i) {
    if (moving[i]->mimic) tree.joints[i].joint.mimic = mimic_of(*moving[i], tree);
  }
  return tree;
}

fpbm::NamedFrame<> frame_of(const fpbm::Tree<>& tree, const urdf::Model& model, const std::string& base,
                            const NamedLink& named) {
  fpbm::Transform<> place;
  const auto joints = joints_to(model, named);
  for (auto up = joints.rbegin(); up != joints.rend(); ++up) {
    for (std::size_t i = 0; i < tree.joints.size(); ++i) {
      if (tree.joints[i].joint.name == (*up)->name) return {named.link, static_cast<int>(i) + 1, place};
    }
    place = origin_of(**up) * place;
  }
  fpbm::Transform<> of_base;
  for (const auto& joint : joints_to(model, {"base_frame", base})) of_base = of_base * origin_of(*joint);
  return {named.link, 0, inverse(of_base) * place};
}

std::vector<std::size_t> joints_to(const fpbm::Tree<>& tree, int link) {
  std::vector<std::size_t> joints;
  for (; link > 0; link = tree.joints[joints.back()].parent) joints.push_back(static_cast<std::size_t>(link - 1));
  std::reverse(joints.begin(), joints.end());
  return joints;
}

fpbm::Chain<> chain_to(const fpbm::Tree<>& tree, int link) {
  fpbm::Chain<> chain;
  for (const std::size_t i : joints_to(tree, link)) chain.joints.push_back(tree.joints[i].joint);
  return chain;
}

bool is_end(const fpbm::Tree<>& tree, int link) {
  return link > 0 &&
         std::none_of(tree.joints.begin(), tree.joints.end(), [link](const auto& each) { return each.parent == link; });
}

}  // namespace fpbm_controllers
