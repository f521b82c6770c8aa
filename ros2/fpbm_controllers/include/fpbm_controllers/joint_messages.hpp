#pragma once

#include <fpbm_controllers/joint_chunk.hpp>
#include <std_msgs/msg/float64_multi_array.hpp>
#include <string>
#include <trajectory_msgs/msg/joint_trajectory.hpp>
#include <vector>

namespace fpbm_controllers {

/// Converts messages of joint positions. Not for the loop.
class JointMessages {
 public:
  JointMessages(std::vector<std::string> joints, const fpbm::JointLimits<Eigen::Dynamic>& limits);

  /// The points, in the order of the controller's joints. Throws std::invalid_argument with the reason if the message
  /// must be dropped.
  [[nodiscard]] JointChunk chunk_of(const trajectory_msgs::msg::JointTrajectory& message) const;
  [[nodiscard]] JointChunk chunk_of(const std_msgs::msg::Float64MultiArray& message) const;

 private:
  using Stream = fpbm::JointStream<fpbm::kMaxDof, double, 1>;
  using Padded = fpbm::Vector<fpbm::kMaxDof>;
  using Order = std::vector<std::size_t>;

  /// For each joint, its place in a message.
  [[nodiscard]] Order order_of(const std::vector<std::string>& names) const;
  [[nodiscard]] Padded numbers(const std::string& name, const std::vector<double>& values, const Order& order) const;
  [[nodiscard]] Padded posture(const std::string& name, const std::vector<double>& values, const Order& order) const;

  std::vector<std::string> joints_;
  Stream ranges_;  ///< Only for is_usable(): a stream that never moves.
};

}  // namespace fpbm_controllers
