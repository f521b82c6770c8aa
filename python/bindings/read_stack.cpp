#include "read.hpp"

#include <algorithm>
#include <array>
#include <optional>

namespace fpbm::bindings {
namespace {

/// The kinds of the classes of tasks in Python.
constexpr std::pair<const char*, TaskKind> kKinds[] = {
    {"position", TaskKind::kPosition},  {"orientation", TaskKind::kOrientation},
    {"pose", TaskKind::kPose},          {"axis", TaskKind::kAxis},
    {"relative_pose", TaskKind::kPose}, {"center_of_mass", TaskKind::kCenterOfMass},
    {"posture", TaskKind::kPosture}};
constexpr const char* kRows[] = {"x", "y", "z", "rx", "ry", "rz"};
/// The rows of a planar arm: x, y, rz.
constexpr AnyFrameTask::Selection kPlane = {true, true, false, false, false, true};

template <typename Value>
Value attribute(const py::handle& object, const char* name) {
  return py::cast<Value>(field(object, name));
}

Task task_of_kind(const std::string& name) {
  for (const auto& [known, kind] : kKinds) {
    if (name == known) return {kind};
  }
  validation::reject("kind", " = '" + name + "': is not a kind of task");
}

/// The coordinates of a task of a frame.
FrameCoordinates coordinates_of(TaskKind kind) {
  static_assert(static_cast<int>(TaskKind::kCenterOfMass) == static_cast<int>(FrameCoordinates::kCenterOfMass));
  return static_cast<FrameCoordinates>(kind);
}

/// A frame of a robot, at an offset.
LinkFrame<> frame_of(const Model& model, const std::string& name, const Transform<>& offset = {}) {
  const auto [link, own] = model.frame(name);
  return {link, own * offset};
}

std::vector<int> joints_of(const py::handle& given, const Model& model) {
  std::vector<int> joints;
  if (given.is_none()) {
    for (int i = 0; i < model.dof(); ++i) joints.push_back(i);
    return joints;
  }
  for (const py::handle each : given) {
    const auto name = py::cast<std::string>(each);
    const auto found = std::find(model.joint_names.begin(), model.joint_names.end(), name);
    if (found == model.joint_names.end()) {
      std::string known;
      for (const std::string& joint : model.joint_names) known += (known.empty() ? "" : ", ") + joint;
      validation::reject("joints", " has '" + name + "': must be joints of the robot: " + known);
    }
    joints.push_back(static_cast<int>(found - model.joint_names.begin()));
  }
  return joints;
}

AnyFrameTask::Selection rows_of(const py::handle& given, bool planar) {
  AnyFrameTask::Selection selected{};
  if (given.is_none()) {
    selected.fill(true);
  } else {
    for (const py::handle row : given) {
      const auto name = py::cast<std::string>(row);
      const auto which = std::find(std::begin(kRows), std::end(kRows), name);
      if (which == std::end(kRows)) validation::reject("rows", " has '" + name + "': must be x, y, z, rx, ry or rz");
      selected[static_cast<std::size_t>(which - std::begin(kRows))] = true;
    }
  }
  for (std::size_t i = 0; i < selected.size(); ++i) selected[i] = selected[i] && (!planar || kPlane[i]);
  return selected;
}

AnyFrameTask frame_task(const py::handle& given, TaskKind kind, const Model& model, const TaskGains<>& gains) {
  AnyFrameTask::Selection selected{};
  if (kind == TaskKind::kCenterOfMass) {
    return AnyFrameTask(coordinates_of(kind), LinkFrame<>(0), gains, rows_of(field(given, "rows"), model.planar),
                        false);
  }
  Vector<3> axis(0.0, 0.0, 1.0);
  bool in_frame = false;
  if (kind == TaskKind::kAxis) {
    axis = direction(ArrayLike(field(given, "axis")), "axis");
  } else {
    selected = rows_of(field(given, "rows"), model.planar);
    in_frame = attribute<std::string>(given, "axes") == "frame";
  }
  std::optional<LinkFrame<>> reference;
  if (const py::object name = field(given, "reference_frame"); !name.is_none()) {
    reference = frame_of(model, py::cast<std::string>(name));
  }
  return AnyFrameTask(coordinates_of(kind), read_frame(given, model), gains, selected, in_frame, axis, reference);
}

/// The tasks of a level in the places of an AnyStack.
struct Places {
  std::array<AnyFrameTask, 2> frames;
  AnyPostureTask posture;
  std::size_t used = 0;

  [[nodiscard]] AnyLevel level() const { return AnyLevel(frames[0], frames[1], posture); }
};

TaskGains<> gains_of(const py::handle& task, Level level) {
  return level == Level::kVelocity ? TaskGains<>(attribute<double>(task, "k"))
                                   : TaskGains<>(attribute<double>(task, "k1"), attribute<double>(task, "k2"));
}

/// Puts a task of task level k into the places of this task level, for schemes at velocity level and at acceleration
/// level.
StackTask place(const py::handle& given, std::size_t k, const Model& model, Places& velocity, Places& acceleration) {
  const auto too_many = [&](const char* what) {
    const std::string argument = "stack.levels[" + std::to_string(k) + "]";
    validation::reject(argument, std::string(" has more than ") + what + ": move a task to another level");
  };
  if (!py::isinstance<Task>(given)) reject_type(given, "stack.levels[" + std::to_string(k) + "]", "a task");
  const TaskKind kind = py::cast<const Task&>(given).kind;
  StackTask task{attribute<std::string>(given, "name"), kind, 3 * static_cast<int>(k), 0, {}};
  const auto put = [&](Places& places, Level level) {
    const TaskGains<> gains = gains_of(given, level);
    if (kind == TaskKind::kPosture) {
      places.posture = AnyPostureTask(task.joints, gains);
    } else {
      places.frames[places.used++] = frame_task(given, kind, model, gains);
    }
  };
  if (kind == TaskKind::kPosture) {
    if (velocity.posture.rows() > 0) too_many("one PostureTask");
    task.joints = joints_of(field(given, "joints"), model);
    task.index += 2;
    task.size = static_cast<int>(task.joints.size());
  } else {
    if (velocity.used == 2) too_many("two tasks of frames");
    task.index += static_cast<int>(velocity.used);
    task.size = kind == TaskKind::kPose ? 6 : 3;
  }
  put(velocity, Level::kVelocity);
  put(acceleration, Level::kAcceleration);
  return task;
}

}  // namespace

void bind_task(py::module_& m) {
  py::class_<Task>(m, "Task", "The compiled part of a task.").def(py::init(&task_of_kind), py::arg("kind"));
}

LinkFrame<> read_frame(const py::handle& task, const Model& model) {
  Transform<> offset;
  if (const py::object given = field(task, "offset"); !given.is_none()) offset = transform(ArrayLike(given), "offset");
  return frame_of(model, attribute<std::string>(task, "frame"), offset);
}

StackPlan read_stack(const py::object& stack, const Model& model) {
  require_class(stack, "tasks", "Stack", "stack", "a Stack");
  constexpr std::size_t kLevels = AnyStack::kLevels;
  const auto levels = attribute<py::tuple>(stack, "levels");
  if (levels.size() > kLevels) {
    validation::fail("number of levels", static_cast<int>(levels.size()), "at most ", static_cast<int>(kLevels));
  }
  std::vector<StackTask> tasks;
  std::vector<std::optional<StackTarget>> targets;
  std::array<Places, kLevels> velocity;
  std::array<Places, kLevels> acceleration;
  for (std::size_t k = 0; k < levels.size(); ++k) {
    for (const py::handle given : levels[k]) {
      const StackTask task = place(given, k, model, velocity[k], acceleration[k]);
      const py::object target = field(given, task.kind == TaskKind::kPosture ? "q" : "x");
      targets.push_back(target.is_none() ? std::nullopt : std::optional(read_target(task, target)));
      tasks.push_back(task);
    }
  }
  const auto whole = [](const auto& at) {
    return AnyStack(at[0].level(), at[1].level(), at[2].level(), at[3].level());
  };
  return {model.tree, tasks, targets, static_cast<int>(levels.size()), whole(velocity), whole(acceleration)};
}

StackTarget read_target(const StackTask& task, const py::handle& given) {
  const bool is_matrix = task.kind == TaskKind::kPose || task.kind == TaskKind::kOrientation;
  py::object x = py::reinterpret_borrow<py::object>(given);
  StackTarget target{{}, {}, JointVector::Zero(task.size), JointVector::Zero(task.size)};
  if (py::isinstance<py::tuple>(given)) {
    const auto parts = py::reinterpret_borrow<py::tuple>(given);
    if (!parts.empty() && parts.size() <= 3 && dimensions(ArrayLike(py::object(parts[0]))) == (is_matrix ? 2 : 1)) {
      x = parts[0];
      const auto vector = [&](std::size_t i, const char* what) -> JointVector {
        const ArrayLike values(py::object(parts[i]));
        const std::string name = task.name + "'s " + what;
        if (task.kind == TaskKind::kPosture) return joint_vector(values, name.c_str(), task.size);
        if (task.kind == TaskKind::kPose) return fixed_vector<6>(values, name.c_str());
        return fixed_vector<3>(values, name.c_str());
      };
      if (parts.size() > 1) target.xd = vector(1, "xd");
      if (parts.size() > 2) target.xdd = vector(2, "xdd");
    }
  }
  const ArrayLike point(x);
  const std::string name = task.name;
  switch (task.kind) {
    case TaskKind::kPosition:
    case TaskKind::kCenterOfMass: target.at.p = fixed_vector<3>(point, name.c_str()); break;
    case TaskKind::kOrientation:
      target.at.R = matrix(point, name.c_str(), 3, 3);
      if (!chain_check::is_rotation(target.at.R)) validation::reject(name, ": must be a rotation matrix");
      break;
    case TaskKind::kPose: target.at = transform(point, name.c_str()); break;
    case TaskKind::kAxis: {
      target.at.R = z_to(direction(point, name.c_str()));
      break;
    }
    case TaskKind::kPosture: target.q = joint_vector(point, name.c_str(), task.size); break;
  }
  return target;
}

}  // namespace fpbm::bindings
