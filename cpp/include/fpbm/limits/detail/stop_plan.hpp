#pragma once

#include <algorithm>
#include <cmath>

#include "fpbm/core/detail/quickest_stop.hpp"
#include "fpbm/limits/detail/braking.hpp"
#include "fpbm/limits/detail/stop_displacement.hpp"
#include "fpbm/limits/detail/stop_part.hpp"
#include "fpbm/limits/detail/stop_profile.hpp"
#include "fpbm/limits/limits.hpp"

namespace fpbm {

/// Stopping trajectory from a viable state, known in closed form until rest (docs/clearance_proof.md, Stopping
/// trajectory).
///
/// In the first phase, the ramp, all joints reduce their accelerations to zero. In the second phase, all joints brake
/// in proportion, with the profile of the slowest joint. The path in joint space stays close to the straight line along
/// the present velocity. A joint that would violate its bounds follows its own shortest stop. All states of the
/// trajectory are viable.
template <Level kLevel, int N, typename Scalar = double>
class StopPlan {
 public:
  using JointVector = Vector<N, Scalar>;
  using MotionLimits = Limits<kLevel, N, Scalar>;

  /// Plan of an arm at rest.
  explicit StopPlan(Eigen::Index dof) : last_(filled<JointVector>(dof)), velocity_(last_) {}

  /// Plan from a viable state after a tick with the acceleration `last`. fraction: of the bounds on deceleration, for
  /// the joints that brake in proportion.
  StopPlan(const MotionLimits& limits, const State<N, Scalar>& state, const JointVector& last,
           Scalar fraction = Scalar(1)) noexcept
      : last_(last), velocity_(state.qd), fraction_(fraction) {
    const Scalar h = limits.tick();
    const auto& bounds = limits.bounds();
    for (Eigen::Index i = 0; i < last.size(); ++i) {
      if (limits.bounds_jerk(i)) {
        ramp_ticks_ = std::max(ramp_ticks_, StopProfile<Scalar>::ramp_ticks(std::abs(last(i)), h * bounds.jerk(i)));
      }
    }
    for (Eigen::Index i = 0; i < last.size(); ++i) {
      velocity_(i) += h * ramp_velocity_change() * last(i);
      profile_ = profile_.together(
          StopProfile<Scalar>::quickest(velocity_(i), fraction * bounds.acceleration(i), bounds.jerk(i), h));
    }
    profile_.wait = ramp_ticks_;
    for (Eigen::Index i = 0; i < last.size(); ++i) {
      if (!keeps_bounds(limits, i, state)) stops_alone_ |= joint_bit(i);
    }
  }

  /// Displacement bounds from the state `before` the last tick until rest. start: state after the last tick, at the
  /// start of the plan.
  [[nodiscard]] StopDisplacement<N, Scalar> displacement(const MotionLimits& limits, const State<N, Scalar>& before,
                                                         const State<N, Scalar>& start) const noexcept {
    const Eigen::Index n = last_.size();
    const Scalar h = limits.tick();
    StopDisplacement<N, Scalar> result = StopDisplacement<N, Scalar>::none(n);
    const Scalar ticks = Scalar(1) + profile_.coasting_ticks(kLevel);
    // Deficit of the displacement in the last tick, compared with a tick at the velocity after the ramp, divided by h²
    // last_. At velocity level, the displacement of the last tick is h times the velocity at the end of the tick.
    const Scalar tick_deficit = ramp_velocity_change() + (kLevel == Level::kVelocity ? Scalar(0) : Scalar(0.5));
    for (Eigen::Index i = 0; i < n; ++i) {
      if (!stops_alone(i)) {
        result.line(i) = h * ticks * velocity_(i);
        result.ramp_correction(i) = -h * h * (tick_deficit + ramp_deficit()) * last_(i);
        result.start_velocity(i) = kLevel == Level::kVelocity ? start.qd(i) : before.qd(i);
        continue;
      }
      const auto [low, high] = displacement_alone(limits, i, start.qd(i), last_(i), velocity_(i));
      const Scalar tick = start.q(i) - before.q(i);
      // Within a tick of constant acceleration a, the position leaves the interval between its end points by h²|a|/8 at
      // most.
      const Scalar between = kLevel == Level::kVelocity ? Scalar(0) : h * h / Scalar(8) * std::abs(last_(i));
      result.low(i) = std::min(tick, Scalar(0)) - between + low;
      result.high(i) = std::max(tick, Scalar(0)) + between + high;
    }
    return result;
  }

  /// Accelerations of the next tick of the plan. state: state at the start of the tick. before: accelerations of the
  /// last tick. Advances the plan by one tick.
  [[nodiscard]] JointVector next(const MotionLimits& limits, const State<N, Scalar>& state,
                                 const JointVector& before) noexcept {
    const Scalar h = limits.tick();
    JointVector u(before.size());
    for (Eigen::Index i = 0; i < u.size(); ++i) {
      if (stops_alone(i)) {
        u(i) = brake_alone(limits, i, state, before);
      } else if (k_ < ramp_ticks_) {
        u(i) = last_(i) * (Scalar(1) - (k_ + Scalar(1)) / ramp_ticks_);
      } else if (k_ + Scalar(1) < profile_.ticks()) {
        u(i) = -profile_.removed_fraction(k_) * velocity_(i) / h;
      } else {
        u(i) = -state.qd(i) / h;  // Exactly to rest.
      }
    }
    k_ += Scalar(1);
    return u;
  }

  template <int Joints, typename Number>
  friend void advance(StopPlan<Level::kAcceleration, Joints, Number>& plan,
                      const Limits<Level::kAcceleration, Joints, Number>& limits, Number ticks,
                      StopPart<Joints, Number>& part) noexcept;
  /// Accelerations of the tick before the plan.
  [[nodiscard]] const JointVector& last() const noexcept { return last_; }
  /// Velocities after the ramp, along which the joints brake in proportion [rad/s] or [m/s].
  [[nodiscard]] const JointVector& velocity() const noexcept { return velocity_; }
  /// Whether the accelerations of the next tick are in the ramp.
  [[nodiscard]] bool ramps() const noexcept { return k_ < ramp_ticks_; }
  /// Number of ticks until the full deceleration ends.
  [[nodiscard]] Scalar braking_ticks() const noexcept {
    return std::max(profile_.ticks() - (profile_.ramp - Scalar(1)) - k_, Scalar(0));
  }

  /// Number of ticks at the velocity after the ramp that cover the stopping distance of the plan.
  [[nodiscard]] Scalar coasting_ticks() const noexcept { return profile_.coasting_ticks(kLevel); }

  /// coasting_ticks() without rounding to whole ticks, approximately: a continuous function of the state.
  [[nodiscard]] Scalar smooth_coasting_ticks(const MotionLimits& limits) const noexcept {
    Scalar most(0);
    for (Eigen::Index i = 0; i < velocity_.size(); ++i) {
      const Scalar speed = std::abs(velocity_(i));
      if (!(speed > Scalar(0))) continue;
      const Scalar deceleration = limits.bounds().acceleration(i);
      const Scalar distance = limits.bounds_jerk(i)
                                  ? QuickestStop<Scalar>{deceleration, limits.bounds().jerk(i)}.stopping_distance(speed)
                                  : speed * speed / (Scalar(2) * deceleration);
      most = std::max(most, distance / (limits.tick() * speed));
    }
    return profile_.wait + most;
  }

  /// Change of the velocity due to an acceleration u of the next tick, until u has decreased to zero, divided by h u:
  /// 1 for the tick itself, plus (r − 1)/2 for a ramp of r ticks. r is the largest A/(h J) of all joints, rounded up.
  [[nodiscard]] static Scalar acting_ticks(const MotionLimits& limits) noexcept {
    Scalar most(0);
    for (Eigen::Index i = 0; i < limits.bounds().jerk.size(); ++i) {
      if (!limits.bounds_jerk(i)) continue;
      most = std::max(most, StopProfile<Scalar>::ramp_ticks(limits.bounds().acceleration(i),
                                                            limits.tick() * limits.bounds().jerk(i)));
    }
    return Scalar(1) + std::max(most - Scalar(1), Scalar(0)) / Scalar(2);
  }

  /// Fraction of the bounds on deceleration with which the plan for the next tick is tried first. As a rule, the next
  /// tick needs nearly as slow a stop. With 1.25 instead of 1.05, ticks of a Panda at the edge of its torques are
  /// refused a tenth more often.
  [[nodiscard]] Scalar next_fraction() const noexcept {
    return std::min(fraction_ * (Scalar(21) + k_) / Scalar(20), Scalar(1));
  }

  /// Number of ticks until rest.
  [[nodiscard]] Scalar ticks_left() const noexcept { return std::max(profile_.ticks() - k_, Scalar(0)); }

 private:
  [[nodiscard]] bool stops_alone(Eigen::Index i) const noexcept { return (stops_alone_ >> i & 1U) != 0; }

  /// Change of the velocity in the ramp, in which the acceleration a decreases to zero in r ticks, divided by h a: the
  /// sum of 1 − (k + 1)/r over k < r, which is (r − 1)/2.
  [[nodiscard]] Scalar ramp_velocity_change() const noexcept {
    return std::max(ramp_ticks_ - Scalar(1), Scalar(0)) / Scalar(2);
  }

  /// Deficit of the displacement in the ramp, compared with r ticks at the constant velocity after the ramp, divided by
  /// h² a: (r − 1)(2r − 1)/12, or (r − 1)(r − 2)/6 at velocity level.
  [[nodiscard]] Scalar ramp_deficit() const noexcept {
    const Scalar r = std::max(ramp_ticks_, Scalar(1));
    return kLevel == Level::kVelocity ? std::max((r - Scalar(1)) * (r - Scalar(2)) / Scalar(6), Scalar(0))
                                      : (r - Scalar(1)) * (Scalar(2) * r - Scalar(1)) / Scalar(12);
  }

  /// Whether joint i keeps its bounds in the synchronised stop. Sufficient condition: the joint keeps its bounds if it
  /// coasts at its largest velocity until the full deceleration begins, and then brakes at the full deceleration. The
  /// synchronised stop is neither faster nor longer.
  [[nodiscard]] bool keeps_bounds(const MotionLimits& limits, Eigen::Index i,
                                  const State<N, Scalar>& start) const noexcept {
    const Scalar after_ramp = velocity_(i);
    const Scalar v = start.qd(i) * after_ramp > after_ramp * after_ramp ? start.qd(i) : after_ramp;
    if (!(std::abs(v) <= limits.bounds().velocity(i))) return false;
    const Scalar h = limits.tick();
    const Scalar coasting = h * (ramp_ticks_ + profile_.ramp - Scalar(1));
    const Scalar deceleration = std::abs(after_ramp) / (h * (profile_.brake - profile_.ramp + Scalar(1)));
    return limits.allows_stop(i, start.q(i) + coasting * v, v, deceleration);
  }

  StopProfile<Scalar> profile_;    ///< For the synchronised stop.
  JointVector last_;               ///< Acceleration of the tick before the plan.
  Scalar ramp_ticks_ = Scalar(0);  ///< Length r of the ramp in ticks: 0 if no jerk is bounded.
  JointVector velocity_;           ///< Velocity after the ramp.
  Scalar fraction_ = Scalar(1);    ///< Fraction of the bounds on deceleration.
  JointBits stops_alone_ = 0;      ///< Bit i is set if joint i follows its own shortest stop.
  Scalar k_ = Scalar(0);           ///< Number of completed ticks.
};

}  // namespace fpbm
