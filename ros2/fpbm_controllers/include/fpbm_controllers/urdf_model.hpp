#pragma once

#include <fpbm/geometry/rotation.hpp>
#include <fpbm_controllers/description.hpp>
#include <stdexcept>
#include <string>
#if __has_include(<urdf/model.hpp>)
#include <urdf/model.hpp>
#else
#include <urdf/model.h>
#endif

namespace fpbm_controllers {

/// Throws std::invalid_argument if the text is missing or is not a URDF.
[[nodiscard]] inline urdf::Model model_of(const std::string& robot_description) {
  urdf::Model model;
  if (robot_description.empty() || !model.initString(robot_description)) {
    throw std::invalid_argument("robot_description: is missing, or is not a URDF: publish the robot's URDF");
  }
  return model;
}

[[nodiscard]] inline fpbm::Transform<> transform_of(const urdf::Pose& pose) {
  const auto& [p, q] = pose;
  return {{p.x, p.y, p.z}, fpbm::rotation(fpbm::Vector<4>(q.w, q.x, q.y, q.z))};
}

/// The place of a link: a link of the tree, and the frame of the link in its frame. Joints that are not in the tree are
/// at zero. A link that no joint of the tree moves is placed in the frame of link base. Throws std::invalid_argument,
/// which names the parameter, if the link does not exist.
[[nodiscard]] fpbm::NamedFrame<> frame_of(const fpbm::Tree<>& tree, const urdf::Model& model, const std::string& base,
                                          const NamedLink& named);

/// The frame of a joint at position zero, in the frame of the parent link.
[[nodiscard]] inline fpbm::Transform<> origin_of(const urdf::Joint& joint) {
  return transform_of(joint.parent_to_joint_origin_transform);
}

}  // namespace fpbm_controllers
