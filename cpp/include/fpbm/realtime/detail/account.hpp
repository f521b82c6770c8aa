#pragma once

#include <utility>

#include "fpbm/core/status.hpp"
#include "fpbm/realtime/detail/saddle_exit.hpp"
#include "fpbm/realtime/detail/task_distance.hpp"
#include "fpbm/realtime/detail/tracker_state.hpp"

namespace fpbm {

/// Starts a recovery from a singular posture that is a saddle point of the error.
template <typename TrackerState, typename Arm, typename Target>
[[gnu::cold, gnu::noinline]] void leave_saddle(TrackerState& state, const Arm& arm, const Target& now,
                                               const typename TrackerState::Scalar& error) noexcept {
  const auto& q = state.tick.joints.q;
  state.progress.leave(
      q, saddle_exit<typename TrackerState::Space>(arm, q, now.x, state.correction(now).x, state.limits().bounds()),
      error);
}

/// Updates the integral of the error and the detection of a stall, unless the joints return from a start outside their
/// bounds. q: posture at the start of the tick. damped: whether the scheme damped the desired motion.
template <typename TrackerState, typename Arm, typename Target>
void update_progress(TrackerState& state, const Arm& arm, const typename TrackerState::JointVector& q,
                     const Target& now, bool damped, const typename TrackerState::Result& result) noexcept {
  using Distance = TaskDistance<typename TrackerState::Space, typename TrackerState::Scalar>;
  auto& progress = state.progress;
  if (state.returning) {
    state.returning = !state.limits().is_viable(state.tick.joints, state.tick.last);
    return;
  }
  const auto length = state.correction.length();
  if (progress.recovering()) return progress.recovered(state.tick.joints.q, now.x, length);
  if (result.status == Status::kOk && !state.correction.far()) {
    state.correction.integrate(result);
    progress.done(q, now.x, result, length);
  } else if (progress.missed(state.tick.joints.q, state.limits().bounds().velocity, now.x, result, length,
                             state.correction.far(), damped)) {
    leave_saddle(state, arm, now, Distance::norm(result.error, length));
  }
}

/// Fourth step of a tick: stores the state `next`, and updates the integral of the error and the detection of stalls.
/// damped: whether the scheme damped the desired motion.
template <typename TrackerState, typename Desired>
void account(TrackerState& state, const Desired& desired, typename TrackerState::JointState&& next, bool damped,
             typename TrackerState::Result& result) noexcept {
  auto& tick = state.tick;
  result.q = next.q;
  result.qd = next.qd;
  result.qdd = tick.acceleration_to(next);
  const auto q = tick.joints.q;
  tick.store(std::move(next), result.qdd);
  const bool follows = !state.stops() && !failed(result.status);
  if (follows) update_progress(state, desired.loop.arm, q, desired.now, damped, result);
  state.lower_levels.report(result);
  report_levels(desired.loop.kinematics, desired.now.x, result);
  const auto distances = typename TrackerState::Scalar(state.bounds.near_distance_sum());
  state.lower_levels.end_tick(follows, tick.joints.qd, distances, state.correction.length());
  if constexpr (TrackerState::kBounded) {
    state.progress.watch_shapes(tick.joints.qd.isZero(0), distances, state.correction.length());
  }
}

}  // namespace fpbm
