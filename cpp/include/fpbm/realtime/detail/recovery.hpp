#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "fpbm/core/types.hpp"
#include "fpbm/limits/limits.hpp"
#include "fpbm/model/detail/continuous_joints.hpp"
#include "fpbm/realtime/detail/posture_memory.hpp"

namespace fpbm {

/// Moves a stalled arm to a posture from which its target is reachable (docs/recovery.md, Unreachable targets).
///
/// An arm that followed its target out of the workspace and back may stop away from a reachable target: in a singular
/// posture with Jᵀe = 0, or with joints at the ends of their ranges. Feedback of the tip cannot leave a local minimum
/// of the error. Therefore the arm remembers up to kPostures postures in which it executed the whole task, with tips as
/// far apart as possible. A stalled arm recovers if a remembered tip is nearer to the target than the arm's own tip, or
/// if the target has returned toward a remembered tip. In a recovery, the joints move to the remembered posture in a
/// straight line. Then the scheme continues.
///
/// The tip of each recovery must be nearer to the target than the tip of the previous recovery, by a step of progress.
/// If the target has returned, the condition on the tip does not apply to one recovery. Therefore, a constant target
/// causes at most kPostures + 1 recoveries. If an arm with an unreachable target has stalled nearer to the target than
/// every remembered tip, the target causes no recovery.
template <typename Space, int N, typename Scalar = double>
class Recovery : public PostureMemory<Space, N, Scalar> {
 public:
  using PostureMemory<Space, N, Scalar>::kPostures;
  using JointVector = Vector<N, Scalar>;
  using Point = typename Space::template Point<Scalar>;
  using Distance = TaskDistance<Space, Scalar>;

  /// patience: time without progress toward the posture after which a recovery ends [s]. dt: length of a tick [s].
  /// continuous: bits of the continuous joints.
  Recovery(const JointVector& q, Scalar patience, Scalar dt, JointBits continuous = 0) noexcept
      : patience_(patience), dt_(dt), continuous_(continuous), goal_(q) {}

  /// Whether the joints are moving to a remembered posture.
  [[nodiscard]] bool active() const noexcept { return active_; }

  /// Call after a tick that does not execute the whole task. Updates the largest distance of the target from the
  /// remembered tips.
  void follow(const Point& target, Scalar length) noexcept {
    farthest_ = std::max(farthest_, this->nearest(target, length).distance);
  }
  /// Call after a tick that executes the whole task.
  void settle() noexcept { farthest_ = Scalar(0); }

  /// Starts a recovery to the remembered posture whose tip is nearest to the target, and returns true, in two cases.
  /// (1) The remembered tip is nearer to the target than the arm's own tip and the tip of the last recovery. (2) The
  /// target has returned, and its return has not caused a recovery yet. Otherwise, returns false. error: distance of
  /// the arm's own tip from the target.
  [[gnu::cold, gnu::noinline]] bool begin(const JointVector& q, const Point& target, Scalar error,
                                          Scalar length) noexcept {
    if (count_of_target_ > kPostures) return false;
    const auto [distance, best] = this->nearest(target, length);
    const Scalar bound = std::min(error, last_distance_);
    const bool nearer = distance < bound - Distance::step(bound);
    if (!nearer && (returned_ || !(distance < kReturned * farthest_))) return false;
    returned_ = returned_ || !nearer;
    start(q, nearest_turns(this->posture(best), q, continuous_), distance, kArrived);
    return true;
  }

  /// Starts a recovery to a posture near the posture q, if the tip of the posture is nearer to the target than the
  /// arm's own tip and the tip of the last recovery. The recovery ends halfway, where the feedback of the tip can
  /// continue. distance, error: distances of the tip of the posture, and of the arm's own tip, from the target.
  void leave(const JointVector& q, const JointVector& posture, Scalar distance, Scalar error) noexcept {
    const Scalar bound = std::min(error, last_distance_);
    if (count_of_target_ > kPostures || !(distance < bound - std::min(Distance::kProgress, kApproach * bound))) return;
    start(q, posture, distance, kHalfway);
  }
  /// Whether the joints are moving to the posture of leave().
  [[nodiscard]] bool leaving() const noexcept { return active_ && arrived_ == kHalfway; }

  /// Call after a tick of the recovery. Returns true if the arm has arrived. The recovery also ends if there is no
  /// progress for the time `patience`.
  bool advance(const JointVector& q) noexcept {
    const Scalar distance = distance_to(q);
    waited_ = distance < least_distance_ - kArrived * start_distance_ ? Scalar(0) : waited_ + dt_;
    if (waited_ == Scalar(0)) least_distance_ = distance;
    const bool arrived = distance <= arrived_ * start_distance_;
    active_ = !arrived && waited_ <= patience_;
    return arrived;
  }

  /// Call if the target has moved, or for another attempt. Every remembered posture is a candidate again.
  void renew() noexcept {
    active_ = returned_ = false;
    count_of_target_ = 0;
    last_distance_ = std::numeric_limits<Scalar>::infinity();
  }

  /// Joint motion to the posture: velocities v = r (goal − q), or accelerations 4 kRate (v − q̇). The rate r ≤ kRate is
  /// the same for all joints, so the joints move in a straight line. Each joint keeps its bound on velocity, and
  /// decelerates at half of its bound on acceleration: v²/(2|goal − q|) = A/2.
  template <Level kLevel>
  [[nodiscard, gnu::cold, gnu::noinline]] JointVector motion(const Limits<kLevel, N, Scalar>& limits,
                                                             const State<N, Scalar>& state) const noexcept {
    const auto& bounds = limits.bounds();
    const JointVector gap = entrywise(goal_, [&](Eigen::Index i) { return goal_(i) - state.q(i); });
    Scalar rate = kRate;
    for (Eigen::Index i = 0; i < gap.size(); ++i) {
      const Scalar distance = std::abs(gap(i));
      if (rate * distance > bounds.velocity(i)) rate = bounds.velocity(i) / distance;
      if (rate * rate * distance > bounds.acceleration(i)) rate = std::sqrt(bounds.acceleration(i) / distance);
    }
    return entrywise(gap, [&](Eigen::Index i) {
      if constexpr (kLevel == Level::kVelocity) return rate * gap(i);
      return Scalar(4) * kRate * (rate * gap(i) - state.qd(i));
    });
  }

 private:
  // The values below are not tuned. `fpbm_tests --gtest_filter='Recovery.brings*'` prints how many arms do not return.
  /// If the distance of the target is below this fraction of its largest distance, the target has returned.
  static constexpr Scalar kReturned = Scalar(0.5);
  /// Rate of the approach [1/s]. Both poles of the acceleration are at −2 kRate.
  static constexpr Scalar kRate = Scalar(2);
  static constexpr Scalar kArrived = Scalar(0.02);  ///< Fraction of the initial distance that counts as arrived.

  /// Fraction of the initial distance at which a recovery to a posture of leave() ends.
  static constexpr Scalar kHalfway = Scalar(0.5);
  /// Relative decrease of the distance for which leave() starts a recovery, as for a damped arm (StallDetector).
  static constexpr Scalar kApproach = Scalar(1) / Scalar(256);

  void start(const JointVector& q, const JointVector& goal, Scalar distance, Scalar arrived) noexcept {
    ++count_of_target_;
    last_distance_ = distance;
    goal_ = goal;
    arrived_ = arrived;
    start_distance_ = least_distance_ = distance_to(q);
    waited_ = Scalar(0);
    active_ = true;
  }

  [[nodiscard]] Scalar distance_to(const JointVector& q) const noexcept {
    return std::sqrt(entrywise(q, [&](Eigen::Index i) { return (goal_(i) - q(i)) * (goal_(i) - q(i)); }).sum());
  }

  Scalar patience_;
  Scalar dt_;
  JointBits continuous_;
  JointVector goal_;
  /// Distance from the target to the tip of the last recovery.
  Scalar last_distance_ = std::numeric_limits<Scalar>::infinity();
  /// Largest distance of the target from the nearest remembered tip since the last settle().
  Scalar farthest_ = Scalar(0);
  int count_of_target_ = 0;            ///< Recoveries since the last renew().
  Scalar arrived_ = kArrived;          ///< Fraction of the initial distance that counts as arrived.
  bool returned_ = false;              ///< Whether the return of the target has caused a recovery.
  Scalar start_distance_ = Scalar(0);  ///< Distance to the posture at the start of the recovery.
  Scalar least_distance_ = Scalar(0);  ///< Smallest distance to the posture during the recovery.
  Scalar waited_ = Scalar(0);          ///< Time without progress [s].
  bool active_ = false;
};

}  // namespace fpbm
