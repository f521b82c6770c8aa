#pragma once

#include <cstdio>
#include <fpbm_controllers/target.hpp>
#include <rclcpp/time.hpp>

inline int failures = 0;

inline void check(bool good, const char* what, double value) {
  std::printf("%-4s %-66s %.3g\n", good ? "ok" : "FAIL", what, value);
  if (!good) ++failures;
}

/// At a time of a clock that is not the robot's.
inline geometry_msgs::msg::PoseStamped pose_message(const fpbm::Transform<>& pose, double stamp) {
  geometry_msgs::msg::PoseStamped message;
  message.header = {rclcpp::Time(static_cast<std::int64_t>(1e9 * (1000.0 + stamp))), "panda_link0"};
  message.pose = fpbm_controllers::message_of(pose);
  return message;
}

/// Of positions and orientations [m, rad].
inline double distance(const fpbm::Transform<>& a, const fpbm::Transform<>& b) {
  return (a.p - b.p).norm() + (a.R - b.R).norm();
}
