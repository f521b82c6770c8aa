#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "fpbm_controllers/description.hpp"
#include "fpbm_controllers/target_controller.hpp"

namespace fpbm_controllers {

namespace {

/// Roll, pitch and yaw about the fixed axes x, y and z, as in a URDF.
[[nodiscard]] fpbm::Transform<> transform(const std::vector<double>& xyz, const std::vector<double>& rpy) {
  using Vector = fpbm::Vector<3>;
  fpbm::Transform<> result;
  result.p = {xyz.at(0), xyz.at(1), xyz.at(2)};
  result.R = fpbm::rotation(Vector(0.0, 0.0, rpy.at(2))) * fpbm::rotation(Vector(0.0, rpy.at(1), 0.0)) *
             fpbm::rotation(Vector(rpy.at(0), 0.0, 0.0));
  return result;
}

/// Throws if the joints of the parameters are not the driven joints of the tree.
void require_joints(const std::vector<std::string>& given, const fpbm::Tree<>& tree) {
  std::vector<std::string> driven;
  std::string list;
  for (const auto& each : tree.joints) {
    if (each.joint.mimic.joint >= 0) continue;
    driven.push_back(each.joint.name);
    list += (list.empty() ? "" : ", ") + each.joint.name;
  }
  const auto [ours, theirs] = std::mismatch(given.begin(), given.end(), driven.begin(), driven.end());
  if (ours == given.end() && theirs == driven.end()) return;
  const auto text = [](auto joint, auto end) { return joint == end ? std::string("none") : "'" + *joint + "'"; };
  throw std::invalid_argument("joints: joint " + std::to_string(ours - given.begin() + 1) + " is " +
                              text(ours, given.end()) + ", and " + text(theirs, driven.end()) +
                              " in robot_description between base_frame and the frames: give [" + list + "]");
}

/// A message of the library with the names of the parameters.
[[nodiscard]] std::string with_names_of_ros(std::string message) {
  const std::string own = "null_stiffness";
  for (auto at = message.find(own); at != std::string::npos; at = message.find(own)) {
    message.replace(at, own.size(), "rest_stiffness");
  }
  return message;
}

/// Throws, with the whole name of the parameter, if a number is not finite. The lists of joints are checked elsewhere.
void require_finite(const target_controller::Params& params) {
  const auto require = [](const std::string& name, double value) {
    if (!std::isfinite(value)) {
      throw std::invalid_argument(name + ": is " + std::to_string(value) + ": must be finite");
    }
  };
  const auto& scheme = params.scheme;
  const auto& target = params.target;
  const std::pair<const char*, double> numbers[] = {
      {"following_error", params.following_error},
      {"tip_rate", params.tip_rate},
      {"diagnostics_rate", params.diagnostics_rate},
      {"scheme.alpha", scheme.alpha},
      {"scheme.k1", scheme.k1},
      {"scheme.k2", scheme.k2},
      {"scheme.null_damping", scheme.null_damping},
      {"scheme.rest_stiffness", scheme.rest_stiffness},
      {"target.velocity", target.velocity},
      {"target.acceleration", target.acceleration},
      {"target.jerk", target.jerk},
      {"target.angular_velocity", target.angular_velocity},
      {"target.angular_acceleration", target.angular_acceleration},
      {"target.angular_jerk", target.angular_jerk},
      {"target.timeout", target.timeout},
      {"stream.delay", params.stream.delay},
      {"stream.blend", params.stream.blend},
      {"stream.keep_path", params.stream.keep_path},
      {"clearance.margin", params.clearance.margin},
      {"torque_bounds.fraction", params.torque_bounds.fraction},
      {"torque_bounds.payload.uncertainty", params.torque_bounds.payload.uncertainty}};
  for (const auto& [name, value] : numbers) require(name, value);
  for (const auto& [name, task] : params.task.tasks_map) {
    require("task." + name + ".k1", task.k1);
    require("task." + name + ".k2", task.k2);
  }
  for (const double value : params.tool.xyz) require("tool.xyz", value);
  for (const double value : params.tool.rpy) require("tool.rpy", value);
}

/// Throws unless velocities are only with positions, and all are in the order position, velocity, effort.
void require_commands(const std::vector<std::string>& given) {
  using List = std::vector<std::string>;
  const List accepted[] = {
      {"position"}, {"position", "velocity"}, {"effort"}, {"position", "effort"}, {"position", "velocity", "effort"}};
  if (std::find(std::begin(accepted), std::end(accepted), given) != std::end(accepted)) return;
  throw std::invalid_argument(
      "command_interfaces: must be [position], [position, velocity], or one of these with effort as the last, or "
      "[effort]: correct the list");
}

}  // namespace

void TargetController::read_parameters() {
  params_ = listener_->get_params();
  const auto& target = params_.target;
  require_finite(params_);
  require_commands(params_.command_interfaces);
  if (params_.state_interfaces.empty() || params_.state_interfaces[0] != "position") {
    throw std::invalid_argument("state_interfaces: does not begin with position: put position first");
  }
  require_rate();

  tasks_ = task_settings(params_);
  const fpbm::Tree<> tree = described();
  require_joints(params_.joints, tree);
  robot_.emplace(tree);
  dt_ = 1.0 / static_cast<double>(get_update_rate());
  limits_.emplace(limits(tree), dt_);

  fpbm::TrackerOptions<> options;
  options.dt = dt_;
  options.null_damping = 0.0;  // Only scheme.null_damping applies.
  // A recovery moves all joints, also joints of tasks that are at their targets, and breaks a grasp.
  options.recovery = tasks_.size() == 1;
  const bool several = std::any_of(tasks_.begin(), tasks_.end(), [](const auto& task) { return task.level > 0; });
  options.keep_first_level = params_.keep_first_level && several;
  fpbm::StreamOptions<> filter;
  filter.dt = dt_;
  filter.timeout = target.timeout;
  filter.delay = params_.stream.delay;
  filter.blend = params_.stream.blend;
  const fpbm::TargetBounds<> bounds{target.velocity,         target.acceleration,         target.jerk,
                                    target.angular_velocity, target.angular_acceleration, target.angular_jerk};
  try {
    make_bounds(tree);
    const MotionSettings settings{tree,   motion_tasks(tree), scheme(robot_->dof()),   options, *limits_, bounds,
                                  filter, bounds_.view(),     params_.stream.keep_path};
    const bool is_pose = is_tip() && robot_->dof() >= fpbm::Pose::kRows;
    motion_ = params_.input == "joints" ? make_joint_motion(settings)
              : is_pose                 ? make_tip_motion(settings)
                                        : make_stack_motion(settings);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(with_names_of_ros(error.what()));
  }
}

void TargetController::make_bounds(const fpbm::Tree<>& tree) {
  bounds_.reset();
  obstacles_.reset();
  torque_.reset();
  if (params_.clearance.margin > 0.0) {
    obstacles_.emplace(clearance_settings(tree));
    bounds_.clearance = obstacles_->clearance();
  }
  if (!params_.task_bounds.empty()) bounds_.task_bounds = task_bounds(tree);
  const bool bounds_torques = params_.torque_bounds.fraction > 0.0;
  const bool commands_torques = params_.command_interfaces.back() == "effort";
  if (!bounds_torques && !commands_torques) return;
  fpbm::Tree<> with_inertias = tree;
  add_inertias(with_inertias, get_robot_description(), params_.base_frame);
  if (bounds_torques) bounds_.torque_bounds = torque_bounds(with_inertias);
  if (commands_torques) torque_.emplace(computed_torque(with_inertias));
}

TargetController::Joints TargetController::joint_numbers(const char* name, const std::vector<double>& values) const {
  if (values.size() != params_.joints.size()) {
    throw std::invalid_argument(std::string(name) + ": has " + std::to_string(values.size()) + " entries: must have " +
                                std::to_string(params_.joints.size()) + ", one for each joint");
  }
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (std::isfinite(values[k])) continue;
    throw std::invalid_argument(std::string(name) + ": is " + std::to_string(values[k]) + " for joint '" +
                                params_.joints[k] + "': must be finite");
  }
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

fpbm::Tree<> TargetController::described() const {
  std::vector<NamedLink> links;
  for (const auto& task : tasks_) {
    links.push_back({task.frame_parameter(), task.frame});
    if (!task.reference.empty()) links.push_back({task.parameter("reference_frame"), task.reference});
  }
  fpbm::Tree<> tree = tree_of(get_robot_description(), params_.base_frame, links);
  if (params_.tasks.empty()) {
    fpbm::Transform<>& tip = tree.frames[0].offset;
    tip = tip * transform(params_.tool.xyz, params_.tool.rpy);
  }
  return tree;
}

std::vector<MotionTask> TargetController::motion_tasks(const fpbm::Tree<>& tree) const {
  std::vector<MotionTask> tasks;
  std::array<int, Report::kTasks> rows{};  // Rows of each level.
  auto frame = tree.frames.begin();
  for (const auto& task : tasks_) {
    const auto take = [&frame] {
      const auto& [name, link, offset] = *frame++;
      return fpbm::LinkFrame<>(link, offset);
    };
    const auto target = static_cast<std::size_t>(&task - tasks_.data());
    MotionTask made{task.name.empty() ? "scheme." : task.parameter(""),
                    task.level,
                    {task.k1, task.k2},
                    take(),
                    std::nullopt,
                    target};
    if (!task.reference.empty()) made.reference = take();
    const int other = made.reference ? made.reference->link() : 0;
    if (made.frame.link() == other) {
      const std::string to = task.reference.empty() ? params_.base_frame : task.reference;
      throw std::invalid_argument(task.frame_parameter() + ": no joint moves link '" + task.frame +
                                  "' relative to link '" + to + "': give two links with a joint between them");
    }
    if (is_tip() && robot_->dof() < fpbm::Pose::kRows) {  // Too few joints for a pose: the position has priority.
      made.coordinates = fpbm::FrameCoordinates::kPosition;
      tasks.push_back(made);
      made.coordinates = fpbm::FrameCoordinates::kAxis;
      made.level = 1;
      tasks.push_back(made);
      return tasks;
    }
    int& count = rows[static_cast<std::size_t>(task.level)];
    count += fpbm::Pose::kRows;
    if (count > robot_->dof()) {
      throw std::invalid_argument((task.name.empty() ? "tip_frame" : task.parameter("level")) +
                                  ": the poses of level " + std::to_string(task.level + 1) + " have " +
                                  std::to_string(count) + " rows, and the robot has " + std::to_string(robot_->dof()) +
                                  " joints: put the task on another level");
    }
    tasks.push_back(made);
  }
  return tasks;
}

MotionScheme TargetController::scheme(Eigen::Index dof) const {
  const auto& given = params_.scheme;
  MotionScheme scheme{given.alpha, Joints::Ones(dof), given.null_damping, given.rest_stiffness, std::nullopt};
  if (!given.weights.empty()) scheme.weights = joint_numbers("scheme.weights", given.weights);
  if (!given.rest_posture.empty()) scheme.rest_posture = joint_numbers("scheme.rest_posture", given.rest_posture);
  return scheme;
}

/// The controller manager calls a controller in every n-th tick of the manager, and replaces other rates, without an
/// error, by a rate near the given rate or by the rate of the manager. For the limits, the given rate must be the rate.
void TargetController::require_rate() const {
  if (is_async())
    throw std::invalid_argument("is_async: must be false, since a write could mix the commands of two ticks");
  const auto manager = static_cast<std::int64_t>(manager_rate_);
  const std::int64_t rate = get_node()->get_parameter("update_rate").as_int();
  const bool in_range = 0 < rate && rate <= manager;
  if (in_range && manager % rate == 0) return;
  std::int64_t below = in_range ? rate : manager;
  std::int64_t above = below;
  while (manager % below != 0) --below;
  while (manager % above != 0) ++above;
  throw std::invalid_argument("update_rate: is " + std::to_string(rate) + " Hz: must divide the controller manager's " +
                              std::to_string(manager) + " Hz: give " +
                              (below == above ? "" : std::to_string(below) + " or ") + std::to_string(above));
}

}  // namespace fpbm_controllers
