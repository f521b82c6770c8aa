#include "fpbm/realtime/track.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <type_traits>
#include <variant>
#include <vector>

#include "motion.hpp"
#include "stack_motion.hpp"
#include "tracker.hpp"

namespace fpbm::bindings {
namespace {

template <typename Space>
TrackerOptions<> options_of(const Motion<Space>& motion, const LimitOptions& limit_options) {
  TrackerOptions<> options = limit_options.options;
  options.dt = motion.grid.dt();
  return options;
}

template <typename Space>
std::unique_ptr<AnyTracker<Space>> tracker_of(const Motion<Space>& motion, const LimitOptions& limit_options) {
  return make_tracker<Space>(motion.scheme,
                             {*motion.arm, motion.start, options_of(motion, limit_options), limit_options.limits,
                              JointVector::Zero(motion.start.q.size()), limit_options.bounds});
}

template <typename Space>
StackMotion stack_motion_of(const Motion<Space>& motion, const LimitOptions& limit_options) {
  return {motion.stack->plan,   motion.scheme,
          motion.start,         options_of(motion, limit_options),
          limit_options.limits, JointVector::Zero(motion.start.q.size()),
          limit_options.bounds};
}

/// A frame in space as a point of Space.
template <typename Space>
typename Space::template Point<double> point_of(const Transform<>& at) noexcept {
  if constexpr (std::is_same_v<Space, Pose>) {
    return at;
  } else if constexpr (std::is_same_v<Space, PlanarPose>) {
    return {at.p(0), at.p(1), std::atan2(at.R(1, 0), at.R(0, 0))};
  } else {
    return at.p.head<Space::kRows>();
  }
}
Transform<> transform_of(const Transform<>& at) noexcept {
  return at;
}
Transform<> transform_of(const Vector<3>& p) noexcept {
  Transform<> at;
  at.p = p;
  return at;
}

/// The rows of Space of an error in space.
template <typename Space>
Vector<Space::kRows> rows_of(const JointVector& error) noexcept {
  if constexpr (std::is_same_v<Space, PlanarPose>) {
    return {error(0), error(1), error(5)};
  } else {
    return error.head<Space::kRows>();
  }
}

/// The paths of a stack, each from the present frame of its task.
class Followers {
 public:
  Followers(const StackMotion& tasks, const std::vector<TaskPath>& paths) {
    for (const TaskPath& task_path : paths) {
      const Transform<> at = tasks.plan().tasks[task_path.task].frame_of(tasks.tracker().tip());
      std::visit(
          [&](const auto& path) {
            using Space = typename std::decay_t<decltype(path)>::Space;
            each_.emplace_back(AnyFollower<Space>(path, point_of<Space>(at)));
          },
          task_path.path);
    }
  }

  /// The sources are valid during the lifetime of the followers.
  [[nodiscard]] StackMotion::Sources sources(const StackPlan& plan, const std::vector<TaskPath>& paths) {
    StackMotion::Sources sources;
    for (std::size_t i = 0; i < paths.size(); ++i) {
      std::visit([&](auto& one) { sources.emplace_back(&plan.tasks[paths[i].task], &one); }, each_[i]);
    }
    return sources;
  }
  /// The present reference of the first path.
  [[nodiscard]] Transform<> first() const noexcept {
    return std::visit([](const auto& one) { return transform_of(one.ahead(0.0).x); }, each_.front());
  }

 private:
  std::vector<std::variant<AnyFollower<Position<3>>, AnyFollower<Pose>>> each_;
};

/// Recorder of a motion of a stack. Tip, reference and error of a sample belong to the task that follows the first
/// path. J of a sample, for summaries, is the Jacobian of the arm's tip.
template <typename Space>
class TaskRecorder {
 public:
  TaskRecorder(const Motion<Space>& motion, const Output<Space>& output, Level level)
      : motion_(motion), output_(output), record_(output, level) {}

  /// point: of the stack. reference: frame of the task that follows the first path. error: of the stack. tick: result
  /// of the tick that starts at the sample, if the motion has ticks.
  template <typename... AnyTick>
  bool operator()(int k, const State<kDynamic>& state, const JointVector& qdd, const AnyStack::Point& point,
                  const Transform<>& reference, const Vector<AnyStack::Space::kRows>& error, const AnyTick&... tick) {
    const StackPlan& plan = motion_.stack->plan;
    const StackTask& followed = plan.tasks[motion_.stack->paths.front().task];
    if (output_.summary != nullptr) motion_.arm->kinematics(state.q, kinematics_);
    if (output_.errors != nullptr) {
      double* row = output_.errors + static_cast<std::ptrdiff_t>(k) * plan.error_size();
      for (const StackTask& task : plan.tasks) {
        const JointVector own = task.error_of(error);
        row = std::copy_n(own.data(), own.size(), row);
      }
    }
    return record_(
        {k, motion_.grid.time(k), state.q, state.qd, qdd, point_of<Space>(followed.frame_of(point)),
         Reference<Space>::hold(point_of<Space>(reference)), rows_of<Space>(followed.error_of(error)), kinematics_.J},
        tick...);
  }

  void finish() const noexcept { record_.finish(); }

 private:
  const Motion<Space>& motion_;
  const Output<Space>& output_;
  Recorder<Space> record_;
  Kinematics<Space, kDynamic> kinematics_;
};

/// fpbm::track() of a stack.
template <typename Space>
RolloutResult<kDynamic> track_stack(const Motion<Space>& motion, const LimitOptions& limit_options,
                                    const Output<Space>& output) {
  StackMotion tasks = stack_motion_of(motion, limit_options);
  StackTracker& tracker = tasks.tracker();
  const StackPlan& plan = tasks.plan();
  const std::vector<TaskPath>& paths = motion.stack->paths;
  Followers followers(tasks, paths);
  const StackMotion::Sources sources = followers.sources(plan, paths);
  TaskRecorder<Space> record(motion, output, Level::kAcceleration);
  RolloutResult<kDynamic> result{Status::kOk, 0.0, tracker.state(), 0};
  auto placed = tracker.clearance().placement();
  for (int k = 0; k < motion.grid.samples(); ++k) {
    const State<kDynamic> state = tracker.state();
    const StackTracker::Point tip = tracker.tip();
    const Transform<> reference = followers.first();
    if (output.clearance != nullptr) {
      output.clearance[k] = tracker.clearance().nearest_pair(state.q, placed).second;
    }
    const StackMotion::Result tick = tasks.tick(sources);
    result = {worse(result.status, tick.status), motion.grid.time(k), state, k + 1};
    if (output.scales != nullptr) std::copy_n(tick.scales.data(), plan.levels, output.scales + k * plan.levels);
    if (!record(k, state, tick.qdd, tip, reference, tick.error, tick)) break;
  }
  record.finish();
  return result;
}

/// fpbm::rollout() of a stack.
template <typename Space>
RolloutResult<kDynamic> rollout_with_stack(const Motion<Space>& motion, const Output<Space>& output) {
  const StackOptions& stack = *motion.stack;
  const StackTask& followed = stack.plan.tasks[stack.paths.front().task];
  TaskRecorder<Space> record(motion, output, motion.scheme.level);
  const auto result =
      rollout_of_stack(stack.plan, {stack}, motion.scheme, motion.start, motion.grid, [&](const auto& sample) {
        return record(sample.index, {sample.q, sample.qd}, sample.qdd, sample.tip,
                      followed.frame_of(sample.reference.x), sample.error);
      });
  record.finish();
  return result;
}

}  // namespace

template <typename Space>
RolloutResult<kDynamic> Motion<Space>::track(const LimitOptions& limit_options, const Output<Space>& output) const {
  if (stack != nullptr) return track_stack(*this, limit_options, output);
  const auto tracker = tracker_of(*this, limit_options);
  Recorder<Space> record(output, Level::kAcceleration);
  AnyFollower<Space> follower(path, tracker->tip());
  const auto& clearance = tracker->clearance();
  auto placed = clearance.placement();
  const auto with_clearance = [&](const auto& sample, const auto& tick) noexcept {
    if (output.clearance != nullptr) {
      output.clearance[sample.index] = clearance.nearest_pair(sample.q, placed).second;
    }
    return record(sample, tick);
  };
  const auto result = fpbm::track(*tracker, follower, grid, with_clearance);
  record.finish();
  return result;
}

template <typename Space>
RolloutResult<kDynamic> Motion<Space>::simulate_stack(const Output<Space>& output) const {
  return rollout_with_stack(*this, output);
}

template <typename Space>
template <int N>
LaneTracker<Space, N> Motion<Space>::tracker(const LimitOptions& limit_options) const {
  return {tracker_of(*this, limit_options), continuous_joints(*arm, limit_options.limits)};
}

template <typename Space>
void Motion<Space>::require(const LimitOptions* limit_options) const {
  if (limit_options != nullptr && stack != nullptr) {
    (void)stack_motion_of(*this, *limit_options);
  } else if (limit_options != nullptr) {
    (void)tracker_of(*this, *limit_options);
  } else if (stack != nullptr) {
    (void)rollout_of_stack(stack->plan, {*stack}, scheme, start, grid, [](const auto&) { return false; });
  } else {
    (void)scheme.make<Space>(*arm);
  }
}

template struct Motion<Position<2>>;
template struct Motion<PlanarPose>;
template struct Motion<Position<3>>;
template struct Motion<Pose>;
template LaneTracker<Position<2>, 4> Motion<Position<2>>::tracker<4>(const LimitOptions&) const;
template LaneTracker<Position<3>, 7> Motion<Position<3>>::tracker<7>(const LimitOptions&) const;
template LaneTracker<Pose, 7> Motion<Pose>::tracker<7>(const LimitOptions&) const;

}  // namespace fpbm::bindings
