#include "fpbm_controllers/target_controller.hpp"

#include <cmath>
#include <exception>
#include <limits>
#include <pluginlib/class_list_macros.hpp>
#include <stdexcept>

#include "fpbm_controllers/parameter_listener.hpp"

namespace fpbm_controllers {

using controller_interface::CallbackReturn;
using controller_interface::InterfaceConfiguration;
using controller_interface::return_type;

namespace {

/// The interfaces in the order of their types, and for each type in the order of the joints.
[[nodiscard]] InterfaceConfiguration interfaces(const std::vector<std::string>& joints,
                                                const std::vector<std::string>& types) {
  InterfaceConfiguration configuration{controller_interface::interface_configuration_type::INDIVIDUAL, {}};
  for (const auto& type : types) {
    for (const auto& joint : joints) configuration.names.emplace_back(joint).append("/").append(type);
  }
  return configuration;
}

/// The first of the joints whose bits are set.
[[nodiscard]] std::optional<std::size_t> first_of(fpbm::JointBits joints) {
  if (joints == 0) return std::nullopt;
  std::size_t first = 0;
  while ((joints >> first & 1U) == 0) ++first;
  return first;
}

}  // namespace

CallbackReturn TargetController::on_init() {
  manager_rate_ = get_update_rate();  // The manager's rate, until the controller is configured.
  try {
    listener_ = listen_to_parameters(get_node());
    params_ = listener_->get_params();
  } catch (const std::exception& error) {  // A parameter that is missing, out of range, or unknown.
    RCLCPP_ERROR(get_node()->get_logger(), "%s", error.what());
    return CallbackReturn::ERROR;
  }
  return CallbackReturn::SUCCESS;
}

InterfaceConfiguration TargetController::command_interface_configuration() const {
  return interfaces(params_.joints, params_.command_interfaces);
}

InterfaceConfiguration TargetController::state_interface_configuration() const {
  return interfaces(params_.joints, params_.state_interfaces);
}

/// Constructs all objects that allocate, and makes all checks that may throw, except the check of the arm's position.
CallbackReturn TargetController::on_configure(const rclcpp_lifecycle::State&) {
  try {
    read_parameters();
    topics_.emplace(*get_node(), params_, tasks_, std::move(obstacles_), limits_->bounds());
  } catch (const std::exception& error) {
    RCLCPP_ERROR(get_node()->get_logger(), "%s", error.what());
    close();
    return CallbackReturn::FAILURE;
  }
  return CallbackReturn::SUCCESS;
}

void TargetController::close() {
  topics_.reset();
  motion_.reset();
  bounds_.reset();
}

CallbackReturn TargetController::on_cleanup(const rclcpp_lifecycle::State&) {
  close();
  return CallbackReturn::SUCCESS;
}

CallbackReturn TargetController::on_shutdown(const rclcpp_lifecycle::State&) {
  close();
  return CallbackReturn::SUCCESS;
}

/// After an error the controller can be configured again.
CallbackReturn TargetController::on_error(const rclcpp_lifecycle::State&) {
  close();
  return CallbackReturn::SUCCESS;
}

/// Constructs only objects of fixed size within the controller: the loop of the manager may call this function.
CallbackReturn TargetController::on_activate(const rclcpp_lifecycle::State&) {
  try {
    start_ = start();
    (void)take(topics_->exchange().clearance, bounds_.clearance);
    bounds_.require(start_);
    motion_->begin(start_, start_);
  } catch (const std::exception& error) {  // For example, a joint is outside its limits.
    RCLCPP_ERROR(get_node()->get_logger(), "%s", error.what());
    return CallbackReturn::FAILURE;
  }
  pace_ = Pace(dt_);
  command_ = motion_->state();
  accepted_ = start_;
  for (std::size_t k = 0; k < tasks_.size(); ++k) {
    newest_[k] = Target{};
    newest_stamp_[k] = 0.0;
    seen_[k] = topics_->exchange().tasks[k].target.get().count;
  }
  (void)take(topics_->exchange().chunk, chunk_);  // Earlier joint positions are ignored.
  locked_for_ = 0;
  report_ = Report{};
  return CallbackReturn::SUCCESS;
}

/// Returns the last command of all joints, or the measured positions if there is no command or the arm does not follow
/// the command. A start from the measured positions makes the command jump by the lag and the steady-state error of the
/// arm.
TargetController::Joints TargetController::start() {
  const auto require = [&](bool good, std::size_t joint, const char* what) {
    if (!good) throw std::runtime_error("joint '" + params_.joints[joint] + "': " + what);
  };
  const std::size_t dof = params_.joints.size();
  measured_ = measured_velocity_ = Joints::Zero(robot_->dof());
  if (const auto joint = measure()) require(false, *joint, "its state is locked by another thread: activate again");
  Joints q = measured_;
  bool follows = true;
  for (std::size_t k = 0; k < dof; ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    require(std::isfinite(measured_(i)), k, "its position is not a number: check the hardware, then activate again");
    if (has_positions()) {
      const std::optional<double> last = command_interfaces_[k].get_optional();
      require(last.has_value(), k, "its command is locked by another thread: activate again");
      follows = follows && std::isfinite(*last) && std::abs(difference(i, *last, q(i))) < params_.following_error;
      if (follows) q(i) = *last;
    }
    if (state_interfaces_.size() == dof) continue;
    const double velocity = state_interfaces_[dof + k].get_optional().value_or(0.0);
    require(std::isfinite(velocity), k, "its velocity is not a number: check the hardware, then activate again");
    require(std::abs(velocity) <= limits_->bounds().acceleration(i) * dt_, k,
            "moves too fast to stop within a tick: activate when the arm is at rest");
  }
  if (!follows) q = measured_;
  const JointLimits& bounds = limits_->bounds();
  for (std::size_t k = 0; k < dof; ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    constexpr double kRoundOff = 1e-9;
    require(bounds.lower(i) - kRoundOff <= q(i) && q(i) <= bounds.upper(i) + kRoundOff, k,
            "is beyond its range: move the joint back, then activate again");
  }
  return q;
}

/// The arm stays at the last command. As with the controllers of ros2_controllers, velocities and torques become 0. A
/// joint with a locked command interface keeps its previous command.
CallbackReturn TargetController::on_deactivate(const rclcpp_lifecycle::State&) {
  topics_->exchange().report.set(Report{});
  command_.qd.setZero();
  if (const auto joint = write(command_.qd)) {
    RCLCPP_WARN(get_node()->get_logger(), "joint '%s': its command is locked by another thread, and stays unchanged",
                params_.joints[*joint].c_str());
  }
  return CallbackReturn::SUCCESS;
}

/// An interface that another thread has locked is not an error: after an error, the controller manager would deactivate
/// the controller in motion. The arm waits at the positions that the joints have accepted until no interface is locked,
/// and then starts from rest, if the positions keep all bounds. If the wait is too long, the arm stops. With torques
/// alone, an arm cannot wait in motion: a locked joint keeps its previous torque. If readings stay locked, the last
/// reading deviates more and more from the command, and the arm stops.
return_type TargetController::update(const rclcpp::Time& time, const rclcpp::Duration& period) {
  take_messages();
  const bool read = !measure();
  compare();
  const fpbm::State<kDof> before = command_;
  const bool waits = locked_for_ > 0 && has_positions();
  if (!waits) advance(period.seconds());
  if (torque_) set_torques(before, waits ? Joints(Joints::Zero(before.q.size())) : motion_->acceleration());
  const auto locked = write(torque_ ? torque_->torque() : command_.qd);
  locked_for_ = locked ? locked_for_ + 1 : 0;
  if (locked_for_ == kLongestLock) stop(Fault::kLocked, *locked);
  if (locked && has_positions()) command_ = {accepted_, Joints::Zero(accepted_.size())};
  if (!locked && waits && !restart()) locked_for_ = 1;
  if (locked || !read) ++report_.missed;
  report_.active = true;
  report_.time = time;
  report_.q = command_.q;
  motion_->locate(report_);
  (void)topics_->exchange().report.try_set(report_);
  return return_type::OK;
}

void TargetController::take_messages() noexcept {
  (void)take(topics_->exchange().clearance, bounds_.clearance);
  if (const std::optional<double> speed = topics_->exchange().speed.try_get()) {
    motion_->set_speed(*speed);
    report_.speed = *speed;
  }
  for (std::size_t k = 0; k < tasks_.size(); ++k) {
    const std::optional<Target> target = topics_->exchange().tasks[k].target.try_get();
    if (!target || target->count == seen_[k]) continue;
    seen_[k] = target->count;
    const bool accepted = motion_->push(k, *target);
    if (accepted) newest_[k] = *target;
    count(k, accepted, target->stamp);
  }
  if (take(topics_->exchange().chunk, chunk_)) count(0, motion_->push_chunk(*chunk_), chunk_->stamp);
}

void TargetController::count(std::size_t task, bool accepted, double stamp) noexcept {
  if (!accepted) {
    ++report_.tasks[task].rejected;
    report_.tasks[task].ahead = stamp > newest_stamp_[task];
  } else if (stamp != 0.0) {
    newest_stamp_[task] = stamp;
  }
}

void TargetController::advance(double period) noexcept {
  if (pace_.starts(period)) {
    tick_start_ = motion_->state();
    motion_->tick(report_);
  } else {
    ++report_.early;
  }
  command_ = motion_->state();
  if (!(pace_.left() > 0.0)) return;
  const double t = dt_ - pace_.left();
  const Joints& acceleration = motion_->acceleration();
  command_.q = tick_start_.q + t * tick_start_.qd + t * t / 2.0 * acceleration;
  command_.qd = tick_start_.qd + t * acceleration;
}

bool TargetController::restart() {
  if (!bounds_.admit(command_.q)) {
    report_.status = fpbm::Status::kBlocked;
    return false;
  }
  motion_->begin(command_.q, start_);
  pace_ = Pace(dt_);
  if (report_.fault != Fault::kNone) motion_->stop();
  for (std::size_t k = 0; k < tasks_.size(); ++k) {
    Target again = newest_[k];
    again.stamp = 0.0;
    if (again.count > 0 && !again.moves) (void)motion_->push(k, again);
  }
  return true;
}

std::optional<std::size_t> TargetController::measure() {
  const auto read = [this](std::size_t first, Joints& readings) {
    fpbm::JointBits unread = 0;
    for (Eigen::Index i = 0; i < readings.size(); ++i) {
      const std::optional<double> value = state_interfaces_[first + static_cast<std::size_t>(i)].get_optional();
      if (!value) unread |= fpbm::joint_bit(i);
      readings(i) = value.value_or(readings(i));
    }
    return unread;
  };
  unread_positions_ = read(0, measured_);
  if (has_feedback()) unread_velocities_ = read(params_.joints.size(), measured_velocity_);
  return first_of(unread_positions_ | unread_velocities_);
}

double TargetController::difference(Eigen::Index i, double a, double b) const noexcept {
  return std::isfinite(robot_->limits().upper(i)) ? a - b : std::remainder(a - b, 6.283185307179586);
}

void TargetController::compare() {
  double largest = 0.0;
  std::size_t joint = 0;
  for (Eigen::Index i = 0; i < measured_.size(); ++i) {
    const double error = std::isfinite(measured_velocity_(i)) ? std::abs(difference(i, measured_(i), command_.q(i)))
                                                              : std::numeric_limits<double>::quiet_NaN();
    if (!(error <= largest)) {
      largest = error;
      joint = static_cast<std::size_t>(i);
      if (std::isnan(error)) break;
    }
  }
  if (report_.fault == Fault::kNone) report_.following_error = largest;
  if (!(largest < params_.following_error)) {
    stop(std::isfinite(largest) ? Fault::kFollowing : Fault::kUnreadable, joint);
  }
}

void TargetController::stop(Fault fault, std::size_t joint) noexcept {
  motion_->stop();
  if (report_.fault != Fault::kNone) return;
  report_.fault = fault;
  report_.fault_joint = joint;
}

void TargetController::set_torques(const fpbm::State<kDof>& commanded, const Joints& acceleration) noexcept {
  fpbm::State<kDof> measured = commanded;
  const auto is_read = [](fpbm::JointBits unread, Eigen::Index i, double value) {
    return (unread & fpbm::joint_bit(i)) == 0 && std::isfinite(value);
  };
  for (Eigen::Index i = 0; i < measured_.size(); ++i) {
    if (is_read(unread_positions_, i, measured_(i))) measured.q(i) += difference(i, measured_(i), commanded.q(i));
    if (is_read(unread_velocities_, i, measured_velocity_(i))) measured.qd(i) = measured_velocity_(i);
  }
  if (const auto limited = first_of(torque_->tick(commanded, acceleration, measured))) {
    ++report_.limited;
    report_.limited_joint = *limited;
  }
}

std::optional<std::size_t> TargetController::write(const Joints& torque) {
  std::optional<std::size_t> locked;
  auto interface = command_interfaces_.begin();
  for (const std::string& type : params_.command_interfaces) {
    const Joints& values = type == "position" ? command_.q : type == "velocity" ? command_.qd : torque;
    for (Eigen::Index i = 0; i < values.size(); ++i) {
      if (!(interface++)->set_value(values(i))) {
        locked = static_cast<std::size_t>(i);
      } else if (type == "position") {
        accepted_(i) = values(i);
      }
    }
  }
  return locked;
}

}  // namespace fpbm_controllers

PLUGINLIB_EXPORT_CLASS(fpbm_controllers::TargetController, controller_interface::ControllerInterface)
