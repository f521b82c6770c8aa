#pragma once

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "fpbm/core/detail/lane_access.hpp"
#include "fpbm/core/detail/validation.hpp"
#include "fpbm/path/path_follower.hpp"
#include "fpbm/realtime/detail/require_stable.hpp"
#include "fpbm/realtime/detail/tick_references.hpp"
#include "fpbm/realtime/detail/tick_state.hpp"
#include "fpbm/scheme/detail/set_damping.hpp"
#include "fpbm/simulate/detail/closed_loop.hpp"
#include "fpbm/simulate/detail/motion.hpp"
#include "fpbm/simulate/rollout.hpp"
#include "fpbm/simulate/time_grid.hpp"

namespace fpbm {

/// Trackers of one arm in parallel, one for each SIMD lane. All trackers follow the same path, each from its own tip.
///
/// The desired motion of a tick is computed in lanes. Each tracker ends its tick by itself. Therefore limits are kept
/// exactly, and every tick equals the tick of its tracker alone from the same state, up to round-off. If limits are
/// active for seconds, especially bounds on jerk, a motion amplifies round-off errors like a change of the start state
/// (docs/sweeps.md). If the desired motion of a lane is not finite (near a singular posture, or because the scheme
/// fails), the tracker of this lane computes the whole tick. No lane influences another lane.
template <typename Tracker, typename Arm, typename Space, typename Scheme>
class TrackerBatch {
 public:
  using In = typename Arm::Scalar;
  using Scalar = Number<In>;
  static constexpr int N = Arm::kDof;
  static constexpr std::size_t kLanes = In::size();

  /// arm, scheme: arm and scheme of the trackers in lanes, with the same damping. trackers: one for each lane, with the
  /// tip at the start of the path. Throws std::invalid_argument if the number of trackers is not the number of lanes.
  TrackerBatch(const Arm& arm, Space, const Scheme& scheme, std::vector<Tracker> trackers)
      : arm_(arm), scheme_(scheme), trackers_(std::move(trackers)) {
    if (trackers_.size() != kLanes) {
      validation::reject_value("trackers", trackers_.size(), " has ", trackers_.size(), " entries: must have ", kLanes,
                               ", one per lane");
    }
    set_continuous_joints(scheme_, trackers_.front().continuous(), 0);
    for (std::size_t lane = 0; lane < kLanes; ++lane) set_lane(start_, lane, trackers_[lane].tip());
    status_.fill(Status::kOk);
  }

  [[nodiscard]] const std::vector<Tracker>& trackers() const noexcept { return trackers_; }
  /// Most severe status of the ticks of each tracker.
  [[nodiscard]] const std::array<Status, kLanes>& status() const noexcept { return status_; }

  /// One tick of each tracker. displacements: references relative to the start of each tip. Sets all members of
  /// `sample` except index and time.
  void tick(const TickReferences<Space, Scalar>& displacements, Sample<Space, N, In>& sample) noexcept {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const State<N, Scalar> state = trackers_[lane].state();
      set_lane(sample.q, lane, state.q);
      set_lane(sample.qd, lane, state.qd);
    }
    Loop loop{arm_, scheme_, {}, {sample.q, sample.qd}, sample.q};
    arm_.kinematics(sample.q, loop.kinematics);
    TickReferences<Space, In> references = displacements.template from<In>(start_);
    sample.tip = loop.kinematics.tip;
    sample.J = loop.kinematics.J;
    sample.reference = references.stages[0];
    sample.error = Space::template difference<In>(sample.reference.x, sample.tip);
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const Scalar length = loop.kinematics.length[lane];
      if (trackers_[lane].begin(lane_of(sample.error, lane), length)) correct(references, lane);
    }
    Vector<N, In> u = loop.state.qd;
    const Mask<In> stepped = desired_motion(loop, references, u);
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const Status status = stepped[lane] ? finish(lane, sample.reference, references, u) : alone(lane, displacements);
      status_[lane] = worse(status_[lane], status);
      set_lane(sample.qdd, lane, Vector<N, Scalar>(trackers_[lane].acceleration()));
    }
  }

 private:
  using Loop = ClosedLoop<Arm, Scheme, Space>;

  /// Replaces one lane of the references by the references that its tracker corrects.
  void correct(TickReferences<Space, In>& references, std::size_t lane) const noexcept {
    for (Reference<Space, In>& all : references.stages) {
      const Reference<Space, Scalar> own = trackers_[lane].corrected(of_lane(all, lane));
      set_lane(all.x, lane, own.x);
      set_lane(all.xd, lane, own.xd);
      set_lane(all.xdd, lane, own.xdd);
    }
  }

  /// Desired motion of a tick (Tracker::advance()). Before the call, `loop` has the tips at the start of the tick. Sets
  /// u to this motion. Returns the lanes in which the motion is finite.
  [[nodiscard]] Mask<In> desired_motion(Loop& loop, const TickReferences<Space, In>& references,
                                        Vector<N, In>& u) noexcept {
    TickState<Scheme::kLevel, Space, N, In> state{
        {In(references.dt)}, loop.state, loop.state.qd, loop.state.qd, reference_change_};
    reference_change_ = references.change();
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      set_lane(state.last, lane, Vector<N, Scalar>(trackers_[lane].acceleration()));
      set_lane(state.change, lane, Vector<N, Scalar>(trackers_[lane].acceleration_change()));
    }
    if (failed(loop.resolve(state.update_middle(loop, references, gains_of<In>(scheme_))))) return Mask<In>(false);
    u = loop.motion();
    const In zero = u.sum() * In(0);  // Inf and NaN make the sum NaN.
    return zero == In(0);
  }

  /// Ends the tick of a tracker. u: desired motion.
  [[nodiscard]] Status finish(std::size_t lane, const Reference<Space, In>& now, const TickReferences<Space, In>& all,
                              const Vector<N, In>& u) noexcept {
    TickReferences<Space, Scalar> references{{}, all.dt};
    for (std::size_t i = 0; i < all.stages.size(); ++i) references.stages[i] = of_lane(all.stages[i], lane);
    return trackers_[lane].finish(of_lane(now, lane), references, lane_of(u, lane));
  }

  /// Computes the whole tick of a tracker.
  [[nodiscard]] Status alone(std::size_t lane, const TickReferences<Space, Scalar>& displacements) noexcept {
    return trackers_[lane].advance(displacements.template from<Scalar>(lane_of(start_, lane))).status;
  }

  [[nodiscard]] static Reference<Space, Scalar> of_lane(const Reference<Space, In>& all, std::size_t lane) noexcept {
    return {lane_of(all.x, lane), lane_of(all.xd, lane), lane_of(all.xdd, lane)};
  }

  Arm arm_;
  Scheme scheme_;
  std::vector<Tracker> trackers_;
  typename Space::template Point<In> start_;
  Vector<Space::kRows, In> reference_change_ = filled<Vector<Space::kRows, In>>(Space::kRows);
  std::array<Status, kLanes> status_;
};

/// track() of a batch along a path, one tick of each motion for each time of the grid.
///
/// `record(const Sample&)` is called once per tick, in lanes, and must be noexcept. If `record` returns false, all
/// motions end. The step of the grid must be the tick of the trackers. Returns the number of ticks. The statuses are in
/// batch.status().
template <typename Batch, typename Path, typename Recorder>
int track_batch(Batch& batch, const Path& path, const TimeGrid<typename Batch::Scalar>& grid,
                Recorder&& record) noexcept {
  using Space = typename Path::Space;
  using Scalar = typename Batch::Scalar;
  PathFollower<Path> follower(path, Space::template origin<Scalar>());
  Sample<Space, Batch::N, typename Batch::In> sample;
  const Scalar dt = grid.dt();
  for (int k = 0; k < grid.samples(); ++k) {
    sample.index = k;
    sample.t = grid.time(k);
    const auto ahead = [&follower](Scalar seconds) noexcept { return follower.ahead(seconds); };
    batch.tick(TickReferences<Space, Scalar>::of(ahead, dt), sample);
    follower.advance(dt);
    if (!show(record, sample)) return k + 1;
  }
  return grid.samples();
}

}  // namespace fpbm
