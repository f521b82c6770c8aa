#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "fpbm/core/detail/validation.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/realtime/detail/shape_watch.hpp"
#include "fpbm/realtime/detail/task_distance.hpp"

namespace fpbm {

/// Detects an arm that makes no progress toward its target (docs/recovery.md, Unreachable targets).
///
/// Progress is a decrease of the smallest error by more than a step, or a displacement of the target by more than 0.002
/// (TaskDistance). The arm has stalled if there is no progress for stall_time. The arm continues if its target or a
/// shape near it moves.
///
/// If limits slow the arm, or its target is far, a step is 0.002, and errors below 0.002 do not count. If the arm also
/// crawls, with every joint below 1 % of its velocity bound, a step is at least 1/16 of the smallest error. If the arm
/// is only damped, it may approach its target slowly: a step is 1/64 of the smallest error, at most 0.002, and errors
/// below 0.0001 do not count.
template <typename Space, typename Scalar = double>
class StallDetector {
 public:
  using Point = typename Space::template Point<Scalar>;

  /// stall_time: [s], infinite if the arm never stalls. Throws std::invalid_argument if stall_time is not positive.
  StallDetector(Scalar stall_time, Scalar dt) : stall_time_(stall_time), dt_(dt) {
    if (!(stall_time > Scalar(0))) {
      validation::fail("stall_time", stall_time, "positive, or infinite");
    }
  }

  [[nodiscard]] bool stalled() const noexcept { return waited_ > stall_time_; }

  /// Whether the last tick made no progress.
  [[nodiscard]] bool waits() const noexcept { return waited_ > Scalar(0); }

  /// Whether the target has moved since the last progress.
  [[nodiscard]] bool has_moved(const Point& target, Scalar length) const noexcept {
    return Distance::between(target, target_, length) > Distance::kProgress;
  }

  /// Call after a tick that does not execute the whole task. error: distance to the target. length: the arm's
  /// characteristic length [m]. damped: the arm is neither slowed nor far from its target. crawls: every joint has a
  /// velocity bound, and moves at less than 1 % of this bound.
  void update(const Point& target, Scalar error, Scalar length, bool damped, bool crawls) noexcept {
    Scalar step = Distance::kProgress;
    if (damped) step = std::min(step, least_ * kApproach);
    if (!damped && crawls && std::isfinite(least_)) step = std::max(step, least_ * kCrawlStep);
    const Scalar small = damped ? kSmall : Distance::kProgress;
    if (error < small || error < least_ - step || has_moved(target, length)) {
      target_ = target;
      least_ = error;
      waited_ = Scalar(0);
    } else {
      waited_ += dt_;
    }
  }

  /// Call in each tick of a stalled arm. Returns true if shapes near the arm have moved since the arm stopped, so that
  /// the arm should try again. distance_sum: Bounds::near_distance_sum() [m].
  [[nodiscard]] bool wait(bool at_rest, Scalar distance_sum, Scalar length) noexcept {
    return shapes_.moved(at_rest, distance_sum, Distance::kProgress * length);
  }

  /// Restarts the detection, for another attempt.
  void reset() noexcept {
    shapes_.reset();
    least_ = std::numeric_limits<Scalar>::infinity();
    waited_ = Scalar(0);
  }

 private:
  using Distance = TaskDistance<Space, Scalar>;

  /// 0.1 mm for an arm of 1 m. Stall.is_not_a_slow_approach passes with 1e-5 to 1e-3.
  static constexpr Scalar kSmall = Scalar(1e-4);
  /// Relative decrease of the error in stall_time that is progress for a damped arm. An arm whose target is exactly at
  /// the workspace boundary still makes this progress after a minute: Stall.is_not_a_slow_approach passes with 0 to
  /// 1/32, and fails with 1/16.
  static constexpr Scalar kApproach = Scalar(1) / Scalar(64);

  /// Relative decrease of the error in stall_time that is progress for a crawling arm. At constant speed, the arm then
  /// arrives within 16 stall times. Recovery.a_blocked_arm_stops_crawling passes with 1/64 to 1/4, and fails with 0.
  static constexpr Scalar kCrawlStep = Scalar(1) / Scalar(16);

  Scalar stall_time_;
  Scalar dt_;
  Scalar waited_ = Scalar(0);                               ///< Time without progress [s].
  Scalar least_ = std::numeric_limits<Scalar>::infinity();  ///< Smallest error so far.
  ShapeWatch<Scalar> shapes_;
  Point target_ = Space::template origin<Scalar>();
};

}  // namespace fpbm
