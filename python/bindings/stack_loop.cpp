#include "stack_loop.hpp"

#include <algorithm>
#include <type_traits>

namespace fpbm::bindings {
namespace {

/// f(space, i, row) for task number `index` of AnyStack, as AnyStack::Space::each() calls it. f must not throw.
template <typename F>
void at_task(int index, F&& f) noexcept {
  AnyStack::Space::each([&](auto space, auto i, int row) noexcept {
    if (static_cast<int>(decltype(i)::value) == index) f(space, i, row);
  });
}

template <typename Value>
Value attribute(const py::handle& object, const char* name) {
  return py::cast<Value>(object.attr(name));
}

/// The link of a frame: 'tip', 'base', or the link that a joint moves.
int link_of(const std::string& frame, const Arm& arm) {
  if (frame == "tip") return Robot<kDynamic>::kTip;
  if (frame == "base") return 0;
  std::string known;
  for (std::size_t i = 0; i < arm.joint_names.size(); ++i) {
    if (arm.joint_names[i] == frame) return static_cast<int>(i) + 1;
    known += ", '" + arm.joint_names[i] + "'";
  }
  validation::reject("frame", " = '" + frame + "': must be 'tip', 'base', or the joint of a link" + known);
}

std::vector<int> joints_of(const py::handle& given, const Arm& arm) {
  std::vector<int> joints;
  if (given.is_none()) {
    for (int i = 0; i < arm.dof(); ++i) joints.push_back(i);
    return joints;
  }
  for (const py::handle each : given) {
    const auto name = py::cast<std::string>(each);
    const auto found = std::find(arm.joint_names.begin(), arm.joint_names.end(), name);
    if (found == arm.joint_names.end()) validation::reject("joints", ": the arm has no joint '" + name + "'");
    joints.push_back(static_cast<int>(found - arm.joint_names.begin()));
  }
  return joints;
}

/// First row of a task in those of its place in an AnyStack: angles alone come after lengths.
template <typename Kind>
int shift_of(Kind kind) noexcept {
  return kind == Kind::kOrientation || kind == Kind::kAxis ? 3 : 0;
}

constexpr const char* kKinds[] = {"position", "orientation", "pose", "axis", "posture"};

}  // namespace

StackLoop::StackLoop(const py::object& stack, const Scheme& scheme, const Arm& arm, const State<kDynamic>& start,
                     const TrackerOptions<>& options, const JointLimits<kDynamic>& limits, const JointVector& qdd0,
                     const Clearance<kDynamic>& clearance)
    : dt_(options.dt),
      tracker_(make_stack_tracker(scheme,
                                  {arm.chain(), build(stack, scheme, arm), start, options, limits, qdd0, clearance})),
      held_(Reference<Space>::hold(tracker_->tip())) {
  std::size_t i = 0;
  for (const py::handle level : stack.attr("levels")) {
    for (const py::handle given : level) {
      const Task& task = tasks_[i++];
      if (task.kind != Kind::kPosture || given.attr("q").is_none()) continue;
      put(task, target_of(task, given.attr("q")), held_);
    }
  }
}

AnyStack StackLoop::build(const py::object& stack, const Scheme& scheme, const Arm& arm) {
  if (!py::hasattr(stack, "levels")) validation::reject("stack", ": must be a Stack");
  constexpr std::size_t kLevels = AnyStack::kLevels;
  const auto levels = attribute<py::tuple>(stack, "levels");
  if (levels.size() > kLevels) {
    validation::fail("number of levels", static_cast<int>(levels.size()), "at most ", static_cast<int>(kLevels));
  }
  levels_ = static_cast<int>(levels.size());
  std::array<std::array<AnyFrameTask, 2>, kLevels> frames;
  std::array<AnyPostureTask, kLevels> postures;
  for (std::size_t k = 0; k < levels.size(); ++k) {
    std::size_t frame = 0;
    for (const py::handle given : levels[k]) {
      const auto kind_name = attribute<std::string>(given, "kind");
      const auto kind =
          static_cast<Kind>(std::find(std::begin(kKinds), std::end(kKinds), kind_name) - std::begin(kKinds));
      const TaskGains<> gains = scheme.level == Level::kVelocity
                                    ? TaskGains<>(attribute<double>(given, "k"))
                                    : TaskGains<>(attribute<double>(given, "k1"), attribute<double>(given, "k2"));
      Task task{attribute<std::string>(given, "name"), kind, 3 * static_cast<int>(k), 0, {}};
      const auto too_many = [&](const char* what) {
        const std::string argument = "stack.levels[" + std::to_string(k) + "]";
        validation::reject(argument, std::string(" has more than ") + what + ": move a task to another level");
      };
      if (kind == Kind::kPosture) {
        if (postures[k].rows() > 0) too_many("one PostureTask");
        task.joints = joints_of(given.attr("joints"), arm);
        postures[k] = AnyPostureTask(task.joints, gains);
        task.index += 2;
        task.size = static_cast<int>(task.joints.size());
      } else {
        if (frame == 2) too_many("two tasks of frames");
        Transform<> offset;
        if (!given.attr("offset").is_none()) offset = transform(ArrayLike(py::object(given.attr("offset"))), "offset");
        AnyFrameTask::Selection selected{};
        Vector<3> axis(0.0, 0.0, 1.0);
        bool in_frame = false;
        if (kind == Kind::kAxis) {
          axis = fixed_vector<3>(ArrayLike(py::object(given.attr("axis"))), "axis");
        } else {
          constexpr const char* kRows[] = {"x", "y", "z", "rx", "ry", "rz"};
          selected.fill(given.attr("rows").is_none());
          for (const py::handle row :
               given.attr("rows").is_none() ? py::tuple() : attribute<py::tuple>(given, "rows")) {
            const auto which = std::find(std::begin(kRows), std::end(kRows), py::cast<std::string>(row));
            selected[static_cast<std::size_t>(which - std::begin(kRows))] = true;
          }
          in_frame = attribute<std::string>(given, "axes") == "frame";
        }
        const LinkFrame<> link(link_of(attribute<std::string>(given, "frame"), arm), offset);
        frames[k][frame] = AnyFrameTask(static_cast<FrameCoordinates>(kind), link, gains, selected, in_frame, axis);
        task.index += static_cast<int>(frame++);
        task.size = kind == Kind::kPose ? 6 : 3;
      }
      tasks_.push_back(task);
    }
  }
  const auto level = [&](std::size_t k) { return AnyLevel(frames[k][0], frames[k][1], postures[k]); };
  return AnyStack(level(0), level(1), level(2), level(3));
}

const StackLoop::Task& StackLoop::task_named(const std::string& name) const {
  std::string known;
  for (const Task& task : tasks_) {
    if (task.name == name) return task;
    known += (known.empty() ? "'" : ", '") + task.name + "'";
  }
  validation::reject("task", " = '" + name + "': must be one of the stack's, " + known);
}

StackLoop::Target StackLoop::target_of(const Task& task, const py::handle& given) const {
  // (x, xd, xdd) in a tuple, or x.
  const bool is_matrix = task.kind == Kind::kPose || task.kind == Kind::kOrientation;
  py::object x = py::reinterpret_borrow<py::object>(given);
  Target target{{}, {}, JointVector::Zero(task.size), JointVector::Zero(task.size)};
  if (py::isinstance<py::tuple>(given)) {
    const auto parts = py::reinterpret_borrow<py::tuple>(given);
    if (!parts.empty() && parts.size() <= 3 && dimensions(ArrayLike(py::object(parts[0]))) == (is_matrix ? 2 : 1)) {
      x = parts[0];
      const auto vector = [&](std::size_t i, const char* name) {
        return joint_vector(ArrayLike(py::object(parts[i])), (task.name + "'s " + name).c_str(), task.size);
      };
      if (parts.size() > 1) target.xd = vector(1, "xd");
      if (parts.size() > 2) target.xdd = vector(2, "xdd");
    }
  }
  const ArrayLike point(x);
  const std::string name = task.name;
  switch (task.kind) {
    case Kind::kPosition: target.at.p = fixed_vector<3>(point, name.c_str()); break;
    case Kind::kOrientation:
      target.at.R = matrix(point, name.c_str(), 3, 3);
      if (!chain_check::is_rotation(target.at.R)) validation::reject(name, ": must be a rotation matrix");
      break;
    case Kind::kPose: target.at = transform(point, name.c_str()); break;
    case Kind::kAxis: {
      const Vector<3> d = fixed_vector<3>(point, name.c_str());
      if (!(norm(d) > 0.0)) validation::reject(name, " is zero: must point somewhere");
      target.at.R = z_to(d);
      break;
    }
    case Kind::kPosture: target.q = joint_vector(point, name.c_str(), task.size); break;
  }
  return target;
}

std::optional<StackLoop::Source> StackLoop::source_of(const Task& task, const py::handle& given) const {
  const auto same = [&](auto& any, const char* argument) -> Source {
    if (task.kind == Kind::kPosition) {
      if (auto* found = std::get_if<2>(&any)) return found;
    } else if (task.kind == Kind::kPose) {
      if (auto* found = std::get_if<3>(&any)) return found;
    }
    validation::reject(argument, ": it is for another task than '" + task.name + "'");
  };
  if (py::isinstance<PyFollower>(given)) return same(py::cast<PyFollower&>(given).any, "follower");
  if (py::isinstance<PyTargetFilter>(given)) {
    const Source source = same(py::cast<PyTargetFilter&>(given).any, "filter");
    std::visit(
        [&](auto* each) {
          if constexpr (!std::is_same_v<decltype(each), AnyFollower<Position<3>>*> &&
                        !std::is_same_v<decltype(each), AnyFollower<Pose>*>) {
            if (each->dt() != dt_) validation::fail("filter's dt", each->dt(), "the tracker's");
          }
        },
        source);
    return source;
  }
  return std::nullopt;
}

void StackLoop::put(const Task& task, const Target& target, Reference<Space>& to) const noexcept {
  at_task(task.index, [&](auto space, auto i, int row) noexcept {
    if constexpr (std::is_same_v<decltype(space), FrameSpace>) {
      std::get<decltype(i)::value>(to.x).at = target.at;
    } else {
      for (int j = 0; j < task.size; ++j) std::get<decltype(i)::value>(to.x)(j) = target.q(j);
    }
    for (int j = 0; j < task.size; ++j) {
      to.xd(row + shift_of(task.kind) + j) = target.xd(j);
      to.xdd(row + shift_of(task.kind) + j) = target.xdd(j);
    }
  });
}

void StackLoop::put(const Task& task, const Source& source, double seconds, Reference<Space>& to) const noexcept {
  Target target;
  std::visit(
      [&](const auto* each) noexcept {
        const auto reference = each->ahead(seconds);
        if constexpr (std::is_same_v<std::decay_t<decltype(reference)>, Reference<Pose>>) {
          target.at = reference.x;
        } else {
          target.at.p = reference.x;
        }
        target.xd = reference.xd;
        target.xdd = reference.xdd;
      },
      source);
  put(task, target, to);
}

std::vector<std::pair<const StackLoop::Task*, StackLoop::Source>> StackLoop::read(const PyReferences& references) {
  std::vector<std::pair<const Task*, Source>> sources;
  std::vector<std::pair<const Task*, Target>> targets;
  for (const auto& [key, given] : references) {
    const Task& task = task_named(py::cast<std::string>(key));
    if (const auto source = source_of(task, given)) {
      sources.emplace_back(&task, *source);
    } else {
      targets.emplace_back(&task, target_of(task, given));
    }
  }
  held_ = Reference<Space>::hold(held_.x);
  for (const auto& [task, target] : targets) put(*task, target, held_);
  return sources;
}

StackLoop::Result StackLoop::tick(const PyReferences& references) {
  const auto sources = read(references);
  TickReferences<Space> stages = TickReferences<Space>::of([&](double t) noexcept { return ahead(held_, t); }, dt_);
  for (std::size_t i = 0; i < stages.stages.size(); ++i) {
    for (const auto& [task, source] : sources) put(*task, source, dt_ / 2 * static_cast<double>(i), stages.stages[i]);
  }
  const Result result = tracker_->advance(stages);
  for (const auto& [task, source] : sources) {
    put(*task, source, dt_, held_);
    std::visit([&](auto* each) { advance_source(*each, dt_, stopping_); }, source);
  }
  return result;
}

StackLoop::Result StackLoop::resolve_measured(const State<kDynamic>& measured, const PyReferences& references) {
  for (const auto& [task, source] : read(references)) put(*task, source, 0.0, held_);
  return tracker_->resolve_measured(measured, held_);
}

PyFollower StackLoop::follow(const Path& path, double ramp, const std::optional<std::string>& name) const {
  const Task* task = name ? &task_named(*name) : nullptr;
  if (task == nullptr) {
    for (const Task& each : tasks_) {
      if (each.kind != Kind::kPosition && each.kind != Kind::kPose) continue;
      if (task != nullptr) validation::reject("task", ": several tasks follow paths, must be the name of one");
      task = &each;
    }
    if (task == nullptr) validation::reject("task", ": no task of the stack is a position or a pose");
  }
  if (task->kind != Kind::kPosition && task->kind != Kind::kPose) {
    validation::reject("task", " = '" + task->name + "': must be a position or a pose to follow a path");
  }
  const Transform<> at = frame_of(*task);
  if (task->kind == Kind::kPose) return {AnyFollower<Pose>(path.as<Pose>(), at, ramp)};
  return {AnyFollower<Position<3>>(path.as<Position<3>>(), at.p, ramp)};
}

void StackLoop::enable(int level, bool on) {
  if (level < 1 || level >= levels_) {
    validation::fail("level", level, "that of a level below the first, at most ", levels_ - 1);
  }
  tracker_->enable(level, on);
}

void StackLoop::stop() noexcept {
  stopping_ = true;
  tracker_->stop();
}
void StackLoop::resume() noexcept {
  stopping_ = false;
  tracker_->resume();
}

PyPoints StackLoop::points() const {
  PyPoints points;
  const StackTracker::Point tip = tracker_->tip();
  for (const Task& task : tasks_) {
    Transform<> at;
    JointVector q(task.size);
    at_task(task.index, [&](auto space, auto i, int) noexcept {
      if constexpr (std::is_same_v<decltype(space), FrameSpace>) {
        at = std::get<decltype(i)::value>(tip).at;
      } else {
        for (int j = 0; j < task.size; ++j) q(j) = std::get<decltype(i)::value>(tip)(j);
      }
    });
    const py::str name(task.name);
    if (task.kind == Kind::kPosition) points[name] = array_of(at.p);
    if (task.kind == Kind::kOrientation) points[name] = array_of(at.R);
    if (task.kind == Kind::kPose) points[name] = array_of(at);
    if (task.kind == Kind::kAxis) points[name] = array_of(column(at.R, 2));
    if (task.kind == Kind::kPosture) points[name] = array_of(q);
  }
  return points;
}

Array StackLoop::frame(const std::string& name) const {
  const Task& task = task_named(name);
  if (task.kind == Kind::kPosture) validation::reject("task", " = '" + name + "': a posture has no frame");
  return array_of(frame_of(task));
}

Transform<> StackLoop::frame_of(const Task& task) const noexcept {
  const StackTracker::Point tip = tracker_->tip();
  Transform<> at;
  at_task(task.index, [&](auto space, auto i, int) noexcept {
    if constexpr (std::is_same_v<decltype(space), FrameSpace>) at = std::get<decltype(i)::value>(tip).at;
  });
  return at;
}

Array StackLoop::scales(const Result& tick) const {
  return array_of(Eigen::Map<const Eigen::VectorXd>(tick.scales.data(), levels_));
}

PyPoints StackLoop::errors(const Result& tick) const {
  PyPoints errors;
  for (const Task& task : tasks_) {
    JointVector part(task.size);
    at_task(task.index, [&](auto, auto, int row) noexcept {
      for (int j = 0; j < task.size; ++j) part(j) = tick.error(row + shift_of(task.kind) + j);
    });
    errors[py::str(task.name)] = array_of(part);
  }
  return errors;
}

Array StackLoop::error(const Result& tick) const {
  std::vector<double> all;
  for (const Task& task : tasks_) {
    at_task(task.index, [&](auto, auto, int row) noexcept {
      for (int j = 0; j < task.size; ++j) all.push_back(tick.error(row + shift_of(task.kind) + j));
    });
  }
  return array_of(Eigen::Map<const Eigen::VectorXd>(all.data(), static_cast<Eigen::Index>(all.size())));
}

}  // namespace fpbm::bindings
