#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <controller_interface/controller_interface.hpp>
#include <counted_new.hpp>
#include <cstddef>
#include <fpbm/model/presets.hpp>
#include <fpbm/model/serial_arm.hpp>
#include <fpbm_controllers/target_controller_parameters.hpp>
#include <stdexcept>

namespace stand_in {

/// A Panda with a tool and limits of its own that follows its commands, and a controller manager that loads the
/// controller and calls it 1000 times a second. Watches every tick: what is allocated, and by how much a limit is
/// exceeded.
class Robot {
 public:
  static constexpr std::size_t kDof = 7;
  using Joints = std::array<double, kDof>;
  using Pose = fpbm::Transform<>;

  Robot() : controller_(exported_controller()) {
    limits_.velocity *= 0.8;
    limits_.acceleration *= 0.5;
    limits_.jerk *= 0.25;
    const auto given = [](const fpbm::Vector<7>& bound) { return std::vector<double>(bound.begin(), bound.end()); };
    auto& own = parameters;
    own.limits.velocity = given(limits_.velocity);
    own.limits.acceleration = given(limits_.acceleration);
    own.limits.jerk = given(limits_.jerk);
    own.tool.xyz = {0.02, 0.01, 0.1034};
    own.tool.rpy = {kRightAngle, 0.0, kRightAngle};
  }

  void load() {
    using controller_interface::CallbackReturn;
    good(controller_->on_init() == CallbackReturn::SUCCESS, "on_init");
    good(controller_->on_configure({}) == CallbackReturn::SUCCESS, "on_configure");
    good(controller_->command_interface_configuration().names.size() == 2 * kDof, "command interfaces");
    good(controller_->state_interface_configuration().names.size() == kDof, "state interfaces");
  }

  [[nodiscard]] bool activate() {
    std::vector<hardware_interface::LoanedCommandInterface> commands(command.begin(), command.end());
    for (double& value : velocity) commands.emplace_back(value);
    std::vector<hardware_interface::LoanedStateInterface> states(q.begin(), q.end());
    controller_->assign_interfaces(std::move(commands), std::move(states));
    command = last_ = q;
    last_velocity_ = last_acceleration_ = {};
    const long before = allocations;
    const bool active = controller_->on_activate({}) == controller_interface::CallbackReturn::SUCCESS;
    if (active) allocated += allocations - before;
    return active;
  }
  void deactivate() {
    good(controller_->on_deactivate({}) == controller_interface::CallbackReturn::SUCCESS, "on_deactivate");
    controller_->assign_interfaces({}, {});
  }

  /// A millisecond: the joints that are not held go where the command is.
  void tick() {
    ++ticks;
    const long before = allocations;
    const auto result = controller_->update(rclcpp::Time(ticks * 1000000), rclcpp::Duration(0, 1000000));
    allocated += allocations - before;
    good(result == controller_interface::return_type::OK, "update");
    for (std::size_t i = 0; i < kDof; ++i) {
      const auto joint = limits_.joint(static_cast<Eigen::Index>(i));
      const double v = (command[i] - last_[i]) / 1e-3;
      const double a = (v - last_velocity_[i]) / 1e-3;
      const double j = (a - last_acceleration_[i]) / 1e-3;
      last_[i] = command[i];
      last_velocity_[i] = v;
      last_acceleration_[i] = a;
      if (!watched) continue;
      excess = std::max({excess, joint.lower - command[i], command[i] - joint.upper, std::abs(v) - joint.velocity,
                         std::abs(velocity[i]) - joint.velocity});
      acceleration_excess = std::max(acceleration_excess, std::abs(a) / joint.acceleration - 1.0);
      jerk_excess = std::max(jerk_excess, std::abs(j) / joint.jerk - 1.0);
    }
    if (!held) q = command;
  }
  void tick(int count) {
    for (int i = 0; i < count; ++i) tick();
  }

  [[nodiscard]] Pose tip() const {
    fpbm::Kinematics<fpbm::Pose, 7> kinematics;
    arm_.kinematics(fpbm::Vector<7>(q.data()), kinematics);
    return kinematics.tip;
  }
  /// The fastest joint's velocity in the last tick [rad/s].
  [[nodiscard]] double speed() const {
    double fastest = 0.0;
    for (const double v : last_velocity_) fastest = std::max(fastest, std::abs(v));
    return fastest;
  }

  template <typename Message>
  void hear(const std::string& topic, const Message& message) {
    std::any_cast<std::shared_ptr<rclcpp::Subscription<Message>>>(topics().at(topic))->hear(message);
  }
  template <typename Message>
  [[nodiscard]] const rclcpp::Publisher<Message>& said(const std::string& topic) {
    for (const auto& timer : controller_->get_node()->timers) timer->fire();
    return *std::any_cast<std::shared_ptr<rclcpp::Publisher<Message>>>(topics().at(topic));
  }

  Joints q{0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785};
  Joints command = q;
  Joints velocity{};
  bool held = false;  ///< By somebody's hand.
  bool watched = true;
  std::int64_t ticks = 0;
  long allocated = 0;
  double excess = 0.0;               ///< Of a bound on position or velocity [rad, rad/s].
  double acceleration_excess = 0.0;  ///< As a share of the bound.
  double jerk_excess = 0.0;          ///< As a share of the bound.

 private:
  static constexpr double kRightAngle = 1.5707963267948966;

  /// The tool's x axis is the flange's y, its y the flange's z, its z the flange's x.
  static fpbm::Chain<> chain() {
    fpbm::Chain<> panda = fpbm::presets::panda();
    fpbm::Transform<> tool;
    tool.p = {0.02, 0.01, 0.1034};
    tool.R << 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0;
    panda.tip = panda.tip * tool;
    return panda;
  }
  static void good(bool is_good, const char* what) {
    if (!is_good) throw std::runtime_error(what);
  }
  std::map<std::string, std::any>& topics() { return controller_->get_node()->topics; }

  std::unique_ptr<controller_interface::ControllerInterface> controller_;
  fpbm::SerialArm<7> arm_{chain()};
  fpbm::JointLimits<7> limits_ = arm_.limits();
  Joints last_{};
  Joints last_velocity_{};
  Joints last_acceleration_{};
};

}  // namespace stand_in
