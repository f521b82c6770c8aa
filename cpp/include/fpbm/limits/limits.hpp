#pragma once

#include <algorithm>
#include <cmath>

#include "fpbm/core/detail/validation.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/limits/detail/box.hpp"
#include "fpbm/limits/detail/jerk_limited_joint.hpp"
#include "fpbm/limits/detail/state_check.hpp"
#include "fpbm/model/detail/usable_bounds.hpp"
#include "fpbm/model/detail/velocity_envelope.hpp"
#include "fpbm/model/joint.hpp"

namespace fpbm {

/// Bounds on positions, velocities, accelerations and jerks, for every tick (docs/limits.md, Position, velocity and
/// acceleration).
///
/// A state is viable if the velocity of every joint is within its bound and within the braking envelopes of both ends
/// of the range. From a viable state, some acceleration within its bound, constant for one tick of length h, leads to a
/// viable state, and every joint can stop (viability: Del Prete 2018, here in discrete time). The envelope of a bound A
/// on acceleration has the offset A h/2, because of the discretisation.
///
/// box() is the set of accelerations that lead to a viable state, or the set of velocities at velocity level. A motion
/// in the box never violates a bound, at ticks or between ticks. Joints with a bound on jerk have another viable set
/// (JerkLimitedJoint), which includes the acceleration of the last tick. The acceleration of the last tick is the
/// argument `last`, zero for an arm at rest.
template <Level kLevel, int N, typename Scalar = double>
class Limits {
 public:
  using JointVector = Vector<N, Scalar>;

  /// tick: h [s]. A joint with bounds needs a bound on its acceleration. At velocity level, the bound on acceleration
  /// may be missing: the joint may then change its velocity by any amount within a tick. Throws std::invalid_argument,
  /// with the joint and the value, if a bound is missing or invalid.
  Limits(const JointLimits<N, Scalar>& bounds, Scalar tick) : tick_(tick), bounds_(bounds.complete()) {
    validation::require_positive("dt", tick);
    const Eigen::Index n = bounds.lower.size();
    validation::require_size("limits.upper", bounds.upper.size(), n);
    validation::require_size("limits.velocity", bounds.velocity.size(), n);
    validation::require_size("limits.acceleration", bounds.acceleration.size(), n);
    validation::require_size("limits.jerk", bounds_.jerk.size(), n);
    validation::require_size("limits.velocity_offset", bounds_.velocity_offset.size(), n);
    validation::require_size("limits.deceleration", bounds_.deceleration.size(), n);
    upper_.resize(n);
    lower_.resize(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const JointBounds<Scalar> joint = usable_bounds<kLevel>(i, bounds_.joint(i), tick);
      bounds_.set(i, joint);
      const bool enveloped = std::isfinite(joint.deceleration);
      const Scalar least =
          bounds_jerk(i) ? JointBounds<Scalar>::kOffset * joint.acceleration / joint.jerk : tick / Scalar(2);
      const Scalar delay = enveloped ? joint.velocity_offset / joint.deceleration : least;
      const Scalar deceleration = enveloped ? joint.deceleration : joint.acceleration;
      upper_.set(i, joint.upper, delay, deceleration);
      lower_.set(i, -joint.lower, delay, deceleration);
      if (bounds_jerk(i)) ++jerk_bounds_;
    }
  }

  /// The bounds in use, the result of usable_bounds().
  [[nodiscard]] const JointLimits<N, Scalar>& bounds() const noexcept { return bounds_; }
  [[nodiscard]] Scalar tick() const noexcept { return tick_; }
  /// Whether any joint, or joint i, has a bound on jerk.
  [[nodiscard]] bool bounds_jerk() const noexcept { return jerk_bounds_ > 0; }
  [[nodiscard]] bool bounds_jerk(Eigen::Index i) const noexcept { return std::isfinite(bounds_.jerk(i)); }
  [[nodiscard]] JerkLimitedJoint<kLevel, Scalar> jerk_limited(Eigen::Index i) const noexcept {
    return {{bounds_.acceleration(i), bounds_.jerk(i)}, bounds_.velocity(i), upper_[i], lower_[i], tick_};
  }

  /// Whether the state is viable up to round-off.
  [[nodiscard, gnu::cold, gnu::noinline]] bool is_viable(const State<N, Scalar>& state,
                                                         const JointVector& last) const noexcept {
    return Check{*this, state, last}.is_viable();
  }

  /// Throws std::invalid_argument if an acceleration exceeds its bound.
  void require_accelerations(const State<N, Scalar>& state, const JointVector& last) const {
    Check{*this, state, last}.require_accelerations();
  }

  /// Throws std::invalid_argument if the state is not viable up to round-off. A tracker's own state is always viable,
  /// except if the start of the tracker was not (TrackerOptions::recover_start).
  void require_viable(const State<N, Scalar>& state) const { require_viable(state, at_rest(state)); }
  void require_viable(const State<N, Scalar>& state, const JointVector& last) const {
    Check{*this, state, last}.require_viable();
  }

  /// Whether the limits admit a tick from one state to another at constant acceleration.
  [[nodiscard]] bool admits(const State<N, Scalar>& from, const State<N, Scalar>& to) const noexcept {
    return admits(from, to, at_rest(from));
  }
  [[nodiscard]] bool admits(const State<N, Scalar>& from, const State<N, Scalar>& to,
                            const JointVector& last) const noexcept {
    bool good = true;
    for (Eigen::Index i = 0; i < to.q.size(); ++i) {
      const Scalar u = (to.qd(i) - from.qd(i)) / tick_;
      if (bounds_jerk(i)) {
        const auto joint = jerk_limited(i);
        const auto [low, high] = joint.after(last(i));
        good = good && low <= u && u <= high && joint.viable({to.q(i), to.qd(i), u});
      } else {
        good = good && -bounds_.acceleration(i) <= u && u <= bounds_.acceleration(i) && allows(i, to.q(i), to.qd(i));
      }
    }
    return good;
  }

  /// Whether a state of joint i is viable if its jerk is unbounded.
  [[nodiscard]] bool allows(Eigen::Index i, Scalar q, Scalar qd) const noexcept {
    return std::abs(qd) <= bounds_.velocity(i) && upper_[i].allows(q, qd) && lower_[i].allows(-q, -qd);
  }
  /// Whether the envelopes of joint i admit the whole stop from the velocity qd at a constant deceleration.
  [[nodiscard]] bool allows_stop(Eigen::Index i, Scalar q, Scalar qd, Scalar deceleration) const noexcept {
    return upper_[i].allows_stop(q, qd, deceleration) && lower_[i].allows_stop(-q, -qd, deceleration);
  }

  /// Motions that the limits admit for each joint in the next tick. If the state is not viable, for example a measured
  /// state, the box leads back to viable states. The bound on acceleration then has the first priority, and the bound
  /// on velocity the second. A joint beyond its range returns as fast as the bounds on acceleration and velocity allow,
  /// and can stop at the end of its range.
  [[nodiscard]] Box<N, Scalar> box(const State<N, Scalar>& state) const noexcept { return box(state, at_rest(state)); }
  [[nodiscard]] Box<N, Scalar> box(const State<N, Scalar>& state, const JointVector& last) const noexcept {
    return box_of(state, [&](Eigen::Index i, const auto& joint) { return joint.after(last(i)); });
  }
  /// box() without regard to the last tick: the bound on jerk restricts only the following ticks.
  [[nodiscard]] Box<N, Scalar> box_in_time(const State<N, Scalar>& state) const noexcept {
    return box_of(state, [](Eigen::Index, const auto& joint) { return joint.after_any(); });
  }

  /// Motion of a joint in a tick with the given acceleration: the acceleration, or the velocity at the end of the tick
  /// at velocity level.
  [[nodiscard]] Scalar motion(Scalar qd, Scalar acceleration) const noexcept {
    return kLevel == Level::kVelocity ? qd + tick_ * acceleration : acceleration;
  }

 private:
  using Envelopes = VelocityEnvelopes<kLevel, N, Scalar>;
  using Check = StateCheck<Limits, N, Scalar>;

  template <typename Accelerations>
  [[nodiscard]] Box<N, Scalar> box_of(const State<N, Scalar>& state, Accelerations&& accelerations) const noexcept {
    Box<N, Scalar> box{state.q, state.q};
    // This loop includes joints with a bound on jerk, so that the compiler vectorises the loop. The next loop replaces
    // the box of joints with a bound on jerk.
    if (jerk_bounds_ < state.q.size()) {
      for (Eigen::Index i = 0; i < state.q.size(); ++i) set(box, i, motions_of(i, state.q(i), state.qd(i)));
    }
    for (Eigen::Index i = 0; jerk_bounds_ > 0 && i < state.q.size(); ++i) {
      if (!bounds_jerk(i)) continue;
      const auto joint = jerk_limited(i);
      const auto [low, high] = joint.viable(accelerations(i, joint), state.q(i), state.qd(i));
      set(box, i, {motion(state.qd(i), low), motion(state.qd(i), high)});
    }
    return box;
  }

  static void set(Box<N, Scalar>& box, Eigen::Index i, const Interval<Scalar>& motions) noexcept {
    box.lower(i) = motions.low;
    box.upper(i) = motions.high;
  }

  /// Motions of joint i at velocity w if its jerk is unbounded (docs/tick.md, Position, velocity and acceleration).
  [[nodiscard]] Interval<Scalar> motions_of(Eigen::Index i, Scalar q, Scalar w) const noexcept {
    const Scalar v = bounds_.velocity(i);
    const Scalar most = w + bounds_.acceleration(i) * tick_;
    const Scalar least = w - bounds_.acceleration(i) * tick_;
    const Scalar fastest = std::clamp(v, least, most);
    const Scalar slowest = std::clamp(-v, least, most);
    // With this order of arguments, min and max ignore NaN, the result of largest_velocity() if the range has no end.
    Scalar up = std::max(slowest, std::min(fastest, upper_[i].largest_velocity(q, w, tick_)));
    Scalar down = std::min(fastest, std::max(slowest, -lower_[i].largest_velocity(-q, -w, tick_)));
    if (down > up) down = up = (down + up) / Scalar(2);
    if constexpr (kLevel == Level::kAcceleration) {
      up = std::clamp((up - w) / tick_, -bounds_.acceleration(i), bounds_.acceleration(i));
      down = std::clamp((down - w) / tick_, -bounds_.acceleration(i), bounds_.acceleration(i));
    }
    return {down, up};
  }

  [[nodiscard]] static JointVector at_rest(const State<N, Scalar>& state) noexcept {
    return filled<JointVector>(state.q.size());
  }

  Scalar tick_;
  JointLimits<N, Scalar> bounds_;
  Envelopes upper_;
  Envelopes lower_;               ///< For −q.
  Eigen::Index jerk_bounds_ = 0;  ///< Number of joints with a bound on jerk.
};

}  // namespace fpbm
