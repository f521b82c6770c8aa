#pragma once

#include "fpbm/limits/detail/stack_saturation.hpp"
#include "fpbm/realtime/detail/lower_levels.hpp"
#include "fpbm/realtime/detail/require_stable.hpp"
#include "fpbm/realtime/detail/stack_tick.hpp"
#include "fpbm/realtime/tracker.hpp"
#include "fpbm/scheme/detail/by_levels.hpp"
#include "fpbm/task/detail/robot_tasks.hpp"
#include "fpbm/task/detail/task_gains.hpp"

namespace fpbm {

/// Throws std::invalid_argument if the scheme has feedback gains, since the tasks of a stack have gains, or if a tick
/// does not damp the error of a task with its gains.
template <typename Scheme, typename... Levels, typename Scalar>
void require_stack_gains(const Scheme& scheme, const Stack<Levels...>& stack, const TickOfGains<Scalar>& tick) {
  constexpr Level kLevel = Scheme::kLevel;
  const auto require_none = [](const char* name, const auto& gain) {
    if (gain != 0) validation::fail(name, gain, "0: give gains to the tasks of the stack");
  };
  if constexpr (kHasGains<Scheme>) {
    require_none("k1", scheme.k1);
    require_none("k2", scheme.k2);
  }
  if constexpr (kHasGain<Scheme>) require_none("k", scheme.k);
  const auto require = [&](const auto& task) {
    if (rows_of(task) == 0) return;
    const Scalar k1 = kLevel == Level::kVelocity ? Scalar(0) : task.gains.k1;
    require_stable_gains<kLevel, Scalar>({"k1", k1, kLevel == Level::kVelocity ? "k" : "k2", task.gains.k2}, tick);
  };
  std::apply([&](const auto&... task) { (require(task), ...); }, stack.tasks());
}

/// require_stable() for the scheme of a stack. The integral of the tracker acts with the gains of the tasks.
template <typename Scheme, typename Stack_, typename Scalar>
void require_stable(const ByLevels<Scheme, Stack_>& by_levels, const TickOfGains<Scalar>& tick) {
  require_stable(by_levels.scheme, TickOfGains<Scalar>{tick.dt, Scalar(0)});
}

/// The type of the bounds among the last arguments of Tracker's constructors: limits, qdd0 and bounds.
template <typename = void, typename = void, typename Bounds_ = Bounds<>>
struct LastArguments {
  using Bounds = Bounds_;
};

/// Tracker of a stack of tasks. more: further arguments of Tracker's constructors: limits, qdd0 and bounds. Throws
/// std::invalid_argument as Tracker does, and if a task does not suit the robot, a level has more rows than the robot
/// has joints, or the scheme has feedback gains.
template <typename Robot, typename... Levels, typename Scheme, typename Start, typename... More>
[[nodiscard]] auto stack_tracker(const Robot& robot, const Stack<Levels...>& stack, const Scheme& scheme,
                                 const Start& start, const TrackerOptions<typename Robot::Scalar>& options = {},
                                 const More&... more) {
  using Tasks = Stack<Levels...>;
  using Space = typename Tasks::Space;
  using Scalar = typename Robot::Scalar;
  require_stack_gains(scheme, stack, TickOfGains<Scalar>{options.dt, options.integral_gain});
  return Tracker<RobotTasks<Robot, Tasks>, Space, ByLevels<Scheme, Tasks>, typename LastArguments<More...>::Bounds>(
      RobotTasks<Robot, Tasks>(robot, stack), Space{}, ByLevels<Scheme, Tasks>(scheme), start, options, more...);
}

}  // namespace fpbm
