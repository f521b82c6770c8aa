#pragma once

#include <joint_limits/joint_limits.hpp>
#include <string>
#include <unordered_map>

// Stands in for ros2_control's header of this name. Versions of ros2_control with get_hard_joint_limits() have this
// header.
namespace controller_interface {

struct ControllerInterfaceParams {
  std::string controller_name;
  std::string robot_description;
  unsigned int update_rate = 0;
  unsigned int controller_manager_update_rate = 0;
  std::unordered_map<std::string, joint_limits::JointLimits> hard_joint_limits;
};

}  // namespace controller_interface
