#pragma once

#include <limits>

// Stands in for ros2_control's header of this name.
namespace joint_limits {

struct JointLimits {
  double min_position = 0.0;
  double max_position = 0.0;
  double max_velocity = 0.0;
  double max_acceleration = 0.0;
  double max_deceleration = 0.0;
  double max_jerk = 0.0;
  double max_effort = 0.0;
  bool has_position_limits = false;
  bool has_velocity_limits = false;
  bool has_acceleration_limits = false;
  bool has_deceleration_limits = false;
  bool has_jerk_limits = false;
  bool has_effort_limits = false;
};

struct SoftJointLimits {
  double min_position = std::numeric_limits<double>::quiet_NaN();
  double max_position = std::numeric_limits<double>::quiet_NaN();
  double k_position = std::numeric_limits<double>::quiet_NaN();
  double k_velocity = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace joint_limits
