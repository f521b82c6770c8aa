#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <controller_interface/controller_interface.hpp>
#include <counted_new.hpp>
#include <cstddef>
#include <deque>
#include <fpbm/model/joint.hpp>
#include <fpbm_controllers/target_controller_parameters.hpp>
#include <joint_limits/joint_limits.hpp>
#include <limits>
#include <stdexcept>
#include <vector>

namespace stand_in {

enum class Lifecycle { kUnconfigured, kInactive, kActive, kFinalized };

/// Joints that follow their commands with a lag and an offset, and a controller manager that loads and calls the
/// controller. Records the allocations and the largest excess over the limits in all calls.
template <std::size_t Dof>
class Driven {
 public:
  static constexpr std::size_t kDof = Dof;
  using Joints = std::array<double, Dof>;
  using JointLimits = fpbm::JointLimits<static_cast<int>(Dof)>;
  using CallbackReturn = controller_interface::CallbackReturn;
  using Overrides = std::map<std::string, rclcpp::ParameterValue>;

  virtual ~Driven() = default;

  /// start: posture at rest. Resets the parameters to their defaults.
  Driven(const std::string& robot_description, const JointLimits& limits, const Joints& start)
      : description{"targets", robot_description, 0, 0}, q(start), limits_(limits) {
    parameters = {};
    command.fill(std::numeric_limits<double>::quiet_NaN());  // Like hardware before the first command.
  }

  /// Loads and configures the controller. Returns false if the controller rejects its parameters.
  [[nodiscard]] bool load(const Overrides& overrides = {}) {
    description.controller_manager_update_rate = description.update_rate = rate;
    if (controller_->init(description, overrides) != controller_interface::return_type::OK) return false;
    return configure();
  }
  [[nodiscard]] bool configure() { return change(controller_->configure(), Lifecycle::kInactive); }
  bool cleanup() { return change(controller_->on_cleanup({}), Lifecycle::kUnconfigured); }
  [[nodiscard]] bool activate() {
    good(state == Lifecycle::kInactive, "activated from another state than inactive");
    std::vector<hardware_interface::LoanedCommandInterface> commands;
    for (const std::string& type : parameters.command_interfaces) {
      Joints& values = type == "position" ? command : type == "velocity" ? velocity : torque;
      for (std::size_t i = 0; i < kDof; ++i) commands.emplace_back(values[i], command_locks[commands.size()]);
    }
    std::vector<hardware_interface::LoanedStateInterface> states;
    for (std::size_t i = 0; i < kDof; ++i) states.emplace_back(q[i], state_locks[i]);
    if (parameters.state_interfaces.size() == 2) {
      for (std::size_t i = 0; i < kDof; ++i) states.emplace_back(measured_velocity[i], state_locks[kDof + i]);
    }
    controller_->assign_interfaces(std::move(commands), std::move(states));
    last_velocity_ = last_acceleration_ = {};
    // If the arm does not follow its command, the controller starts at the measured posture.
    for (std::size_t i = 0; i < kDof; ++i) last_[i] = std::abs(command[i] - q[i]) < 0.05 ? command[i] : q[i];
    first_ = true;
    seconds_since_call_ = 0.0;
    const long before = allocations;
    const bool active = change(controller_->on_activate({}), Lifecycle::kActive);
    if (active) allocated += allocations - before;
    return active;
  }
  void deactivate() {
    (void)change(controller_->on_deactivate({}), Lifecycle::kInactive);
    controller_->release_interfaces();
  }

  /// A tick of the manager and of the hardware. By default, unless the arm is held, its joints follow the command from
  /// `lag` ticks ago.
  void tick() { tick(1.0 / rate); }
  /// A tick `period` [s] after the last tick.
  void tick(double period) {
    const double own = controller_->get_update_rate();
    seconds_since_call_ += period;
    // The manager calls a slower controller in the tick that is nearest to the controller's period.
    const double error = std::abs(seconds_since_call_ * own - 1.0);
    const double later = std::abs((seconds_since_call_ + 1.0 / rate) * own - 1.0);
    time_ += static_cast<std::int64_t>(1e9 * period);
    if (state == Lifecycle::kActive) {
      if (first_ && own < rate) seconds_since_call_ = 1.0 / own;
      if (own >= rate || first_ || error <= later) call(seconds_since_call_);
    }
    if (state == Lifecycle::kActive && !soft_limits.empty()) limit_softly(period);
    move(period);
  }
  void tick(int count) {
    for (int i = 0; i < count; ++i) tick();
  }

  /// Largest joint speed in the last tick [rad/s].
  [[nodiscard]] double speed() const {
    double fastest = 0.0;
    for (const double v : last_velocity_) fastest = std::max(fastest, std::abs(v));
    return fastest;
  }

  template <typename Message>
  [[nodiscard]] std::shared_ptr<rclcpp::Subscription<Message>> subscription(const std::string& topic) {
    return std::any_cast<std::weak_ptr<rclcpp::Subscription<Message>>>(topics().at(topic)).lock();
  }
  template <typename Message>
  void hear(const std::string& topic, const Message& message,
            const rclcpp::QoS& offered = rclcpp::SystemDefaultsQoS()) {
    subscription<Message>(topic)->hear(message, offered);
  }
  /// Fires the timers of the node, then returns the publisher of a topic.
  template <typename Message>
  [[nodiscard]] const rclcpp::Publisher<Message>& said(const std::string& topic) {
    for (const auto& timer : controller_->get_node()->timers) {
      if (const auto alive = timer.lock()) alive->fire();
    }
    return *std::any_cast<std::weak_ptr<rclcpp::Publisher<Message>>>(topics().at(topic)).lock();
  }
  /// Number of existing objects of the controller: the subscription of a topic, and the timers.
  template <typename Message>
  [[nodiscard]] std::size_t alive(const std::string& topic) {
    std::size_t count = subscription<Message>(topic) ? 1 : 0;
    for (const auto& timer : controller_->get_node()->timers) count += timer.expired() ? 0 : 1;
    return count;
  }

  unsigned int rate = 1000;  ///< Update rate of the manager [Hz].
  controller_interface::ControllerInterfaceParams description;
  Lifecycle state = Lifecycle::kUnconfigured;
  Joints q;
  Joints command{};
  Joints velocity{};
  Joints torque{};
  Joints measured_velocity{};
  std::array<Lock, 3 * kDof> command_locks{};
  std::array<Lock, 2 * kDof> state_locks{};
  double offset = 0.0;  ///< Offset of each joint from its command [rad].
  std::size_t lag = 0;  ///< [ticks]
  bool held = false;    ///< Whether a person holds the arm.
  bool watched = true;
  /// Soft limits that the manager enforces on positions; empty: the manager enforces none.
  std::vector<joint_limits::SoftJointLimits> soft_limits;
  int enforced = 0;  ///< Number of ticks in which the manager changed a position.
  std::int64_t calls = 0;
  double seconds_of_call = 0.0;  ///< Time of the last call of update() [s].
  long allocated = 0;
  double excess = -1e9;               ///< Excess over a bound on position or velocity [rad, rad/s].
  double acceleration_excess = -1.0;  ///< Relative to the bound.
  double jerk_excess = -1.0;          ///< Relative to the bound.
  double effort_ratio = 0.0;          ///< Largest torque relative to the effort; infinite if a torque is NaN.

 protected:
  /// Moves the joints for `period` [s].
  virtual void move(double period) {
    past_.push_back(soft_limits.empty() ? command : limited_);
    if (past_.size() > lag + 1) past_.pop_front();
    for (std::size_t i = 0; i < kDof && !held; ++i) {
      if (std::isnan(past_.front()[i])) continue;
      const double next = past_.front()[i] + offset;
      measured_velocity[i] = (next - q[i]) / period;
      q[i] = next;
    }
  }

 private:
  /// The soft limiter of ros2_control 6.8 for positions.
  void limit_softly(double period) {
    bool changed = false;
    for (std::size_t i = 0; i < kDof; ++i) {
      const auto& soft = soft_limits[i];
      const double before = std::isnan(limited_[i]) ? q[i] : limited_[i];
      const double most = limits_.velocity(static_cast<Eigen::Index>(i));
      const double low = std::clamp(-soft.k_position * (before - soft.min_position), -most, most);
      const double high = std::clamp(-soft.k_position * (before - soft.max_position), -most, most);
      limited_[i] = std::clamp(command[i], before + low * period, before + high * period);
      changed = changed || std::abs(limited_[i] - command[i]) > 1e-9;
    }
    enforced += changed ? 1 : 0;
  }
  static void good(bool is_good, const char* what) {
    if (!is_good) throw std::runtime_error(what);
  }
  std::map<std::string, std::any>& topics() { return controller_->get_node()->topics; }

  /// Sets the state after a transition. If on_error() does not succeed after an error, the state is final.
  bool change(CallbackReturn result, Lifecycle goal) {
    if (result == CallbackReturn::SUCCESS) state = goal;
    if (result == CallbackReturn::ERROR) {
      const bool mended = controller_->on_error({}) == CallbackReturn::SUCCESS;
      state = mended ? Lifecycle::kUnconfigured : Lifecycle::kFinalized;
      controller_->release_interfaces();
    }
    return result == CallbackReturn::SUCCESS;
  }

  /// Calls the controller `seconds` [s] after the last call. If a locked interface leaves the command of a joint
  /// unchanged, the joint is at rest after this call.
  void call(double seconds) {
    ++calls;
    const int refusals_before = refusals;
    const long before = allocations;
    const auto begin = std::chrono::steady_clock::now();
    const auto result = controller_->update(rclcpp::Time(time_), rclcpp::Duration::from_seconds(seconds));
    seconds_of_call = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    allocated += allocations - before;
    good(result == controller_interface::return_type::OK, "update");
    const bool refused = refusals != refusals_before;
    for (std::size_t i = 0; i < kDof; ++i) {
      if ((refused || refused_before_) && command[i] == last_[i]) {
        last_velocity_[i] = last_acceleration_[i] = 0.0;
        continue;
      }
      const auto joint = limits_.joint(static_cast<Eigen::Index>(i));
      effort_ratio = std::max(effort_ratio, std::abs(torque[i]) / joint.effort);
      if (std::isnan(torque[i])) effort_ratio = std::numeric_limits<double>::infinity();
      if (std::isnan(command[i])) continue;  // Commands without positions.
      const double v = (command[i] - last_[i]) / seconds;
      const double a = (v - last_velocity_[i]) / seconds;
      const double j = (a - last_acceleration_[i]) / seconds;
      last_[i] = command[i];
      last_velocity_[i] = v;
      last_acceleration_[i] = a;
      if (!watched) continue;
      excess = std::max({excess, joint.lower - command[i], command[i] - joint.upper, std::abs(v) - joint.velocity,
                         std::abs(velocity[i]) - joint.velocity});
      acceleration_excess = std::max(acceleration_excess, std::abs(a) / joint.acceleration - 1.0);
      jerk_excess = std::max(jerk_excess, std::abs(j) / joint.jerk - 1.0);
    }
    refused_before_ = refused;
    first_ = false;
    seconds_since_call_ = 0.0;
  }

  std::unique_ptr<controller_interface::ControllerInterface> controller_ = exported_plugin();
  JointLimits limits_;
  std::deque<Joints> past_;
  Joints last_{};
  Joints limited_ = [] {
    Joints none;
    none.fill(std::numeric_limits<double>::quiet_NaN());
    return none;
  }();
  Joints last_velocity_{};
  Joints last_acceleration_{};
  bool refused_before_ = false;
  std::int64_t time_ = 0;  ///< [ns]
  double seconds_since_call_ = 0.0;
  bool first_ = true;
};

}  // namespace stand_in
