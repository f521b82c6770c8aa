#include "fpbm/realtime/track.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <memory>
#include <type_traits>
#include <variant>
#include <vector>

#include "motion.hpp"
#include "stack_references.hpp"
#include "tracker.hpp"

namespace fpbm::bindings {
namespace {

/// The tracker of a motion, for the arm of the motion or for the robot of its stack.
template <typename Space, typename Arm_, typename MotionSpace>
std::unique_ptr<AnyTracker<Space>> tracker_of(const Arm_& arm, const Motion<MotionSpace>& motion,
                                              const LimitOptions& limit_options) {
  const JointVector rest = JointVector::Zero(motion.start.q.size());
  TrackerOptions<> options = limit_options.options;
  options.dt = motion.grid.dt();
  return make_tracker<Space>(arm, motion.scheme,
                             {motion.start, options, limit_options.limits, rest, limit_options.bounds});
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

/// The rows of Space of an error in space.
template <typename Space>
Vector<Space::kRows> rows_of(const JointVector& error) noexcept {
  if constexpr (std::is_same_v<Space, PlanarPose>) {
    return {error(0), error(1), error(5)};
  } else {
    return error.head<Space::kRows>();
  }
}

/// Ramp of the followers of a motion, which never pause [s].
constexpr double kRamp = 0.5;

/// The paths of a stack, each from the frame of its task.
class Followers {
 public:
  Followers(StackReferences& references, const std::vector<TaskPath>& paths, const AnyStack::Point& tip) {
    each_.reserve(paths.size());  // The sources point to the followers.
    StackReferences::Sources sources;
    for (const auto& [index, any] : paths) {
      const StackTask* task = &references.plan().tasks[index];
      std::visit(
          [&](const auto& path) {
            using Follower = PathFollower<std::decay_t<decltype(path)>>;
            each_.emplace_back(Follower(path, point_of<typename Follower::Space>(task->frame_of(tip)), kRamp));
            sources.emplace_back(task, &std::get<Follower>(each_.back()));
          },
          any);
    }
    references.set({}, std::move(sources));
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

  /// tick: result of the tick that starts at the sample, if the motion has ticks.
  template <typename... AnyTick>
  bool operator()(const Sample<AnyStack::Space, kDynamic>& sample, const AnyTick&... tick) {
    const StackPlan& plan = motion_.stack->plan;
    const StackTask& followed = plan.tasks[motion_.stack->paths.front().task];
    if (output_.summary != nullptr) motion_.arm->kinematics(sample.q, kinematics_);
    if (output_.errors != nullptr) {
      double* row = output_.errors + static_cast<std::ptrdiff_t>(sample.index) * plan.error_size();
      for (const StackTask& task : plan.tasks) {
        const JointVector own = task.error_of(sample.error);
        row = std::copy_n(own.data(), own.size(), row);
      }
    }
    if (output_.scales != nullptr) {
      (std::copy_n(tick.scales.data(), plan.levels, output_.scales + sample.index * plan.levels), ...);
    }
    const auto point = [&](const AnyStack::Point& at) { return point_of<Space>(followed.frame_of(at)); };
    return record_(Sample<Space, kDynamic>{sample.index, sample.t, sample.q, sample.qd, sample.qdd, point(sample.tip),
                                           Reference<Space>::hold(point(sample.reference.x)),
                                           rows_of<Space>(followed.error_of(sample.error)), kinematics_.J},
                   tick...);
  }

  void finish() const noexcept { record_.finish(); }

 private:
  const Motion<Space>& motion_;
  const Output<Space>& output_;
  Recorder<Space> record_;
  Kinematics<Space, kDynamic> kinematics_;
};

/// fpbm::track() with the distance of the nearest pair in each sample.
template <typename Tracker, typename Follower, typename Space, typename Record>
RolloutResult<kDynamic> track_clear(Tracker& tracker, Follower& follower, const Motion<Space>& motion,
                                    const Output<Space>& output, Record& record) {
  const auto& clearance = tracker.bounds().clearance();
  auto placed = clearance.placement();
  const auto with_clearance = [&](const auto& sample, const auto& tick) noexcept {
    if (output.clearance != nullptr) {
      output.clearance[sample.index] = clearance.nearest_pair(sample.q, placed).second;
    }
    return record(sample, tick);
  };
  const auto result = fpbm::track(tracker, follower, motion.grid, with_clearance);
  record.finish();
  return result;
}

}  // namespace

template <typename Space>
RolloutResult<kDynamic> Motion<Space>::track(const LimitOptions& limit_options, const Output<Space>& output) const {
  if (stack == nullptr) {
    const auto tracker = tracker_of<Space>(*arm, *this, limit_options);
    AnyFollower<Space> follower(path, tracker->tip(), kRamp);
    Recorder<Space> record(output, Level::kAcceleration);
    return track_clear(*tracker, follower, *this, output, record);
  }
  const auto tracker = tracker_of<AnyStack::Space>(stack->plan.arm_at(scheme.level), *this, limit_options);
  StackReferences references(stack->plan, tracker->tip());
  const Followers followers(references, stack->paths, tracker->tip());
  TaskRecorder<Space> record(*this, output, Level::kAcceleration);
  return track_clear(*tracker, references, *this, output, record);
}

template <typename Space>
RolloutResult<kDynamic> Motion<Space>::simulate_stack(const Output<Space>& output) const {
  TaskRecorder<Space> record(*this, output, scheme.level);
  const auto result = rollout_of_stack(stack->plan, {*stack}, scheme, start, grid, std::ref(record));
  record.finish();
  return result;
}

template <typename Space>
void Motion<Space>::play(const Spline<kDynamic>& joints, const FastestClock& clock, const Output<Space>& output) const {
  if (stack == nullptr) {
    fpbm::play(*arm, path, joints, clock, grid, Recorder<Space>(output, Level::kAcceleration));
  } else {
    fpbm::play(stack->plan.arm_at(scheme.level), StackPath{*stack}, joints, clock, grid,
               TaskRecorder<Space>(*this, output, Level::kAcceleration));
  }
}

template <typename Space>
template <int N>
LaneTracker<Space, N> Motion<Space>::tracker(const LimitOptions& limit_options) const {
  return {tracker_of<Space>(*arm, *this, limit_options), continuous_joints(*arm, limit_options.limits)};
}

template <typename Space>
void Motion<Space>::require(const LimitOptions* limit_options) const {
  if (limit_options != nullptr && stack != nullptr) {
    (void)tracker_of<AnyStack::Space>(stack->plan.arm_at(scheme.level), *this, *limit_options);
  } else if (limit_options != nullptr) {
    (void)tracker_of<Space>(*arm, *this, *limit_options);
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
