#pragma once

#include <fpbm/geometry/rotation.hpp>
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

/// The frame of a joint at position zero, in the frame of the parent link.
[[nodiscard]] inline fpbm::Transform<> origin_of(const urdf::Joint& joint) {
  return transform_of(joint.parent_to_joint_origin_transform);
}

}  // namespace fpbm_controllers
