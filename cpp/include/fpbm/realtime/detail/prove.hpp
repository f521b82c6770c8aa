#pragma once

#include "fpbm/core/status.hpp"
#include "fpbm/realtime/detail/tracker_state.hpp"

namespace fpbm {

/// Third step of a tick: the state after a tick with the motion u, if the arm can stop clear of all shapes after this
/// tick. Otherwise, or if every joint brakes, the tick is the next tick of the planned stopping trajectory
/// (docs/clearance.md, Guarantees).
template <typename TrackerState>
[[nodiscard]] typename TrackerState::JointState prove(TrackerState& state, const typename TrackerState::JointVector& u,
                                                      typename TrackerState::Result& result) noexcept {
  using JointVector = typename TrackerState::JointVector;
  const auto& tick = state.tick;
  typename TrackerState::JointState next = tick.after(u);
  if constexpr (TrackerState::kGuarded) {
    const bool braking = state.brakes(result.status);
    if (state.guard.empty() || (!braking && state.guard.accepts(state.limits(), tick.joints, next))) return next;
    const JointVector qdd = state.guard.stop(state.limits(), tick.joints, tick.last);
    next =
        tick.after(TrackerState::kLevel == Level::kAcceleration ? qdd : JointVector(tick.joints.qd + state.dt() * qdd));
    multiply_scale(result, typename TrackerState::Scalar(0));
    if (!braking) result.status = Status::kBlocked;
  }
  return next;
}

}  // namespace fpbm
