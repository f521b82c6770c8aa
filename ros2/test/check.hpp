#pragma once

#include <cstdio>
#include <fpbm_controllers/target.hpp>
#include <rclcpp/rclcpp.hpp>
#include <string>

inline int failures = 0;

inline void check(bool good, const char* what, double value) {
  std::printf("%-4s %-66s %.3g\n", good ? "ok" : "FAIL", what, value);
  if (!good) ++failures;
}

/// Whether the log since the last call contains a text.
inline bool logged(const std::string& text) {
  const bool found = stand_in::log.find(text) != std::string::npos;
  stand_in::log.clear();
  return found;
}

/// Message with a pose. stamp: [s], of a clock that differs from the clock of the robot.
inline geometry_msgs::msg::PoseStamped pose_message(const fpbm::Transform<>& pose, double stamp) {
  geometry_msgs::msg::PoseStamped message;
  message.header = {rclcpp::Time(static_cast<std::int64_t>(1e9 * (1000.0 + stamp))), "base"};
  message.pose = fpbm_controllers::message_of(pose);
  return message;
}

/// Message with a pose and without a stamp, which means the current time.
inline geometry_msgs::msg::PoseStamped pose_message(const fpbm::Transform<>& pose) {
  geometry_msgs::msg::PoseStamped message = pose_message(pose, 0.0);
  message.header.stamp = {};
  return message;
}

/// Sum of the distances of positions and orientations [m, rad].
inline double distance(const fpbm::Transform<>& a, const fpbm::Transform<>& b) {
  return (a.p - b.p).norm() + (a.R - b.R).norm();
}
