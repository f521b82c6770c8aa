#pragma once

#include "fpbm/core/status.hpp"
#include "fpbm/model/kinematics.hpp"
#include "fpbm/sim/motion.hpp"
#include "fpbm/sim/rollout.hpp"
#include "fpbm/sim/time_grid.hpp"

namespace fpbm {

/// A whole motion of a tracker behind a follower of a path, one tick for each time of the grid.
///
/// `record(const Sample&, const Tick&)` is called once per tick, noexcept; where it returns a bool, false ends the
/// motion there. Sample k is the state at t_k, the tip's error there, and the reference where the follower is; its qdd
/// is the mean acceleration of the tick that begins there. The grid's step must be the tracker's. Nothing makes the
/// motion fail: the result's status is the worst of any tick. Neither throws nor allocates.
template <typename Tracker, typename Follower, typename Scalar, typename Recorder>
RolloutResult<Tracker::N, Scalar> track(Tracker& tracker, Follower& follower, const TimeGrid<Scalar>& grid,
                                        Recorder&& record) noexcept {
  using Space = typename Follower::Space;
  constexpr int N = Tracker::N;
  RolloutResult<N, Scalar> result{Status::kOk, Scalar(0), tracker.state(), 0};
  Kinematics<Space, N, Scalar> kinematics;
  for (int k = 0; k < grid.samples(); ++k) {
    const State<N, Scalar> state = tracker.state();
    const Reference<Space, Scalar> reference = follower.ahead(Scalar(0));
    tracker.arm().kinematics(state.q, kinematics);
    const auto tick = tracker.tick(follower);
    result = {worse(result.status, tick.status), grid.time(k), state, k + 1};
    const Sample<Space, N, Scalar> sample{k,         result.time, state.q,     state.qd, tick.qdd, kinematics.tip,
                                          reference, tick.error,  kinematics.J};
    const auto with_tick = [&](const auto& at) { return record(at, tick); };
    if (!show(with_tick, sample)) break;
  }
  return result;
}

}  // namespace fpbm
