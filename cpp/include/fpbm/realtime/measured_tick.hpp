#pragma once

#include <type_traits>

#include "fpbm/clearance/unguarded.hpp"
#include "fpbm/core/status.hpp"
#include "fpbm/realtime/tick.hpp"

namespace fpbm {

/// Ends a tick of Tracker::resolve_measured(): computes the acceleration within the limits for a measured state. loop:
/// kinematics and acceleration of the scheme in the measured state. `last`: last command. result: has the status of the
/// scheme.
template <typename Loop, typename Limiter, typename LimitedState, typename Space, int N, typename Scalar>
[[nodiscard]] Vector<N, Scalar> limit_measured(const Loop& loop, const Limiter& limiter, LimitedState& tracker_state,
                                               const State<N, Scalar>& measured, const Vector<N, Scalar>& last,
                                               Tick<Space, N, Scalar>& result) noexcept {
  const auto& limits = limiter.limits();
  auto& guard = tracker_state.guard();
  auto rows = guard.rows(limits, measured);
  if constexpr (LimitedState::kGuarded) {
    // If the tip rotates, the direction of its velocity after the time limits.tick() differs from the direction after
    // the time dt(). Therefore, rows are added for both times.
    guard.bound_speeds(limits, measured, loop.qdd, rows);
    const Scalar fraction = tracker_state.dt() / limits.tick();
    if (fraction < Scalar(1)) guard.bound_speeds(limits, measured, fraction * loop.qdd, rows);
  }
  auto tasks = jacobian_in_metres(loop.kinematics);
  if constexpr (LimitedState::kHasLevels) tasks.set_first_motion(loop.first);
  auto found = with_scale(tasks, last, Scalar(0));
  const bool braking = tracker_state.stopping() || result.status >= Status::kStalled;
  if (braking) {
    found.u = limiter.brake(measured, last).u;
  } else {
    found = limiter.motion(tasks, measured, loop.qdd, last, rows);
  }
  take_scale(result, found);
  result.saturated = found.joints;
  if (found.scale < Scalar(1) && !braking) {
    result.status = guard.is_near(found.rows) ? Status::kBlocked : Status::kSlowed;
  }
  if (result.status == Status::kOk) tracker_state.correction().integrate(result);
  return found.u;
}

}  // namespace fpbm
