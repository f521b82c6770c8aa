#pragma once

#include "fpbm/core/status.hpp"
#include "fpbm/model/kinematics.hpp"
#include "fpbm/simulate/detail/motion.hpp"
#include "fpbm/simulate/rollout.hpp"
#include "fpbm/simulate/time_grid.hpp"

namespace fpbm {

/// Executes a whole motion of a tracker with a path follower, one tick for each time of the grid.
///
/// `record(const Sample&, const Tick&)` is called once per tick, and must be noexcept. If `record` returns false, the
/// motion ends. Sample k contains the state at t_k, the tip error in this state, and the reference of the follower. The
/// qdd of sample k is the mean acceleration of the tick that starts at t_k. The step of the grid must be the tick of
/// the tracker. The motion does not stop at a failure: the status of the result is the most severe status of all ticks.
/// Neither throws nor allocates.
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
    const Sample<Space, N, Scalar> sample{
        k, result.time, state.q, state.qd, tick.qdd, kinematics.tip, reference, tick.error, first_rows(kinematics)};
    const auto with_tick = [&](const auto& at) { return record(at, tick); };
    if (!show(with_tick, sample)) break;
  }
  return result;
}

}  // namespace fpbm
