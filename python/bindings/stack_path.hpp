#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <memory>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "fpbm/any/detail/any_path.hpp"
#include "fpbm/path/detail/timed_path.hpp"
#include "fpbm/simulate/rollout.hpp"
#include "scheme.hpp"
#include "sources.hpp"
#include "stack_tasks.hpp"

namespace fpbm::bindings {

/// The path of a task of a stack.
struct TaskPath {
  std::size_t task;  ///< Index among the plan's tasks.
  std::variant<AnyPath<Position<3>>, AnyPath<Pose>> path;

  /// Replaces the clock of the path.
  void keep(const std::shared_ptr<const PlannedMotion>& motion) {
    std::visit([&](auto& own) { own = std::decay_t<decltype(own)>(TimedPath(own, motion)); }, path);
  }
};

/// Several tasks, some of which follow paths.
struct StackOptions {
  StackPlan plan;
  std::vector<TaskPath> paths;  ///< Samples have tip, reference and error of the first path.
  double duration;              ///< Duration of the longest path [s].

  /// Adds a path of the task of a name. Throws std::invalid_argument if the task cannot follow the path.
  void add(const std::string& name, const Path& path) {
    const StackTask& task = plan.follower(name);
    const auto index = static_cast<std::size_t>(&task - plan.tasks.data());
    if (task.kind == TaskKind::kPose) {
      paths.push_back({index, path.as<Pose>()});
    } else {
      paths.push_back({index, path.as<Position<3>>()});
    }
    duration = std::max(duration, path.duration());
  }
};

/// A reference in space as a reference of a task; a position has no orientation.
[[nodiscard]] inline StackTarget target_at(const Reference<Position<3>>& reference) noexcept {
  StackTarget target{{}, {}, reference.xd, reference.xdd};
  target.at.p = reference.x;
  return target;
}
[[nodiscard]] inline StackTarget target_at(const Reference<Pose>& reference) noexcept {
  return {reference.x, {}, reference.xd, reference.xdd};
}

/// The paths of a stack as one path in the space of the stack, for rollout().
struct StackPath {
  using Scalar = double;
  using Space = AnyStack::Space;

  const StackOptions& options;

  [[nodiscard]] double duration() const noexcept { return options.duration; }
};

/// Recorder of a motion of a stack.
using StackRecorder = std::function<bool(const Sample<AnyStack::Space, kDynamic>&)>;

/// fpbm::rollout() of a stack. Throws std::invalid_argument as make_tracker() does. Compiled once, in
/// stack_tracker.cpp.
RolloutResult<kDynamic> rollout_of_stack(const StackPlan& plan, const StackPath& path, const Scheme& scheme,
                                         const State<kDynamic>& start, const TimeGrid<double>& grid,
                                         const StackRecorder& record);

}  // namespace fpbm::bindings

namespace fpbm {

/// References of a stack: each task with a path follows its path, and stays at the end of the path after its duration.
/// Each other task has its target or, without a target, its start point.
template <>
class AnchoredPath<bindings::StackPath, double> {
 public:
  using Space = AnyStack::Space;

  AnchoredPath(const bindings::StackPath& path, const AnyStack::Point& anchor)
      : options_(path.options), reference_(Reference<Space>::hold(anchor)) {
    const auto& [plan, paths, duration] = options_;
    for (std::size_t i = 0; i < plan.tasks.size(); ++i) {
      if (plan.targets[i]) plan.tasks[i].put(*plan.targets[i], reference_);
    }
    for (const bindings::TaskPath& each : paths) {
      const Transform<> at = plan.tasks[each.task].frame_of(anchor);
      if (const auto* positions = std::get_if<AnyPath<Position<3>>>(&each.path)) {
        anchored_.emplace_back(Anchored<Position<3>>(*positions, at.p));
      } else {
        anchored_.emplace_back(Anchored<Pose>(std::get<AnyPath<Pose>>(each.path), at));
      }
    }
  }

  [[nodiscard]] const Reference<Space>& motion(double t, double since) noexcept {
    return follow([&](auto& anchored, double duration) {
      const bool ended = since >= duration && duration < options_.duration;
      return ended ? anchored.hold() : anchored.motion(t, since);
    });
  }

  [[nodiscard]] const Reference<Space>& hold() noexcept {
    return follow([](const auto& anchored, double) { return anchored.hold(); });
  }

 private:
  /// Sets the reference of each task with a path to the result of reference_of(anchored, duration).
  template <typename F>
  [[nodiscard]] const Reference<Space>& follow(F&& reference_of) noexcept {
    for (std::size_t i = 0; i < anchored_.size(); ++i) {
      const auto& [task, path] = options_.paths[i];
      const double duration = std::visit([](const auto& each) { return each.duration(); }, path);
      std::visit([&, &own = options_.plan.tasks[task]](
                     auto& anchored) { own.put(bindings::target_at(reference_of(anchored, duration)), reference_); },
                 anchored_[i]);
    }
    return reference_;
  }

  template <typename PathSpace>
  using Anchored = AnchoredPath<AnyPath<PathSpace>, double>;

  const bindings::StackOptions& options_;
  Reference<Space> reference_;
  std::vector<std::variant<Anchored<Position<3>>, Anchored<Pose>>> anchored_;
};

}  // namespace fpbm
