#pragma once

#include "fpbm/core/status.hpp"
#include "fpbm/realtime/detail/recovery.hpp"
#include "fpbm/realtime/detail/saddle_exit.hpp"
#include "fpbm/realtime/detail/stall_detector.hpp"
#include "fpbm/realtime/tick.hpp"

namespace fpbm {

/// Progress of an arm toward its target: whether the arm has stalled, and whether a recovery is active.
template <typename Space, int N, typename Scalar = double>
class Progress {
 public:
  using JointVector = Vector<N, Scalar>;
  using Point = typename Space::template Point<Scalar>;
  using Distance = TaskDistance<Space, Scalar>;
  using Result = Tick<Space, N, Scalar>;

  /// q0: start posture. continuous: bits of the continuous joints. Throws std::invalid_argument if the stall time is
  /// not positive.
  Progress(const TrackerOptions<Scalar>& options, const JointVector& q0, JointBits continuous)
      : stall_(options.stall_time, options.dt),
        recovery_(q0, options.stall_time, options.dt, continuous),
        dt_(options.dt),
        recovers_(options.recovery) {}

  /// Stores the start posture and its tip as the first posture of a recovery. length: the arm's characteristic length
  /// [m].
  void begin_at(const JointVector& q0, const Point& tip, Scalar length) noexcept {
    recovery_.remember(q0, tip, length);
  }

  [[nodiscard]] bool stalled() const noexcept { return stall_.stalled(); }
  [[nodiscard]] bool recovering() const noexcept { return recovery_.active(); }
  [[nodiscard]] const Recovery<Space, N, Scalar>& recovery() const noexcept { return recovery_; }

  /// Resets the detection of a stall, as if the target were new.
  void try_again() noexcept {
    stall_.reset();
    recovery_.renew();
  }

  /// Call before a tick of an arm with shapes near it. distance_sum: Bounds::near_distance_sum() [m]. If the shapes
  /// have moved, a stalled arm tries again.
  void watch_shapes(bool at_rest, Scalar distance_sum, Scalar length) noexcept {
    if (stall_.stalled() && stall_.wait(at_rest, distance_sum, length)) try_again();
  }

  /// Call after a tick of a recovery. q: posture after the tick.
  void recovered(const JointVector& q, const Point& target, Scalar length) noexcept {
    if (!recovery_.leaving() && stall_.has_moved(target, length)) return try_again();
    if (recovery_.advance(q)) stall_.reset();
  }

  /// Call after a tick that did not execute the whole task. q: posture after the tick. velocity: bounds on the joint
  /// velocities [rad/s]. far: whether the target is beyond the error bound. damped: whether the scheme damped the
  /// desired motion. Returns whether the arm makes no progress in a nearly singular posture, so that the caller should
  /// call leave().
  [[nodiscard, gnu::noinline]] bool missed(const JointVector& q, const JointVector& velocity, const Point& target,
                                           const Result& result, Scalar length, bool far, bool damped) noexcept {
    const Scalar error = Distance::norm(result.error, length);
    bool crawls = true;
    bool rests = true;
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      const Scalar bound = velocity.coeff(i);
      const Scalar speed = std::abs(result.qd.coeff(i));
      crawls = crawls && std::isfinite(bound) && speed < kCrawl * bound;
      rests = rests && speed < kCrawl * std::min(bound, Scalar(1));
    }
    if (stall_.has_moved(target, length)) recovery_.renew();
    stall_.update(target, error, length, result.scale == Scalar(1) && !far, crawls);
    recovery_.follow(target, length);
    if (recovers_ && result.status == Status::kStalled && stall_.stalled()) recovery_.begin(q, target, error, length);
    if (!damped || !recovers_ || !(error > kSmall) || result.status == Status::kStalled) {
      waited_ = Scalar(0);
      return false;
    }
    waited_ = rests || stall_.waits() ? waited_ + dt_ : Scalar(0);
    if (waited_ < (rests ? kPatience : kMovingPatience)) return false;
    waited_ = Scalar(0);
    return true;
  }

  /// Leads the arm to a posture from which the feedback of the tip can continue (SaddleExit). error: distance of the
  /// arm's own tip from the target.
  void leave(const JointVector& q, const SaddleExit<N, Scalar>& exit, Scalar error) noexcept {
    recovery_.leave(q, exit.q, exit.distance, error);
  }

  /// Call after a tick that executed the whole task. q: posture at the start of the tick.
  void done(const JointVector& q, const Point& target, const Result& result, Scalar length) noexcept {
    recovery_.settle();
    if (!recovers_ || !recovery_.is_new(q)) return;
    if (Distance::norm(result.error, length) < Distance::kProgress) recovery_.remember(q, target, length);
  }

 private:
  /// Fraction of its velocity bound below which a joint crawls. If an arm approaches its target within small velocity
  /// bounds, a joint is near its bound. The arm of Recovery.a_blocked_arm_stops_crawling moves at 0.2 % of its bounds;
  /// the test passes with 0.001 to 0.1.
  static constexpr Scalar kCrawl = Scalar(0.01);

  /// Time at rest, and time without progress in motion, after which an arm leaves a singular posture [s].
  static constexpr Scalar kPatience = Scalar(0.1);
  static constexpr Scalar kMovingPatience = Scalar(0.5);
  /// Error below which an arm does not leave a singular posture. With 1e-4, arms that slowly approach targets at the
  /// ends of their ranges start recoveries (Recovery.is_ended_by_stop_and_by_invalid_targets fails).
  static constexpr Scalar kSmall = Distance::kProgress;

  StallDetector<Space, Scalar> stall_;
  Recovery<Space, N, Scalar> recovery_;
  Scalar dt_;
  Scalar waited_ = Scalar(0);  ///< Time at rest or without progress in a nearly singular posture [s].
  bool recovers_;
};

}  // namespace fpbm
