#pragma once

#include "fpbm/core/status.hpp"
#include "fpbm/realtime/detail/path_motion.hpp"
#include "fpbm/realtime/detail/tracker_state.hpp"

namespace fpbm {

/// Whether all bounds accept a tick to the state `next` and a stop after the tick, which becomes the planned stop. If a
/// bound needs less deceleration, slower stops are tried.
template <typename TrackerState>
[[nodiscard]] bool accept(TrackerState& state, const typename TrackerState::JointState& next) noexcept {
  using Scalar = typename TrackerState::Scalar;
  using PlannedStop = std::decay_t<decltype(state.stop)>;
  const auto& from = state.tick.joints;
  const typename TrackerState::JointVector last = (next.qd - from.qd) / state.dt();
  const auto accepted = [&](Scalar fraction) noexcept {
    const auto stop = PlannedStop::after(state.limits(), from, next, last, fraction);
    if (!state.bounds.accepts(state.limits(), from, stop)) return false;
    state.stop = stop;
    return true;
  };
  const Scalar first = state.stop.plan.next_fraction();
  for (Scalar fraction = first; fraction > Scalar(0); fraction = state.bounds.slower_stop(fraction)) {
    if (accepted(fraction)) return true;
  }
  // A faster stop ends nearer.
  for (Scalar fraction(1); first < Scalar(1) && fraction > first; fraction = state.bounds.slower_stop(fraction)) {
    if (accepted(fraction)) return true;
  }
  return false;
}

/// Third step of a tick: the state after a tick with the motion u, if all bounds accept the tick and a stop after the
/// tick. Otherwise, or if every joint brakes, the tick is the next tick of the planned stop (docs/clearance.md,
/// Guarantees). With bounds on torque, motions between u and this tick are tried before; on a kept path, motions
/// between u and the slowest motion on the path. rows: TrackerState::rows().
template <typename TrackerState, typename Desired, typename Rows_>
[[nodiscard]] typename TrackerState::JointState prove(TrackerState& state, const Desired& desired, const Rows_& rows,
                                                      const typename TrackerState::JointVector& u,
                                                      typename TrackerState::Result& result) noexcept {
  using Scalar = typename TrackerState::Scalar;
  using JointVector = typename TrackerState::JointVector;
  const auto& tick = state.tick;
  typename TrackerState::JointState next = tick.after(u);
  if constexpr (TrackerState::kBounded) {
    const bool braking = state.brakes(result.status);
    if (state.bounds.empty() || (!braking && accept(state, next))) return next;
    auto plan = state.stop.plan;
    const JointVector qdd = plan.next(state.limits(), tick.joints, tick.last);
    const JointVector stopping =
        TrackerState::kLevel == Level::kAcceleration ? qdd : JointVector(tick.joints.qd + state.dt() * qdd);
    JointVector slowest = stopping;
    [[maybe_unused]] bool on_path = false;
    if constexpr (Desired::kOnPath) {
      on_path = state.on_path() && find_motion_on_path(desired, state.limits().box(tick.joints, tick.last), rows,
                                                       state.most_path_fraction, Scalar(0), slowest);
    }
    // Without these motions, the accelerations of a Panda with 3 kg jump from tick to tick at the edge of its torques.
    for (Scalar part(0.5); !braking && state.bounds.bounds_torques() && part > Scalar(0.05); part /= Scalar(2)) {
      next = tick.after(JointVector(slowest + part * (u - slowest)));
      if (!accept(state, next)) continue;
      if (!on_path) multiply_scale(result, part);
      result.status = worse(result.status, Status::kSlowed);
      return next;
    }
    state.stop.plan = plan;
    next = tick.after(stopping);
    multiply_scale(result, Scalar(0));
    if (!braking) result.status = Status::kBlocked;
  }
  return next;
}

}  // namespace fpbm
