#include "fpbm_controllers/target_controller.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <pluginlib/class_list_macros.hpp>

namespace fpbm_controllers {

using controller_interface::CallbackReturn;
using controller_interface::InterfaceConfiguration;
using controller_interface::return_type;

namespace {

/// The interfaces of one type after those of another, each in the order of the joints.
[[nodiscard]] InterfaceConfiguration interfaces(const std::vector<std::string>& joints,
                                                const std::vector<std::string>& types) {
  InterfaceConfiguration configuration{controller_interface::interface_configuration_type::INDIVIDUAL, {}};
  for (const auto& type : types) {
    for (const auto& joint : joints) configuration.names.push_back(joint + "/" + type);
  }
  return configuration;
}

}  // namespace

CallbackReturn TargetController::on_init() {
  try {
    listener_ = std::make_shared<target_controller::ParamListener>(get_node());
    params_ = listener_->get_params();
  } catch (const std::exception& error) {  // A parameter that is missing, or out of range.
    RCLCPP_ERROR(get_node()->get_logger(), "%s", error.what());
    return CallbackReturn::ERROR;
  }
  return CallbackReturn::SUCCESS;
}

InterfaceConfiguration TargetController::command_interface_configuration() const {
  return interfaces(params_.joints, params_.command_interfaces);
}

InterfaceConfiguration TargetController::state_interface_configuration() const {
  return interfaces(params_.joints, {"position"});
}

/// Makes all that allocates, and checks all that may throw but for where the arm stands.
CallbackReturn TargetController::on_configure(const rclcpp_lifecycle::State&) {
  const auto node = get_node();
  try {
    read_parameters();
  } catch (const std::exception& error) {
    RCLCPP_ERROR(node->get_logger(), "%s", error.what());
    return CallbackReturn::FAILURE;
  }
  open_topics();
  return CallbackReturn::SUCCESS;
}

/// Begins at rest where the arm stands. All that is made here has a fixed size and lies within the controller: the
/// controller manager may call this in its loop.
CallbackReturn TargetController::on_activate(const rclcpp_lifecycle::State&) {
  measured_ = Joints::Zero(arm_->dof());
  if (!measure()) {
    RCLCPP_ERROR(get_node()->get_logger(), "the joint positions cannot be read");
    return CallbackReturn::FAILURE;
  }
  try {
    const fpbm::State<kDof> state{measured_, Joints::Zero(measured_.size())};
    tracker_.emplace(*arm_, fpbm::Pose{}, scheme(measured_), state, options_, *limits_);
  } catch (const std::exception& error) {  // A joint outside its limits, say.
    RCLCPP_ERROR(get_node()->get_logger(), "%s", error.what());
    return CallbackReturn::FAILURE;
  }
  (void)filter_->reset(tracker_->tip());
  seen_ = target_.get().count;
  refused_ = missed_ = 0;
  lost_ = false;
  return CallbackReturn::SUCCESS;
}

/// The arm stays where the last command put it.
CallbackReturn TargetController::on_deactivate(const rclcpp_lifecycle::State&) {
  report_.set(Report{});
  if (!tracker_) return CallbackReturn::SUCCESS;
  const Joints& q = tracker_->state().q;
  return command(q, Joints::Zero(q.size())) ? CallbackReturn::SUCCESS : CallbackReturn::ERROR;
}

/// One tick a call, always of the length that the limits were made for: a late call makes the arm late, never fast.
///
/// An interface that another thread has locked is no error, for which the controller manager would deactivate the
/// controller in motion. Where it stays locked, the last reading falls behind the command, and the arm stops.
return_type TargetController::update(const rclcpp::Time& time, const rclcpp::Duration&) {
  take_target();
  const bool read = measure();
  const double behind = following_error();
  if (!(behind < params_.following_error)) {
    tracker_->stop();
    lost_ = true;
  }
  const auto tick = tracker_->tick(*filter_);
  if (!command(tick.q, tick.qd) || !read) ++missed_;
  Report report;
  report.active = true;
  report.lost = lost_;
  report.status = tick.status;
  report.scale = tick.scale;
  report.position_error = tick.error.head<3>().norm();
  report.orientation_error = tick.error.tail<3>().norm();
  report.following_error = behind;
  report.refused = refused_;
  report.missed = missed_;
  report.time = time;
  report.tip = tracker_->tip();
  (void)report_.try_set(report);
  return return_type::OK;
}

void TargetController::take_target() noexcept {
  const std::optional<Target> target = target_.try_get();
  if (!target || target->count == seen_) return;
  seen_ = target->count;
  const auto push = [&](auto... stamp) noexcept {
    return target->moves ? filter_->push_twist(target->twist, stamp...) : filter_->push(target->pose, stamp...);
  };
  const bool taken = target->stamp == 0.0 ? push() : push(target->stamp);
  if (!taken) ++refused_;
}

bool TargetController::measure() {
  bool all = true;
  for (Eigen::Index i = 0; i < measured_.size(); ++i) {
    const std::optional<double> value = state_interfaces_[static_cast<std::size_t>(i)].get_optional();
    if (value) measured_(i) = *value;
    all = all && value;
  }
  return all;
}

double TargetController::following_error() const {
  if (!measured_.allFinite()) return std::numeric_limits<double>::infinity();
  double worst = 0.0;
  for (Eigen::Index i = 0; i < measured_.size(); ++i) {
    double error = measured_(i) - tracker_->state().q(i);
    // Drivers wrap the angle of a joint that turns without end.
    if (!std::isfinite(arm_->limits().upper(i))) error = std::remainder(error, 6.283185307179586);
    worst = std::max(worst, std::abs(error));
  }
  return worst;
}

bool TargetController::command(const Joints& q, const Joints& qd) {
  const auto dof = static_cast<std::size_t>(q.size());
  bool taken = true;
  for (std::size_t k = 0; k < command_interfaces_.size(); ++k) {
    const auto joint = static_cast<Eigen::Index>(k % dof);
    const bool velocity = k >= dof;  // Positions come first: read_parameters().
    taken = command_interfaces_[k].set_value(velocity ? qd(joint) : q(joint)) && taken;
  }
  return taken;
}

}  // namespace fpbm_controllers

PLUGINLIB_EXPORT_CLASS(fpbm_controllers::TargetController, controller_interface::ControllerInterface)
