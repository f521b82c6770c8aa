#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "fpbm/core/lane_access.hpp"
#include "fpbm/core/validation.hpp"
#include "fpbm/realtime/path_follower.hpp"
#include "fpbm/realtime/tracker.hpp"
#include "fpbm/sim/motion.hpp"
#include "fpbm/sim/rollout.hpp"
#include "fpbm/sim/time_grid.hpp"

namespace fpbm {

/// Trackers of one arm side by side, one a lane, which follow one path, each from its own tip.
///
/// The evaluations of a tick's step are made in lanes; each tracker ends its tick by itself. So limits are kept
/// exactly, and every motion is the one that its tracker makes alone, to round-off. A lane whose step is not finite,
/// near a singular posture or where the scheme fails, leaves the tick to its tracker. No lane feels another.
template <typename Tracker, typename Arm, typename Space, typename Scheme>
class TrackerBatch {
 public:
  using In = typename Arm::Scalar;
  using Scalar = Number<In>;
  static constexpr int N = Arm::kDof;
  static constexpr std::size_t kLanes = In::size();
  /// References at a tick's start, middle and end, as displacements from where each tip started.
  using Way = std::array<Reference<Space, Scalar>, 3>;

  /// arm, scheme: those of the trackers, damping included, in lanes. trackers: one a lane, their tips where the path
  /// starts. Throws std::invalid_argument where there are too many or too few.
  TrackerBatch(const Arm& arm, Space, const Scheme& scheme, const std::vector<Tracker>& trackers)
      : arm_(arm), scheme_(scheme), trackers_(trackers) {
    validation::require_size("trackers", static_cast<Eigen::Index>(trackers.size()), kLanes);
    for (std::size_t lane = 0; lane < kLanes; ++lane) set_lane(start_, lane, trackers[lane].tip());
    status_.fill(Status::kOk);
  }

  [[nodiscard]] const std::vector<Tracker>& trackers() const noexcept { return trackers_; }
  /// The worst of each tracker's ticks.
  [[nodiscard]] const std::array<Status, kLanes>& status() const noexcept { return status_; }

  /// One tick of each. Writes a sample's state, tip, reference, error, J and mean acceleration.
  void tick(const Way& way, Sample<Space, N, In>& sample) noexcept {
    sample.q = from_lanes<In>([this](auto lane) -> auto& { return trackers_[lane].state().q; });
    sample.qd = from_lanes<In>([this](auto lane) -> auto& { return trackers_[lane].state().qd; });
    Loop loop{arm_, scheme_, {}, {sample.q, sample.qd}, sample.q};
    X x(sample.q.size(), Loop::kSecondOrder ? 2 : 1);
    x.col(0) = sample.q;
    if constexpr (Loop::kSecondOrder) x.col(1) = sample.qd;
    loop.update(x);
    sample.tip = loop.kinematics.tip;
    sample.J = loop.kinematics.J;
    sample.reference = from_start(way[0]);
    sample.error = Space::template difference<In>(sample.reference.x, sample.tip);
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      trackers_[lane].begin(lane_of(sample.error, lane), In(loop.kinematics.length)[lane]);
    }
    const std::array<Target, 3> targets{corrected(sample.reference), corrected(from_start(way[1])),
                                        corrected(from_start(way[2]))};
    X dx = x;
    const Mask<In> stepped = step(loop, targets, x, dx);
    const Vector<N, In> field = dx.col(0);
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      Tracker& tracker = trackers_[lane];
      const auto tick = stepped[lane]
                            ? tracker.finish(of_lane(sample.reference, lane), lane_of(x, lane), lane_of(field, lane))
                            : tracker.advance(AtStages{way, lane_of(start_, lane), tracker.dt()});
      status_[lane] = worse(status_[lane], tick.status);
    }
    sample.qdd = from_lanes<In>([this](auto lane) -> auto& { return trackers_[lane].acceleration(); });
  }

 private:
  using Target = Reference<Space, In>;
  using Loop = ClosedLoop<Arm, Scheme, Space>;
  using X = typename Loop::X;

  /// The references of one lane in RK4's stages.
  struct AtStages {
    const Way& way;
    typename Space::template Point<Scalar> start;
    Scalar dt;

    [[nodiscard]] Reference<Space, Scalar> operator()(Scalar seconds) const noexcept {
      Reference<Space, Scalar> reference = way[seconds == Scalar(0) ? 0 : seconds < dt ? 1 : 2];
      reference.x = Space::template compose<Scalar>(start, reference.x);
      return reference;
    }
  };

  [[nodiscard]] Target from_start(const Reference<Space, Scalar>& displacement) const noexcept {
    Target reference = displacement.template cast<In>();
    reference.x = Space::template compose<In>(start_, reference.x);
    return reference;
  }

  [[nodiscard]] static Reference<Space, Scalar> of_lane(const Target& reference, std::size_t lane) noexcept {
    return {lane_of(reference.x, lane), lane_of(reference.xd, lane), lane_of(reference.xdd, lane)};
  }

  /// What each tracker makes of a reference.
  [[nodiscard]] Target corrected(Target reference) const noexcept {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const auto& correction = trackers_[lane].correction();
      if (!correction.active()) continue;
      const Reference<Space, Scalar> own = correction(of_lane(reference, lane));
      set_lane(reference.x, lane, own.x);
      set_lane(reference.xd, lane, own.xd);
      set_lane(reference.xdd, lane, own.xdd);
    }
    return reference;
  }

  /// A step of RK4 where loop was updated; dx: dx/dt at its start. Says in which lanes it is finite.
  [[nodiscard]] Mask<In> step(Loop& loop, const std::array<Target, 3>& targets, X& x, X& dx) const noexcept {
    const Scalar dt = trackers_[0].dt();
    const auto derivative = [&](Scalar seconds, const X& stage_x, X& stage_dx) noexcept {
      return loop.evaluate(targets[seconds < dt ? 1 : 2], stage_x, stage_dx);
    };
    Status status = loop.resolve(targets[0], dx);
    if (!failed(status)) status = RK4::step(derivative, Scalar(0), dt, dx, x);
    if (failed(status)) return Mask<In>(false);
    const In zero = x.sum() * In(0);  // Inf and NaN make NaN of it.
    return zero == In(0);
  }

  Arm arm_;
  Scheme scheme_;
  std::vector<Tracker> trackers_;
  typename Space::template Point<In> start_;
  std::array<Status, kLanes> status_;
};

/// track() of a batch along a path: each motion's ticks, one for each time of the grid.
///
/// `record(const Sample&)` is called once per tick, in lanes, noexcept; where it returns a bool, false ends all motions
/// there. The grid's step must be the trackers'. Returns the number of ticks; how each went is in batch.status().
template <typename Batch, typename Path, typename Recorder>
int track_batch(Batch& batch, const Path& path, const TimeGrid<typename Batch::Scalar>& grid,
                Recorder&& record) noexcept {
  using Space = typename Path::Space;
  using Scalar = typename Batch::Scalar;
  PathFollower<Path> follower(path, Space::template origin<Scalar>());
  Sample<Space, Batch::N, typename Batch::In> sample;
  for (int k = 0; k < grid.samples(); ++k) {
    sample.index = k;
    sample.t = grid.time(k);
    batch.tick({follower.ahead(Scalar(0)), follower.ahead(grid.dt() / Scalar(2)), follower.ahead(grid.dt())}, sample);
    follower.advance(grid.dt());
    if (!show(record, sample)) return k + 1;
  }
  return grid.samples();
}

}  // namespace fpbm
