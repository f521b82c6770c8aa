#pragma once

#include <joint_limits/joint_limits.hpp>
#include <map>
#include <string>
#include <unordered_map>
#include <vector>

// Stands in for ros2_control's headers of this name and hardware_info.hpp. Nothing is parsed: the test registers the
// result under the text of robot_description. The limits of a joint are the narrowest of the joint and its tag.
namespace hardware_interface {

struct HardwareInfo {
  std::unordered_map<std::string, joint_limits::JointLimits> limits;
  std::unordered_map<std::string, joint_limits::SoftJointLimits> soft_limits;
};

}  // namespace hardware_interface

namespace stand_in {

inline std::map<std::string, hardware_interface::HardwareInfo>& hardware() {
  static std::map<std::string, hardware_interface::HardwareInfo> all;
  return all;
}

}  // namespace stand_in

namespace hardware_interface {

inline std::vector<HardwareInfo> parse_control_resources_from_urdf(const std::string& urdf) {
  return {stand_in::hardware()[urdf]};
}

}  // namespace hardware_interface
