#pragma once

#include "fpbm/core/status.hpp"
#include "fpbm/realtime/detail/tracker_state.hpp"

namespace fpbm {

/// Third step of a tick: the state after a tick with the motion u, if all bounds accept the tick and the stop after the
/// tick, which becomes the planned stop. Otherwise, or if every joint brakes, the tick is the next tick of the planned
/// stop (docs/clearance.md, Guarantees).
template <typename TrackerState>
[[nodiscard]] typename TrackerState::JointState prove(TrackerState& state, const typename TrackerState::JointVector& u,
                                                      typename TrackerState::Result& result) noexcept {
  using JointVector = typename TrackerState::JointVector;
  using PlannedStop = std::decay_t<decltype(state.stop)>;
  const auto& tick = state.tick;
  typename TrackerState::JointState next = tick.after(u);
  if constexpr (TrackerState::kBounded) {
    const bool braking = state.brakes(result.status);
    if (state.bounds.empty()) return next;
    if (!braking) {
      const JointVector last = (next.qd - tick.joints.qd) / state.dt();
      const auto stop = PlannedStop::after(state.limits(), tick.joints, next, last);
      if (state.bounds.accepts(tick.joints, stop)) {
        state.stop = stop;
        return next;
      }
    }
    const JointVector qdd = state.stop.plan.next(state.limits(), tick.joints, tick.last);
    next =
        tick.after(TrackerState::kLevel == Level::kAcceleration ? qdd : JointVector(tick.joints.qd + state.dt() * qdd));
    multiply_scale(result, typename TrackerState::Scalar(0));
    if (!braking) result.status = Status::kBlocked;
  }
  return next;
}

}  // namespace fpbm
