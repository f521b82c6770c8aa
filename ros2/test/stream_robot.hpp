#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <std_msgs/msg/float64_multi_array.hpp>
#include <trajectory_msgs/msg/joint_trajectory.hpp>
#include <vector>

#include "clear_robot.hpp"

using std_msgs::msg::Float64MultiArray;
using trajectory_msgs::msg::JointTrajectory;
using Posture = fpbm::Vector<7>;

/// A Panda that follows joint positions.
class StreamRobot : public ClearRobot {
 public:
  explicit StreamRobot(double margin = 0.0, double delay = 0.0) {
    auto& own = stand_in::parameters;
    own.input = "joints";
    own.clearance.margin = margin;
    own.stream.delay = delay;
  }
  /// Largest distance of a joint from a posture [rad].
  [[nodiscard]] double from(const Posture& other) const { return (posture() - other).cwiseAbs().maxCoeff(); }
};

inline const Posture kStart = [] {
  Posture q;
  q << 0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785;
  return q;
}();

/// Motion of a policy at t [s], from rest.
inline Posture wave(double t) {
  return kStart + Posture::Constant(0.25 * (1.0 - std::cos(3.0 * std::max(t, 0.0))));
}

inline std::vector<double> list(const Posture& q) {
  return {q.begin(), q.end()};
}

/// Postures from `stamp` [s] on, on a clock that differs from the clock of the robot; -1000: the current time. The
/// order of the joints is reversed.
inline JointTrajectory message(double stamp, int count, const std::function<Posture(double)>& motion) {
  JointTrajectory result;
  result.header.stamp = rclcpp::Time(static_cast<std::int64_t>(1e9 * (1000.0 + stamp)));
  result.joint_names.assign(stand_in::parameters.joints.rbegin(), stand_in::parameters.joints.rend());
  for (int k = 0; k < count; ++k) {
    trajectory_msgs::msg::JointTrajectoryPoint point;
    point.time_from_start.nanosec = static_cast<std::uint32_t>(k % 50) * 20000000U;
    point.time_from_start.sec = k / 50;
    point.positions = list(motion(stamp + 0.02 * k).reverse());
    result.points.push_back(point);
  }
  return result;
}
/// A posture to which the arm moves in minimum time.
inline JointTrajectory message(const Posture& q) {
  return message(-1000.0, 1, [&q](double) { return q; });
}
