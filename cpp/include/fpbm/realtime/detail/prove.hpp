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
  using Scalar = typename TrackerState::Scalar;
  using JointVector = typename TrackerState::JointVector;
  using PlannedStop = std::decay_t<decltype(state.stop)>;
  const auto& tick = state.tick;
  typename TrackerState::JointState next = tick.after(u);
  if constexpr (TrackerState::kBounded) {
    const bool braking = state.brakes(result.status);
    if (state.bounds.empty()) return next;
    auto plan = state.stop.plan;
    const JointVector qdd = plan.next(state.limits(), tick.joints, tick.last);
    const JointVector slower =
        TrackerState::kLevel == Level::kAcceleration ? qdd : JointVector(tick.joints.qd + state.dt() * qdd);
    for (Scalar part(1); !braking && part > Scalar(0.05); part /= Scalar(2)) {
      if (part < Scalar(1)) next = tick.after(JointVector(slower + part * (u - slower)));
      const JointVector last = (next.qd - tick.joints.qd) / state.dt();
      for (Scalar fraction(1); fraction > Scalar(0); fraction = state.bounds.slower_stop(fraction)) {
        const auto stop = PlannedStop::after(state.limits(), tick.joints, next, last, fraction);
        if (state.bounds.accepts(state.limits(), tick.joints, stop)) {
          state.stop = stop;
          if (part < Scalar(1)) {
            multiply_scale(result, part);
            result.status = Status::kSlowed;
          }
          return next;
        }
      }
    }
    state.stop.plan = plan;
    next = tick.after(slower);
    multiply_scale(result, Scalar(0));
    if (!braking) result.status = Status::kBlocked;
  }
  return next;
}

}  // namespace fpbm
