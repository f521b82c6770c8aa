#include "fpbm_controllers/joint_messages.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "fpbm_controllers/target.hpp"

namespace fpbm_controllers {

namespace {

using Padded = fpbm::Vector<fpbm::kMaxDof>;

void require(bool good, const std::string& message) {
  if (!good) throw std::invalid_argument(message);
}

}  // namespace

JointMessages::JointMessages(std::vector<std::string> joints, const fpbm::JointLimits<Eigen::Dynamic>& limits)
    : joints_(std::move(joints)), ranges_(stream_within<1>(limits)) {}

JointMessages::Order JointMessages::order_of(const std::vector<std::string>& names) const {
  Order order;
  for (const std::string& joint : joints_) {
    const auto found = std::find(names.begin(), names.end(), joint);
    require(found != names.end(), "joint_names: has no '" + joint + "': give all joints of the controller");
    order.push_back(static_cast<std::size_t>(found - names.begin()));
  }
  for (const std::string& name : names) {
    require(std::count(joints_.begin(), joints_.end(), name) == 1,
            "joint_names: '" + name + "' is not a joint of the controller: remove the joint");
  }
  require(names.size() == joints_.size(), "joint_names: has " + std::to_string(names.size()) + " names for " +
                                              std::to_string(joints_.size()) + " joints: name each joint once");
  return order;
}

Padded JointMessages::numbers(const std::string& name, const std::vector<double>& values, const Order& order) const {
  require(values.size() == joints_.size(), name + ": has " + std::to_string(values.size()) + " numbers: must have " +
                                               std::to_string(joints_.size()) + ", one for each joint");
  Padded result = Padded::Zero();
  for (std::size_t k = 0; k < joints_.size(); ++k) {
    const double value = values[order[k]];
    require(std::isfinite(value),
            name + ": is " + std::to_string(value) + " for joint '" + joints_[k] + "': must be finite");
    result(static_cast<Eigen::Index>(k)) = value;
  }
  return result;
}

Padded JointMessages::posture(const std::string& name, const std::vector<double>& values, const Order& order) const {
  const Padded q = numbers(name, values, order);
  if (ranges_.is_usable(q)) return q;
  Padded alone = ranges_.reference().x;
  for (std::size_t k = 0; k < joints_.size(); ++k) {
    const auto i = static_cast<int>(k);
    alone(i) = q(i);
    const auto [low, high] = ranges_.range(i);
    require(ranges_.is_usable(alone), name + ": is " + std::to_string(q(i)) + " for joint '" + joints_[k] +
                                          "', far outside its range, " + std::to_string(low) + " to " +
                                          std::to_string(high) + ": are the units radians and metres?");
  }
  return q;
}

JointChunk JointMessages::chunk_of(const trajectory_msgs::msg::JointTrajectory& message) const {
  const Order order = order_of(message.joint_names);
  const std::size_t count = message.points.size();
  constexpr int kMost = JointChunk::kPoints - 1;
  require(1 <= count && count <= kMost, "points: has " + std::to_string(count) + " points: must have 1 to " +
                                            std::to_string(kMost) + ": divide the message");
  JointChunk chunk;
  chunk.stamp = seconds(message.header.stamp);
  chunk.starts = seconds(message.points.front().time_from_start) > 0.0;
  if (chunk.starts) chunk.points.push_back({0.0, ranges_.reference().x, {}, {}});
  std::size_t index = 0;
  for (const auto& given : message.points) {
    const std::string name = "points[" + std::to_string(index++) + "].";
    JointChunk::Point point{
        seconds(given.time_from_start), posture(name + "positions", given.positions, order), {}, {}};
    require(chunk.points.empty() || point.time > chunk.points.back().time,
            name + "time_from_start: is " + std::to_string(point.time) + " s: must be greater than the previous time");
    if (!given.velocities.empty()) point.xd = numbers(name + "velocities", given.velocities, order);
    if (!given.accelerations.empty()) point.xdd = numbers(name + "accelerations", given.accelerations, order);
    chunk.points.push_back(point);
  }
  return chunk;
}

JointChunk JointMessages::chunk_of(const std_msgs::msg::Float64MultiArray& message) const {
  Order order(joints_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  JointChunk chunk;
  chunk.single = true;
  chunk.points.push_back({0.0, posture("data", message.data, order), {}, {}});
  return chunk;
}

}  // namespace fpbm_controllers
