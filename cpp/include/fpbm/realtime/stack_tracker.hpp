#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "fpbm/limits/saturation_by_level.hpp"
#include "fpbm/limits/task_levels.hpp"
#include "fpbm/realtime/require_stable.hpp"
#include "fpbm/realtime/stack_references.hpp"
#include "fpbm/realtime/tracker.hpp"
#include "fpbm/scheme/by_levels.hpp"
#include "fpbm/task/stack_kinematics.hpp"

namespace fpbm {

/// Result of a tick of a stack. status, scale and sigma are those of the first level, unless only a lower level is
/// slowed: then status is kSlowed.
template <typename... Levels, int N, typename Scalar>
struct Tick<StackSpace<Levels...>, N, Scalar> {
  Vector<N, Scalar> q;
  Vector<N, Scalar> qd;
  Vector<N, Scalar> qdd;
  Status status;
  Scalar scale;
  std::uint32_t saturated;
  Scalar sigma;
  Vector<StackSpace<Levels...>::kRows, Scalar> error;  ///< x ⊖ f(q) of each task at the tick's start [m, rad].
  std::array<Scalar, sizeof...(Levels)> scales{};      ///< Share of each level that the limits left.

  /// A level with a reference that is not finite is not resolved: its scale is 0.
  void report_lower_levels() noexcept {
    StackSpace<Levels...>::each([&](auto space, auto i, int row) noexcept {
      constexpr int kLevel = Stack<Levels...>::level(static_cast<int>(decltype(i)::value));
      for (int j = row; j < row + decltype(space)::kRows; ++j) {
        if (!std::isfinite(error(j))) scales[kLevel] = Scalar(0);
      }
    });
    for (const Scalar s : scales) {
      if (s < Scalar(1)) status = worse(status, Status::kSlowed);
    }
  }
};

/// The levels' J, for the limits.
template <typename... Levels, int N, typename Scalar>
[[nodiscard]] TaskLevels<N, Scalar, Levels::kRows...> jacobian_in_metres(
    const Kinematics<StackSpace<Levels...>, N, Scalar>& kinematics) noexcept {
  return std::apply(
      [&](const auto&... rows) { return TaskLevels<N, Scalar, Levels::kRows...>(kinematics.enabled, rows.J...); },
      kinematics.levels);
}

/// Throws std::invalid_argument where a scheme has feedback gains, which the tasks of a stack have.
template <typename Scheme>
void require_no_gains(const Scheme& scheme) {
  if constexpr (kHasGains<Scheme>) {
    if (scheme.k1 != 0) validation::fail("k1", scheme.k1, "0: each task of a stack has its own");
    if (scheme.k2 != 0) validation::fail("k2", scheme.k2, "0: each task of a stack has its own");
  }
  if constexpr (kHasGain<Scheme>) {
    if (scheme.k != 0) validation::fail("k", scheme.k, "0: each task of a stack has its own");
  }
}

/// Throws std::invalid_argument where a tick does not damp the error of a task with its gains.
template <Level kLevel, typename... Levels, typename Scalar>
void require_stable_tasks(const Stack<Levels...>& stack, const TickOfGains<Scalar>& tick) {
  const auto require = [&](const auto& task) {
    const Scalar k1 = kLevel == Level::kVelocity ? Scalar(0) : task.gains.k1;
    require_stable_gains<kLevel, Scalar>({"k1", k1, kLevel == Level::kVelocity ? "k" : "k2", task.gains.k2}, tick);
  };
  std::apply([&](const auto&... task) { (require(task), ...); }, stack.tasks());
}

/// A Tracker of a stack of tasks. Throws std::invalid_argument as Tracker does, where a task does not suit the robot,
/// and where the scheme has feedback gains of its own (ByLevels).
template <typename Robot, typename... Levels, typename Scheme, typename Start>
[[nodiscard]] auto stack_tracker(const Robot& robot, const Stack<Levels...>& stack, const Scheme& scheme,
                                 const Start& start, const TrackerOptions<typename Robot::Scalar>& options = {}) {
  using Tasks = Stack<Levels...>;
  using Space = typename Tasks::Space;
  require_no_gains(scheme);
  require_stable_tasks<Scheme::kLevel>(stack, TickOfGains<typename Robot::Scalar>{options.dt, options.integral_gain});
  return Tracker<RobotTasks<Robot, Tasks>, Space, ByLevels<Scheme, Tasks>>(
      RobotTasks<Robot, Tasks>(robot, stack), Space{}, ByLevels<Scheme, Tasks>(scheme), start, options);
}

/// The same within given limits, with shapes that the robot keeps clear of (Guard). qdd0: acceleration of the tick
/// before.
template <typename Robot, typename... Levels, typename Scheme, int N, typename Scalar, typename Guard_>
[[nodiscard]] auto stack_tracker(const Robot& robot, const Stack<Levels...>& stack, const Scheme& scheme,
                                 const State<N, Scalar>& start, const TrackerOptions<Scalar>& options,
                                 const Limits<Scheme::kLevel, N, Scalar>& limits, const Vector<N, Scalar>& qdd0,
                                 const Guard_& guard) {
  using Tasks = Stack<Levels...>;
  using Space = typename Tasks::Space;
  require_no_gains(scheme);
  require_stable_tasks<Scheme::kLevel>(stack, TickOfGains<typename Robot::Scalar>{options.dt, options.integral_gain});
  return Tracker<RobotTasks<Robot, Tasks>, Space, ByLevels<Scheme, Tasks>, Guard_>(
      RobotTasks<Robot, Tasks>(robot, stack), Space{}, ByLevels<Scheme, Tasks>(scheme), start, options, limits, qdd0,
      guard);
}

}  // namespace fpbm
