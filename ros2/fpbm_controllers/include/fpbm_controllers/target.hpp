#pragma once

#include <cmath>
#include <cstdint>
#include <fpbm/geometry/rotation.hpp>
#include <fpbm/geometry/space.hpp>
#include <geometry_msgs/msg/pose_stamped.hpp>
#include <geometry_msgs/msg/twist_stamped.hpp>
#include <optional>

namespace fpbm_controllers {

/// Target of a message, in the base frame: a pose or a twist.
struct Target {
  std::uint64_t count = 0;                          ///< Number of targets up to this target; 0: no target yet.
  double stamp = 0.0;                               ///< Time of the measurement [s]; 0: time of arrival.
  bool moves = false;                               ///< Whether the target is a twist.
  fpbm::Transform<> pose;                           ///< [m]
  fpbm::Vector<6> twist = fpbm::Vector<6>::Zero();  ///< [m/s, rad/s]
};

/// Seconds of a stamp or a duration.
template <typename Time>
[[nodiscard]] double seconds(const Time& time) {
  return static_cast<double>(time.sec) + 1e-9 * static_cast<double>(time.nanosec);
}

/// None if a number is not finite, or the quaternion's length differs from 1 by more than 0.01.
[[nodiscard]] inline std::optional<fpbm::Transform<>> transform_of(const geometry_msgs::msg::Pose& message) {
  const auto& p = message.position;
  const auto& o = message.orientation;
  const fpbm::Vector<4> q(o.w, o.x, o.y, o.z);
  fpbm::Transform<> pose;
  pose.p = {p.x, p.y, p.z};
  if (!pose.p.allFinite() || !(std::abs(q.norm() - 1.0) < 0.01)) return std::nullopt;
  pose.R = fpbm::rotation(fpbm::Vector<4>(q / q.norm()));
  return pose;
}

/// None if transform_of() returns none.
[[nodiscard]] inline std::optional<Target> target_of(const geometry_msgs::msg::PoseStamped& message) {
  const std::optional<fpbm::Transform<>> pose = transform_of(message.pose);
  if (!pose) return std::nullopt;
  Target target;
  target.stamp = seconds(message.header.stamp);
  target.pose = *pose;
  return target;
}

/// None if a number is not finite.
[[nodiscard]] inline std::optional<Target> target_of(const geometry_msgs::msg::TwistStamped& message) {
  const auto& v = message.twist.linear;
  const auto& w = message.twist.angular;
  Target target;
  target.stamp = seconds(message.header.stamp);
  target.moves = true;
  target.twist << v.x, v.y, v.z, w.x, w.y, w.z;
  if (!target.twist.allFinite()) return std::nullopt;
  return target;
}

/// A pose as a message.
[[nodiscard]] inline geometry_msgs::msg::Pose message_of(const fpbm::Transform<>& pose) {
  const fpbm::Vector<4> q = fpbm::quaternion(pose.R);
  geometry_msgs::msg::Pose message;
  message.position.x = pose.p(0);
  message.position.y = pose.p(1);
  message.position.z = pose.p(2);
  message.orientation.w = q(0);
  message.orientation.x = q(1);
  message.orientation.y = q(2);
  message.orientation.z = q(3);
  return message;
}

}  // namespace fpbm_controllers
