#pragma once

#include <geometry_msgs/msg/pose_stamped.hpp>
#include <string>
#include <vector>

// Stands in for the header that ROS generates from trajectory_msgs/JointTrajectory, and for the headers of its members.
namespace builtin_interfaces::msg {

struct Duration {
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;
};

}  // namespace builtin_interfaces::msg

namespace trajectory_msgs::msg {

struct JointTrajectoryPoint {
  std::vector<double> positions;
  std::vector<double> velocities;
  std::vector<double> accelerations;
  std::vector<double> effort;
  builtin_interfaces::msg::Duration time_from_start;
};
struct JointTrajectory {
  std_msgs::msg::Header header;
  std::vector<std::string> joint_names;
  std::vector<JointTrajectoryPoint> points;
};

}  // namespace trajectory_msgs::msg
