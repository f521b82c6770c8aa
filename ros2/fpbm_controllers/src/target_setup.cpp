#include <algorithm>
#include <cmath>
#include <fpbm/model/presets.hpp>
#include <stdexcept>

#include "fpbm_controllers/description.hpp"
#include "fpbm_controllers/sourced_limits.hpp"
#include "fpbm_controllers/target_controller.hpp"

namespace fpbm_controllers {

namespace {

[[nodiscard]] fpbm::Chain<> preset(const std::string& name) {
  for (const auto& arm : fpbm::presets::kAll) {
    if (name == arm.name) return arm.chain();
  }
  throw std::invalid_argument("arm: there is no " + name);
}

/// Roll, pitch and yaw about the fixed axes x, y and z, as in a URDF.
[[nodiscard]] fpbm::Transform<> transform(const std::vector<double>& xyz, const std::vector<double>& rpy) {
  using Vector = fpbm::Vector<3>;
  fpbm::Transform<> result;
  result.p = {xyz.at(0), xyz.at(1), xyz.at(2)};
  result.R = fpbm::rotation(Vector(0.0, 0.0, rpy.at(2))) * fpbm::rotation(Vector(0.0, rpy.at(1), 0.0)) *
             fpbm::rotation(Vector(rpy.at(0), 0.0, 0.0));
  return result;
}

[[nodiscard]] fpbm::Vector<Eigen::Dynamic> vector_of(const char* name, const std::vector<double>& values,
                                                     Eigen::Index dof) {
  const Eigen::Map<const Eigen::VectorXd> vector(values.data(), static_cast<Eigen::Index>(values.size()));
  if (vector.size() != dof || !vector.allFinite()) {
    throw std::invalid_argument(std::string(name) + ": must be " + std::to_string(dof) +
                                " numbers, one for each joint");
  }
  return vector;
}

/// Throws where the joints of the parameters are not those of the chain that have a drive.
void require_joints(const std::vector<std::string>& given, const fpbm::Chain<>& chain) {
  std::vector<std::string> driven;
  for (const auto& joint : chain.joints) {
    if (joint.mimic.joint < 0) driven.push_back(joint.name);
  }
  const auto [ours, theirs] = std::mismatch(given.begin(), given.end(), driven.begin(), driven.end());
  if (ours == given.end() && theirs == driven.end()) return;
  const auto text = [](auto joint, auto end) { return joint == end ? std::string("none") : "'" + *joint + "'"; };
  throw std::invalid_argument("joints: joint " + std::to_string(ours - given.begin() + 1) + " is " +
                              text(ours, given.end()) + ", and " + text(theirs, driven.end()) +
                              " in robot_description between base_frame and tip_frame: give the joints from there");
}

}  // namespace

void TargetController::read_parameters() {
  params_ = listener_->get_params();
  const auto& target = params_.target;
  const std::pair<const char*, double> numbers[] = {{"following_error", params_.following_error},
                                                    {"tip_rate", params_.tip_rate},
                                                    {"diagnostics_rate", params_.diagnostics_rate},
                                                    {"target.timeout", target.timeout}};
  for (const auto& [name, value] : numbers) {
    if (!std::isfinite(value)) throw std::invalid_argument(std::string(name) + ": must be finite");
  }
  if (params_.command_interfaces.empty() || params_.command_interfaces[0] != "position" ||
      params_.state_interfaces.empty() || params_.state_interfaces[0] != "position") {
    throw std::invalid_argument("command_interfaces, state_interfaces: the first must be position");
  }
  require_rate();

  fpbm::Chain<> chain = chain_of(get_robot_description(), params_.base_frame, params_.tip_frame);
  require_joints(params_.joints, chain);
  if (!params_.arm.empty()) require_match(chain, params_.arm, preset(params_.arm));
  chain.tip = chain.tip * transform(params_.tool.xyz, params_.tool.rpy);
  arm_.emplace(chain);

  options_.dt = 1.0 / static_cast<double>(get_update_rate());
  options_.null_damping = 0.0;  // scheme.null_damping alone decides.
  limits_.emplace(limits(*arm_), options_.dt);

  fpbm::TargetFilterOptions<> filter;
  filter.dt = options_.dt;
  filter.timeout = target.timeout;
  const fpbm::TargetBounds<> bounds{target.velocity,         target.acceleration,         target.jerk,
                                    target.angular_velocity, target.angular_acceleration, target.angular_jerk};
  filter_.emplace(fpbm::Transform<>{}, bounds, filter);
  fpbm::require_stable(scheme(Joints::Zero(arm_->dof())), fpbm::TickOfGains<>{options_.dt, options_.integral_gain});
}

/// The controller manager calls a controller in every n-th of the manager's ticks.
void TargetController::require_rate() const {
  if (is_async()) throw std::invalid_argument("is_async: must be false, since a write could see two ticks");
  const unsigned int own = get_update_rate();
  if (own > 0 && manager_rate_ % own == 0) return;
  const auto wanted = static_cast<unsigned int>(get_node()->get_parameter("update_rate").as_int());
  unsigned int below = std::min(std::max(wanted, 1U), manager_rate_);
  unsigned int above = below;
  while (below > 1 && manager_rate_ % below != 0) --below;
  while (above < manager_rate_ && manager_rate_ % above != 0) ++above;
  throw std::invalid_argument("update_rate: " + std::to_string(wanted) +
                              " Hz does not divide the controller manager's " + std::to_string(manager_rate_) +
                              " Hz: give " + std::to_string(below) + " or " + std::to_string(above));
}

TargetController::JointLimits TargetController::limits(const Arm& arm) const {
  const Eigen::Index dof = arm.dof();
  const auto& given = params_.limits;
  SourcedLimits result(arm.limits(), "robot_description");

#if __has_include(<controller_interface/controller_interface_params.hpp>)  // From ros2_control 4.38.
  JointLimits controlled = JointLimits::none(dof);
  for (Eigen::Index i = 0; i < dof; ++i) {
    const auto found = get_hard_joint_limits().find(params_.joints[static_cast<std::size_t>(i)]);
    if (found == get_hard_joint_limits().end()) continue;
    const auto& joint = found->second;
    if (joint.has_position_limits) controlled.lower(i) = joint.min_position;
    if (joint.has_position_limits) controlled.upper(i) = joint.max_position;
    if (joint.has_velocity_limits) controlled.velocity(i) = joint.max_velocity;
    if (joint.has_acceleration_limits) controlled.acceleration(i) = joint.max_acceleration;
    if (joint.has_deceleration_limits) {
      controlled.acceleration(i) = std::min(controlled.acceleration(i), joint.max_deceleration);
    }
    if (joint.has_jerk_limits) controlled.jerk(i) = joint.max_jerk;
  }
  result.narrow(controlled, "ros2_control");
#endif

  if (!params_.arm.empty()) {
    JointLimits of_preset = Arm(preset(params_.arm)).limits();
    if (!given.acceleration.empty()) of_preset.acceleration = JointLimits::unbounded(dof);
    if (!given.jerk.empty()) of_preset.jerk = JointLimits::unbounded(dof);
    result.narrow(of_preset, "preset");
  }

  JointLimits own = JointLimits::none(dof);
  const auto take = [&](const char* name, const std::vector<double>& values, Joints& bound) {
    if (!values.empty()) bound = vector_of(name, values, dof);
  };
  take("limits.lower", given.lower, own.lower);
  take("limits.upper", given.upper, own.upper);
  take("limits.velocity", given.velocity, own.velocity);
  take("limits.acceleration", given.acceleration, own.acceleration);
  take("limits.jerk", given.jerk, own.jerk);
  result.narrow(own, "limits");

  for (Eigen::Index i = 0; i < dof; ++i) {
    const std::string& joint = params_.joints[static_cast<std::size_t>(i)];
    if (!std::isfinite(result.limits().acceleration(i))) {
      throw std::invalid_argument("limits.acceleration: joint '" + joint +
                                  "' has no bound on its acceleration: give limits.acceleration, or a preset as arm");
    }
    RCLCPP_INFO(get_node()->get_logger(), "%s: %s", joint.c_str(), result.text(i).c_str());
  }
  return result.limits();
}

TargetController::Scheme TargetController::scheme(const Joints& start) const {
  const auto& given = params_.scheme;
  auto null_space = fpbm::NullSpace<kDof>().with_damping(given.null_damping);
  if (given.rest_stiffness > 0.0) {
    const Joints rest =
        given.rest_posture.empty() ? start : vector_of("scheme.rest_posture", given.rest_posture, arm_->dof());
    null_space = null_space.with_rest_posture(rest, given.rest_stiffness);
  }
  const Joints weights = given.weights.empty() ? Joints(Joints::Ones(start.size()))
                                               : vector_of("scheme.weights", given.weights, arm_->dof());
  return fpbm::FPBM<kDof>(given.alpha, weights, given.k1, given.k2, null_space);
}

}  // namespace fpbm_controllers
