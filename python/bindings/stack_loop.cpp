#include "stack_loop.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "motion.hpp"
#include "read.hpp"

namespace fpbm::bindings {

PyFollower::Any& PyFollower::of(const std::string& task) {
  if (each.size() == 1) return each.front().second;
  for (auto& [name, follower] : each) {
    if (name == task) return follower;
  }
  validation::reject("follower", ": follows no path of the task '" + task + "'");
}

StackLoop::StackLoop(const StackPlan& plan, const Scheme& scheme, const TrackerStart& from)
    : dt_(from.options.dt),
      tracker_(make_tracker<AnyStack::Space>(plan.arm_at(scheme.level), scheme, from)),
      references_(plan, tracker_->tip()) {
  auto parts = std::make_shared<Parts>();
  for (const StackTask& task : plan.tasks) parts->emplace_back(task.name, task.size);
  parts_ = std::move(parts);
}

std::optional<StackReferences::Source> StackLoop::source_of(const StackTask& task, const py::handle& given) const {
  using Source = StackReferences::Source;
  const auto same = [&](auto& any, const char* argument) -> Source {
    if (task.kind == TaskKind::kPosition) {
      if (auto* found = std::get_if<2>(&any)) return found;
    } else if (task.kind == TaskKind::kPose) {
      if (auto* found = std::get_if<3>(&any)) return found;
    }
    validation::reject(argument,
                       ": is for another task than '" + task.name + "': must be for the same kind, position or pose");
  };
  if (py::isinstance<PyFollower>(given)) return same(py::cast<PyFollower&>(given).of(task.name), "follower");
  if (py::isinstance<PyTargetFilter>(given)) {
    auto& any = py::cast<PyTargetFilter&>(given).any;
    const Source source = same(any, "filter");
    const double dt = std::visit([](const auto& each) { return each.dt(); }, any);
    if (dt != dt_) validation::fail("filter's dt", dt, "the tracker's dt = ", dt_);
    return source;
  }
  if (py::isinstance<PyStream>(given)) {
    auto& stream = py::cast<PyStream&>(given);
    if (stream.kind != task.kind || stream.size != task.size) {
      validation::reject("stream",
                         ": is for another task than '" + task.name +
                             "': must be a JointStream for a posture of as many joints, or a PoseStream for a pose");
    }
    if (stream.dt != dt_) validation::fail("stream's dt", stream.dt, "the tracker's dt = ", dt_);
    return &stream;
  }
  return std::nullopt;
}

void StackLoop::read(const PyReferences& references) {
  StackReferences::Sources sources;
  StackReferences::Targets targets;
  for (const auto& [key, given] : references) {
    if (!py::isinstance<py::str>(key)) {
      validation::reject("references", ": the keys of the dictionary must be task names");
    }
    const StackTask& task = plan().task(py::cast<std::string>(key));
    if (const auto source = source_of(task, given)) {
      sources.emplace_back(&task, *source);
    } else {
      targets.emplace_back(&task, read_target(task, given));
    }
  }
  references_.set(targets, std::move(sources));
}

StackLoop::Result StackLoop::tick(const PyReferences& references) {
  read(references);
  return tracker_->tick(references_);
}

StackLoop::Result StackLoop::resolve_measured(const State<kDynamic>& measured, const PyReferences& references) {
  read(references);
  return tracker_->resolve_measured(measured, references_.take(0.0));
}

PyFollower StackLoop::follow(const std::vector<std::pair<std::string, const Path*>>& paths,
                             const FollowOptions& options) const {
  StackOptions stack{references_.plan_now(), {}, 0.0};
  for (const auto& [name, path] : paths) stack.add(name, *path);
  if (options.keep_path) {
    const auto keep = [&](const auto& first) {
      using Space = typename std::decay_t<decltype(first)>::Space;
      const State<kDynamic>& start = tracker().state();
      const Motion<Space> motion{nullptr, first, options.scheme, start, TimeGrid<double>(dt_, dt_), &stack};
      return motion.kept_motion(options.limits, tracker().bounds(), stack.duration, options.shortest, options.fastest);
    };
    const auto kept = std::visit(keep, stack.paths.front().path);
    for (TaskPath& each : stack.paths) each.keep(kept);
  }
  PyFollower result;
  for (const auto& [index, any] : stack.paths) {
    const StackTask& task = plan().tasks[index];
    const Transform<> at = task.frame_of(tracker().tip());
    const auto follow = [&](const auto& path) -> PyFollower::Any {
      using Space = typename std::decay_t<decltype(path)>::Space;
      if constexpr (std::is_same_v<Space, Pose>) return AnyFollower<Space>(path, at, options.ramp);
      if constexpr (!std::is_same_v<Space, Pose>) return AnyFollower<Space>(path, at.p, options.ramp);
    };
    result.each.emplace_back(task.name, std::visit(follow, any));
  }
  return result;
}

void StackLoop::enable(int level, bool on) {
  if (level < 1 || level >= plan().levels) {
    validation::fail("level", level, "a level below the first, at most ", plan().levels - 1);
  }
  tracker().enable(level, on);
}

void StackLoop::reorder(const std::vector<int>& order) {
  std::array<int, AnyStack::kLevels> whole{};
  std::iota(whole.begin(), whole.end(), 0);  // Levels without tasks stay last.
  const auto levels = static_cast<std::size_t>(plan().levels);
  if (order.size() == levels) std::copy(order.begin(), order.end(), whole.begin());
  const auto count = plan().levels;
  const bool sound =
      order.size() == levels && std::all_of(order.begin(), order.end(), [count](int k) { return k < count; });
  if (!sound || !tracker_->reorder(whole)) {
    validation::reject("order", ": must have each level from 0 to " + std::to_string(count - 1) +
                                    " once, with an enabled level first");
  }
  references_.reorder(whole, tracker_->tip());
}

PyPoints StackLoop::points() const {
  PyPoints points;
  for (const StackTask& task : plan().tasks) {
    const py::str name(task.name);
    const Transform<> at = task.frame_of(tracker().tip());
    if (task.kind == TaskKind::kPosition || task.kind == TaskKind::kCenterOfMass) points[name] = array_of(at.p);
    if (task.kind == TaskKind::kOrientation) points[name] = array_of(at.R);
    if (task.kind == TaskKind::kPose) points[name] = array_of(at);
    if (task.kind == TaskKind::kAxis) points[name] = array_of(column(at.R, 2));
    if (task.kind == TaskKind::kPosture) points[name] = array_of(task.posture_of(tracker().tip()));
  }
  return points;
}

Array StackLoop::frame(const std::string& name) const {
  const StackTask& task = plan().task(name);
  if (task.kind == TaskKind::kPosture) {
    validation::reject("task", " = '" + name + "': postures have no frame: must be a task of a frame");
  }
  return array_of(task.frame_of(tracker().tip()));
}

Eigen::VectorXd StackLoop::scales(const Result& tick) const {
  return Eigen::Map<const Eigen::VectorXd>(tick.scales.data(), plan().levels);
}

Eigen::VectorXd StackLoop::error(const Result& tick) const {
  Eigen::VectorXd all(plan().error_size());
  Eigen::Index row = 0;
  for (const StackTask& task : plan().tasks) {
    all.segment(row, task.size) = task.error_of(tick.error);
    row += task.size;
  }
  return all;
}

}  // namespace fpbm::bindings
