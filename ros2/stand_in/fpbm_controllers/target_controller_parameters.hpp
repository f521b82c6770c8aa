#pragma once

#include <controller_interface/controller_interface.hpp>
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

// Stands in for the header that generate_parameter_library generates from target_controller_parameters.yaml. The test
// sets the values as a parameter file does, or overrides some values, possibly with other types.
namespace target_controller {

struct Params {
  std::vector<std::string> joints;
  std::string arm;
  std::string base_frame;
  std::string tip_frame;
  std::string input = "poses";
  std::vector<std::string> tasks = {};
  struct Task {
    struct MapTasks {
      std::string frame;
      std::string reference_frame;
      std::int64_t level = 1;
      double k1 = 0.0;
      double k2 = 0.0;
    };
    std::map<std::string, MapTasks> tasks_map;
  } task;
  bool keep_first_level = true;
  struct Tool {
    std::vector<double> xyz = {0.0, 0.0, 0.0};
    std::vector<double> rpy = {0.0, 0.0, 0.0};
  } tool;
  struct Limits {
    std::vector<double> lower = {};
    std::vector<double> upper = {};
    std::vector<double> velocity = {};
    std::vector<double> acceleration = {};
    std::vector<double> jerk = {};
    std::vector<double> effort = {};
  } limits;
  std::vector<std::string> command_interfaces = {"position"};
  std::vector<std::string> state_interfaces = {"position"};
  struct Effort {
    std::vector<double> kp = {};
    std::vector<double> kd = {};
    std::vector<double> gravity = {0.0, 0.0, -9.81};
    bool robot_adds_gravity = false;
    struct Payload {
      double mass = 0.0;
      std::vector<double> centre = {0.0, 0.0, 0.0};
    } payload;
  } effort;
  struct TorqueBounds {
    double fraction = 0.0;
    struct Payload {
      double uncertainty = 0.0;
    } payload;
  } torque_bounds;
  struct Clearance {
    double margin = 0.0;
    std::vector<std::string> links = {};
    std::vector<double> capsules = {};
    std::vector<std::string> allowed = {};
    std::int64_t obstacles = 16;
  } clearance;
  std::vector<std::string> task_bounds = {};
  struct TaskBound {
    struct MapTaskBounds {
      std::string frame;
      std::vector<double> lower = {};
      std::vector<double> upper = {};
    };
    std::map<std::string, MapTaskBounds> task_bounds_map;
  } task_bound;
  double following_error = 0.05;
  double tip_rate = 50.0;
  double diagnostics_rate = 1.0;
  struct Scheme {
    double alpha = 0.6;
    std::vector<double> weights = {};
    double k1 = 20.0;
    double k2 = 100.0;
    double null_damping = 4.0;
    double rest_stiffness = 4.0;
    std::vector<double> rest_posture = {};
  } scheme;
  struct Target {
    double velocity = 0.5;
    double acceleration = 1.5;
    double jerk = 30.0;
    double angular_velocity = 1.0;
    double angular_acceleration = 3.0;
    double angular_jerk = 60.0;
    double timeout = 0.2;
  } target;
  struct Stream {
    double delay = 0.0;
    double blend = 0.0;
    double keep_path = 0.0;
  } stream;
};

}  // namespace target_controller

namespace stand_in {

inline target_controller::Params parameters;

/// Calls visit(name, value, is_valid) for every parameter, where is_valid is the validator of values. As in
/// generate_parameter_library, NaN passes all validators except gt and gt_eq.
template <typename Visit>
void for_each_parameter(target_controller::Params& p, Visit&& visit) {
  using Numbers = std::vector<double>;
  const auto any = [](const auto&) { return true; };
  const auto not_empty = [](const auto& value) { return !value.empty(); };
  const auto unique = [](const auto& values) {
    return std::set<std::string>(values.begin(), values.end()).size() == values.size();
  };
  const auto three = [](const Numbers& value) { return value.size() == 3; };
  const auto above_zero = [](double value) { return value > 0.0; };
  const auto not_negative = [](double value) { return value >= 0.0; };
  const auto within = [](double low, double high) { return [=](double v) { return !(v < low || v > high); }; };
  const auto at_least = [](double low) {
    return [=](const Numbers& values) {
      for (const double value : values) {
        if (value < low) return false;
      }
      return true;
    };
  };
  const auto no_small = at_least(1e-6);
  const auto no_negative = at_least(0.0);
  visit("joints", p.joints, not_empty);
  visit("arm", p.arm, any);
  visit("base_frame", p.base_frame, not_empty);
  visit("tip_frame", p.tip_frame, any);
  visit("input", p.input, [](const std::string& value) { return value == "poses" || value == "joints"; });
  visit("tasks", p.tasks, unique);
  for (const std::string& name : p.tasks) {
    auto& task = p.task.tasks_map[name];
    visit("task." + name + ".frame", task.frame, any);
    visit("task." + name + ".reference_frame", task.reference_frame, any);
    visit("task." + name + ".level", task.level, any);
    visit("task." + name + ".k1", task.k1, not_negative);
    visit("task." + name + ".k2", task.k2, not_negative);
  }
  visit("keep_first_level", p.keep_first_level, any);
  visit("tool.xyz", p.tool.xyz, three);
  visit("tool.rpy", p.tool.rpy, three);
  visit("limits.lower", p.limits.lower, any);
  visit("limits.upper", p.limits.upper, any);
  visit("limits.velocity", p.limits.velocity, no_small);
  visit("limits.acceleration", p.limits.acceleration, no_small);
  visit("limits.jerk", p.limits.jerk, no_small);
  visit("limits.effort", p.limits.effort, no_small);
  visit("command_interfaces", p.command_interfaces, not_empty);
  visit("state_interfaces", p.state_interfaces, not_empty);
  visit("effort.kp", p.effort.kp, no_negative);
  visit("effort.kd", p.effort.kd, no_negative);
  visit("effort.gravity", p.effort.gravity, three);
  visit("effort.robot_adds_gravity", p.effort.robot_adds_gravity, any);
  visit("effort.payload.mass", p.effort.payload.mass, not_negative);
  visit("effort.payload.centre", p.effort.payload.centre, three);
  visit("torque_bounds.fraction", p.torque_bounds.fraction, within(0.0, 1.0));
  visit("torque_bounds.payload.uncertainty", p.torque_bounds.payload.uncertainty, not_negative);
  visit("clearance.margin", p.clearance.margin, not_negative);
  visit("clearance.links", p.clearance.links, any);
  visit("clearance.capsules", p.clearance.capsules, any);
  visit("clearance.allowed", p.clearance.allowed, any);
  visit("clearance.obstacles", p.clearance.obstacles, [](std::int64_t value) { return 0 <= value && value <= 1000; });
  visit("task_bounds", p.task_bounds, unique);
  for (const std::string& name : p.task_bounds) {
    auto& bound = p.task_bound.task_bounds_map[name];
    visit("task_bound." + name + ".frame", bound.frame, any);
    visit("task_bound." + name + ".lower", bound.lower, any);
    visit("task_bound." + name + ".upper", bound.upper, any);
  }
  visit("following_error", p.following_error, above_zero);
  visit("tip_rate", p.tip_rate, within(0.1, 1000.0));
  visit("diagnostics_rate", p.diagnostics_rate, within(0.1, 100.0));
  visit("scheme.alpha", p.scheme.alpha, within(0.0, 1.0));
  visit("scheme.weights", p.scheme.weights, no_small);
  visit("scheme.k1", p.scheme.k1, not_negative);
  visit("scheme.k2", p.scheme.k2, not_negative);
  visit("scheme.null_damping", p.scheme.null_damping, not_negative);
  visit("scheme.rest_stiffness", p.scheme.rest_stiffness, not_negative);
  visit("scheme.rest_posture", p.scheme.rest_posture, any);
  visit("target.velocity", p.target.velocity, above_zero);
  visit("target.acceleration", p.target.acceleration, above_zero);
  visit("target.jerk", p.target.jerk, above_zero);
  visit("target.angular_velocity", p.target.angular_velocity, above_zero);
  visit("target.angular_acceleration", p.target.angular_acceleration, above_zero);
  visit("target.angular_jerk", p.target.angular_jerk, above_zero);
  visit("target.timeout", p.target.timeout, above_zero);
  visit("stream.delay", p.stream.delay, not_negative);
  visit("stream.blend", p.stream.blend, not_negative);
  visit("stream.keep_path", p.stream.keep_path, not_negative);
}

}  // namespace stand_in

namespace target_controller {

class ParamListener {
 public:
  template <typename Node>
  explicit ParamListener(const std::shared_ptr<Node>& node, const std::string& = "") : params_(stand_in::parameters) {
    const auto declared = node->get_node_parameters_interface();
    stand_in::for_each_parameter(params_, [&](const std::string& name, auto& value, auto&& valid) {
      if (!declared->has_parameter(name)) (void)declared->declare_parameter(name, rclcpp::ParameterValue(value));
      value = declared->declared.at(name).template get<std::decay_t<decltype(value)>>();
      if (!valid(value))
        throw rclcpp::exceptions::InvalidParameterValueException("parameter '" + name + "' is invalid");
    });
  }
  [[nodiscard]] Params get_params() const { return params_; }

 private:
  Params params_;
};

}  // namespace target_controller
