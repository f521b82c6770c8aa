#include <algorithm>
#include <cmath>
#include <hardware_interface/component_parser.hpp>
#include <stdexcept>

#include "fpbm_controllers/description.hpp"
#include "fpbm_controllers/target_controller.hpp"

namespace fpbm_controllers {

TargetController::JointLimits TargetController::preset_limits(const fpbm::Tree<>& tree) const {
  const fpbm::Chain<> known = preset_chain(params_.arm);
  JointLimits limits = JointLimits::none(robot_->dof());
  for (const auto& [name, link, offset] : tree.frames) {
    if (!is_end(tree, link)) continue;
    require_match(chain_to(tree, link), name, params_.arm, known);
    const std::vector<std::size_t> joints = joints_to(tree, link);
    for (std::size_t k = 0; k < joints.size(); ++k) {
      limits.set(static_cast<Eigen::Index>(joints[k]), known.joints[k].bounds);  // Each joint of the arm has a drive.
    }
  }
  if (!params_.limits.acceleration.empty()) limits.acceleration = JointLimits::unbounded(robot_->dof());
  if (!params_.limits.jerk.empty()) limits.jerk = JointLimits::unbounded(robot_->dof());
  return limits;
}

/// The tags are read from robot_description, because the controller manager gives the limits of the tags only if the
/// manager enforces limits.
void TargetController::narrow_by_tags(SourcedLimits& limits) const {
  JointLimits hard = JointLimits::none(robot_->dof());
  for (const auto& hardware : hardware_interface::parse_control_resources_from_urdf(get_robot_description())) {
    for (Eigen::Index i = 0; i < robot_->dof(); ++i) {
      const auto found = hardware.limits.find(params_.joints[static_cast<std::size_t>(i)]);
      if (found == hardware.limits.end()) continue;
      const auto& joint = found->second;
      const auto take = [](bool given, double value, double& bound) {
        if (given && value > 0.0) bound = std::min(bound, value);  // 0: not given in the URDF.
      };
      if (joint.has_position_limits) hard.lower(i) = std::max(hard.lower(i), joint.min_position);
      if (joint.has_position_limits) hard.upper(i) = std::min(hard.upper(i), joint.max_position);
      take(joint.has_velocity_limits, joint.max_velocity, hard.velocity(i));
      take(joint.has_acceleration_limits, joint.max_acceleration, hard.acceleration(i));
      take(joint.has_deceleration_limits, joint.max_deceleration, hard.acceleration(i));
      take(joint.has_jerk_limits, joint.max_jerk, hard.jerk(i));
      take(joint.has_effort_limits, joint.max_effort, hard.effort(i));
    }
  }
  limits.narrow(hard, "ros2_control");
}

/// If the controller manager enforces soft limits, the manager changes positions whose velocity v toward a soft limit
/// at the distance d exceeds k d. The braking envelope −a/2k + √(2 a d) is at most k d, with equality at d = a/2k².
void TargetController::narrow_softly(SourcedLimits& limits) const {
  JointLimits soft = JointLimits::none(robot_->dof());
  for (const auto& hardware : hardware_interface::parse_control_resources_from_urdf(get_robot_description())) {
    for (Eigen::Index i = 0; i < robot_->dof(); ++i) {
      const auto found = hardware.soft_limits.find(params_.joints[static_cast<std::size_t>(i)]);
      if (found == hardware.soft_limits.end()) continue;
      const auto& joint = found->second;
      if (!(joint.min_position < joint.max_position)) continue;  // Both are 0 if they are not given in the URDF.
      soft.lower(i) = joint.min_position;
      soft.upper(i) = joint.max_position;
      if (!(joint.k_position > 0.0)) continue;
      const JointLimits& others = limits.limits();
      soft.deceleration(i) = std::min(others.deceleration(i), others.acceleration(i));
      soft.velocity_offset(i) = std::max(others.velocity_offset(i), soft.deceleration(i) / (2.0 * joint.k_position));
    }
  }
  limits.narrow(soft, "safety_controller");
}

TargetController::JointLimits TargetController::limits(const fpbm::Tree<>& tree) const {
  const Eigen::Index dof = robot_->dof();
  const auto& given = params_.limits;
  SourcedLimits result(robot_->limits(), "robot_description");
  narrow_by_tags(result);

  if (!params_.arm.empty()) result.narrow(preset_limits(tree), "preset");

  JointLimits own = JointLimits::none(dof);
  const auto take = [&](const char* name, const std::vector<double>& values, Joints& bound) {
    if (!values.empty()) bound = joint_numbers(name, values);
  };
  take("limits.lower", given.lower, own.lower);
  take("limits.upper", given.upper, own.upper);
  take("limits.velocity", given.velocity, own.velocity);
  take("limits.acceleration", given.acceleration, own.acceleration);
  take("limits.jerk", given.jerk, own.jerk);
  take("limits.effort", given.effort, own.effort);
  result.narrow(own, "limits");
  narrow_softly(result);

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

}  // namespace fpbm_controllers
