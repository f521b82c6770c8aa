#pragma once

#include <urdf/model.h>
#include <cmath>
#include <fpbm/geometry/rotation.hpp>
#include <fpbm/model/chain.hpp>
#include <memory>
#include <string>

namespace stand_in {

[[nodiscard]] inline urdf::Pose pose_of(const fpbm::Transform<>& transform) {
  const fpbm::Vector<4> q = fpbm::quaternion(transform.R);
  return {{transform.p(0), transform.p(1), transform.p(2)}, {q(1), q(2), q(3), q(0)}};
}

/// Adds a link and the joint that carries it.
inline urdf::Joint& add(urdf::Model& model, const std::string& joint, const std::string& parent,
                        const std::string& child, const fpbm::Transform<>& place) {
  auto made = std::make_shared<urdf::Joint>();
  made->type = urdf::Joint::FIXED;
  made->name = joint;
  made->parent_link_name = parent;
  made->child_link_name = child;
  made->parent_to_joint_origin_transform = pose_of(place);
  model.links_[child] = std::make_shared<urdf::Link>(urdf::Link{child, made});
  return *made;
}

/// The <inertial> of a link.
[[nodiscard]] inline std::shared_ptr<urdf::Inertial> inertial_of(const fpbm::LinkInertia<>& link) {
  fpbm::Transform<> place;
  place.p = link.centre;
  const auto& I = link.inertia;
  return std::make_shared<urdf::Inertial>(
      urdf::Inertial{pose_of(place), link.mass, I(0, 0), I(0, 1), I(0, 2), I(1, 1), I(1, 2), I(2, 2)});
}

/// Adds a chain from the link `parent` to a link "flange", with the joint names, bounds, inertias and friction of the
/// chain. An infinite effort is not given. All added names contain the prefix. at: pose of the base of the chain in the
/// frame of `parent`.
inline void add_chain(urdf::Model& model, const fpbm::Chain<>& chain, std::string parent,
                      const std::string& prefix = "", fpbm::Transform<> at = {}) {
  for (const auto& joint : chain.joints) {
    const std::string name = prefix + joint.name;
    urdf::Joint& made = add(model, name, parent, "link_of_" + name, at * joint.placement);
    made.type = joint.type == fpbm::JointType::kPrismatic    ? urdf::Joint::PRISMATIC
                : joint.type == fpbm::JointType::kContinuous ? urdf::Joint::CONTINUOUS
                                                             : urdf::Joint::REVOLUTE;
    made.axis = {joint.axis(0), joint.axis(1), joint.axis(2)};
    made.limits = std::make_shared<urdf::JointLimits>(
        urdf::JointLimits{joint.bounds.lower, joint.bounds.upper,
                          std::isfinite(joint.bounds.effort) ? joint.bounds.effort : 0.0, joint.bounds.velocity});
    made.dynamics = std::make_shared<urdf::JointDynamics>(urdf::JointDynamics{joint.drive.viscous, joint.drive.dry});
    if (joint.moved.mass > 0.0) model.links_[made.child_link_name]->inertial = inertial_of(joint.moved);
    if (joint.mimic.joint >= 0) {
      made.mimic = std::make_shared<urdf::JointMimic>(
          urdf::JointMimic{joint.mimic.offset, joint.mimic.ratio,
                           prefix + chain.joints[static_cast<std::size_t>(joint.mimic.joint)].name});
    }
    parent = made.child_link_name;
    at = {};
  }
  add(model, "to_" + prefix + "flange", parent, prefix + "flange", chain.tip);
}

/// The robot_description of a chain to link "flange". The root "base_link" carries the chain and link "base", which is
/// the base frame of the chain. Link "base" is rotated relative to "base_link", as in the description of a UR.
[[nodiscard]] inline urdf::Model description_of(const fpbm::Chain<>& chain) {
  urdf::Model model;
  model.links_["base_link"] = std::make_shared<urdf::Link>(urdf::Link{"base_link", nullptr});
  fpbm::Transform<> turned;
  turned.R = fpbm::rotation(fpbm::Vector<3>(0.0, 0.0, 3.0));
  add(model, "to_base", "base_link", "base", turned);
  add_chain(model, chain, "base_link", "", turned);
  return model;
}

}  // namespace stand_in
