#pragma once

#include "fpbm/core/status.hpp"
#include "fpbm/realtime/recovery.hpp"
#include "fpbm/realtime/stall_detector.hpp"
#include "fpbm/realtime/tick.hpp"

namespace fpbm {

/// Progress of an arm toward its target, from tick to tick: whether the arm has stalled, and whether it recovers.
template <typename Space, int N, typename Scalar = double>
class Progress {
 public:
  using JointVector = Vector<N, Scalar>;
  using Point = typename Space::template Point<Scalar>;
  using Distance = TaskDistance<Space, Scalar>;
  using Result = Tick<Space, N, Scalar>;

  /// q0: start posture. Throws std::invalid_argument unless the stall time is positive.
  Progress(const TrackerOptions<Scalar>& options, const JointVector& q0)
      : stall_(options.stall_time, options.dt),
        recovery_(q0, options.stall_time, options.dt),
        recovers_(options.recovery) {}

  /// The start posture and its tip: the first posture to recover to. length: the arm's characteristic length [m].
  void begin_at(const JointVector& q0, const Point& tip, Scalar length) noexcept {
    recovery_.remember(q0, tip, length);
  }

  [[nodiscard]] bool stalled() const noexcept { return stall_.stalled(); }
  [[nodiscard]] bool recovering() const noexcept { return recovery_.active(); }
  [[nodiscard]] const Recovery<Space, N, Scalar>& recovery() const noexcept { return recovery_; }

  /// The arm is to try again, as if its target were new.
  void try_again() noexcept {
    stall_.reset();
    recovery_.renew();
  }

  /// Call before a tick of an arm with shapes near it. room: a measure of their distances [m]. An arm that has stalled
  /// tries again when they have moved.
  void watch_shapes(bool at_rest, Scalar room, Scalar length) noexcept {
    if (stall_.stalled() && stall_.wait(at_rest, room, length)) try_again();
  }

  /// After a tick of a recovery, which led to q.
  void recovered(const JointVector& q, const Point& target, Scalar length) noexcept {
    if (stall_.has_moved(target, length)) return try_again();
    if (recovery_.advance(q)) stall_.reset();
  }

  /// After a tick that did not do the whole task and led to q. velocity: bounds of the joints' velocities [rad/s]. far:
  /// the target is beyond the error bound.
  [[gnu::noinline]] void missed(const JointVector& q, const JointVector& velocity, const Point& target,
                                const Result& result, Scalar length, bool far) noexcept {
    const Scalar error = Distance::norm(result.error, length);
    bool crawls = true;
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      const Scalar bound = velocity.coeff(i);
      crawls = crawls && std::isfinite(bound) && std::abs(result.qd.coeff(i)) < kCrawl * bound;
    }
    if (stall_.has_moved(target, length)) recovery_.renew();
    stall_.update(target, error, length, result.scale == Scalar(1) && !far, crawls);
    recovery_.follow(target, length);
    if (recovers_ && result.status == Status::kStalled && stall_.stalled()) recovery_.begin(q, target, error, length);
  }

  /// After a tick that did the whole task and began at q.
  void done(const JointVector& q, const Point& target, const Result& result, Scalar length) noexcept {
    recovery_.settle();
    if (!recovers_ || !recovery_.is_new(q)) return;
    if (Distance::norm(result.error, length) < Distance::kProgress) recovery_.remember(q, target, length);
  }

 private:
  /// Share of its velocity bound below which a joint crawls. An arm that approaches its target within tight velocity
  /// bounds has a joint near its bound. The arm of Recovery.a_blocked_arm_stops_crawling moves at 0.2 % of its bounds.
  static constexpr Scalar kCrawl = Scalar(0.01);

  StallDetector<Space, Scalar> stall_;
  Recovery<Space, N, Scalar> recovery_;
  bool recovers_;
};

}  // namespace fpbm
