#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "fpbm/core/detail/validation.hpp"
#include "fpbm/limits/limiter.hpp"

namespace fpbm {

/// Largest age of a measured state [ticks]. The tests cover ages up to 30
/// (MeasuredLimiter.no_bound_is_exceeded_at_any_age). With 100, H is 410 ticks.
inline constexpr int kMaxMeasuredDelay = 100;

/// Throws std::invalid_argument if delay [ticks] is not in [0, kMaxMeasuredDelay].
inline void require_measured_delay(int delay) {
  if (delay < 0 || delay > kMaxMeasuredDelay) {
    validation::fail("measured_delay", delay, "a number of ticks from 0 to ", kMaxMeasuredDelay,
                     ": give the largest age of the measured states, divided by dt");
  }
}

/// Joint limits of an arm whose measured state is up to d ticks old (docs/tick.md, Delay of measured states). The
/// age may be unknown and may vary.
///
/// Uses the bounds on velocity and the braking envelopes of Limits with a longer tick H. Toward each bound, the gain of
/// the feedback on the measured velocity is β ≤ g/h, where g = dᵈ/(d+1)ᵈ⁺¹ is the largest gain for which
/// q̇ₖ₊₁ = q̇ₖ − g q̇ₖ₋d decays without oscillation. With the offset from offset(), the arm approaches the envelopes
/// without overshoot. docs/tick.md derives H and the offset, and docs/measured.md has the stability margins.
///
/// A bound J on jerk limits the change from one command to the next. If H ≥ A/J, the accelerations that keep the other
/// bounds never need a larger jerk (for the envelopes, a measured result).
///
/// If d = 0, the state is exact, and Limits apply unchanged.
template <int N, typename Scalar = double>
class MeasuredLimiter {
 public:
  static constexpr Level kLevel = Level::kAcceleration;
  using JointVector = Vector<N, Scalar>;
  using JointState = State<N, Scalar>;
  using MotionLimits = Limits<kLevel, N, Scalar>;

  /// Throws std::invalid_argument if the delay d is not in [0, kMaxMeasuredDelay].
  MeasuredLimiter(const MotionLimits& limits, int delay)
      : delayed_(delay > 0),
        limiter_(delayed_ ? slower(limits, horizon(limits, delay)) : limits),
        unit_(limits.bounds().acceleration),
        step_(limits.bounds().jerk),
        filter_(std::min(Scalar(2) * limits.tick() / (kRest * limiter_.limits().tick()), Scalar(1))),
        bounds_jerk_(delayed_ && limits.bounds_jerk()) {
    require_measured_delay(delay);
    for (Eigen::Index i = 0; i < step_.size(); ++i) step_(i) *= limits.tick();
    for (Eigen::Index i = 0; i < unit_.size(); ++i) {
      if (!std::isfinite(unit_(i))) unit_(i) = Scalar(1);
    }
  }

  /// Limits for measured states: with the tick H, or the given limits if d = 0.
  [[nodiscard]] const MotionLimits& limits() const noexcept { return limiter_.limits(); }

  /// As Limiter::motion().
  template <typename Tasks, int P>
  [[nodiscard]] auto motion(const Tasks& tasks, const JointState& state, const JointVector& desired,
                            const JointVector& last, const Rows<N, P, Scalar>& rows) const noexcept {
    const auto found = limiter_.motion(tasks, state, desired, last, rows);
    if (!bounds_jerk_) return found;
    const Box<N, Scalar> box = within_jerk(limits().box(state), last);
    if (box.contains(found.u) && rows.admit(found.u)) return found;
    auto saturation = saturation_of(tasks, unit_, rows);
    return toward_goal(saturation, box, rows, box.nearest(last), found.u, found.u, found);
  }

  /// As Limiter::brake(). At the end of the stop, the velocities decay as exp(−t/D), D = kRest H. A low-pass filter
  /// with the time constant D/2 reduces noise. Large changes of the command are not filtered.
  [[nodiscard]] SaturatedMotion<N, Scalar> brake(const JointState& state, const JointVector& last) const noexcept {
    if (!delayed_) return limiter_.brake(state, last);
    const Scalar D = kRest * limits().tick();
    const JointVector& most = limits().bounds().acceleration;
    const Box<N, Scalar> box = limits().box(state);
    const JointVector u = brake_in_proportion(limits(), state, box, D);
    // The box is widened to admit braking at the rate 1/D, which keeps the envelopes.
    Box<N, Scalar> wider = box;
    for (Eigen::Index i = 0; i < u.size(); ++i) {
      const Scalar halt = std::clamp(-state.qd(i) / D, -most(i), most(i));
      wider.lower(i) = std::min(wider.lower(i), halt);
      wider.upper(i) = std::max(wider.upper(i), halt);
    }
    JointVector smooth = u;
    for (Eigen::Index i = 0; i < u.size(); ++i) {
      const Scalar change = u(i) - last(i);
      const Scalar fraction = std::min(std::abs(change) / (kLarge * most(i)), Scalar(1));
      smooth(i) = last(i) + std::max(filter_, fraction * fraction) * change;
      if (std::abs(smooth(i)) < kZero) smooth(i) = Scalar(0);  // Denormal numbers are slow.
    }
    smooth = wider.nearest(smooth);
    return {within_jerk({smooth, smooth}, last).lower, Scalar(0), 0, 0};
  }

 private:
  /// H (docs/tick.md, Delay of measured states, The tick H). The gain of the velocity feedback is
  /// β = (T + H)/(H (T + H/2)), at most 1.172/H.
  [[nodiscard]] static Scalar horizon(const MotionLimits& limits, int delay) {
    const auto d = static_cast<Scalar>(delay);
    const Scalar gain = std::pow(d / (d + Scalar(1)), d) / (d + Scalar(1));  // g
    Scalar longest = std::max(kMargin * limits.tick() / gain, kQuiet);
    for (Eigen::Index i = 0; i < limits.bounds().jerk.size(); ++i) {
      if (limits.bounds_jerk(i)) longest = std::max(longest, limits.bounds().acceleration(i) / limits.bounds().jerk(i));
    }
    return longest;
  }

  /// T, offset divided by deceleration of the envelopes of Limits with the tick H. With T = D + H²/2(D − H), the arm
  /// keeps the envelopes of offset D (docs/tick.md, Delay of measured states, Envelopes).
  [[nodiscard]] static Scalar offset(Scalar D, Scalar H) noexcept { return D + H * H / (Scalar(2) * (D - H)); }

  /// Limits with the tick H that keep the envelopes of the given limits, but have no bounds on jerk.
  [[nodiscard]] static MotionLimits slower(const MotionLimits& limits, Scalar H) {
    JointLimits<N, Scalar> bounds = limits.bounds();
    for (Eigen::Index i = 0; i < bounds.lower.size(); ++i) {
      JointBounds<Scalar> joint = bounds.joint(i);
      joint.jerk = JointBounds<Scalar>::kNone;
      const Scalar range = joint.upper - joint.lower;
      const Scalar end = std::min(kEnd, kLeast * range);
      Scalar D = kRest * H;
      if (std::isfinite(joint.deceleration)) D = std::max(D, joint.velocity_offset / joint.deceleration);
      const Scalar T = offset(D, H);
      // With d = 16 range/T², the term q̇²/2d of the envelope is at most range/32, since T q̇ ≤ range. A larger d would
      // hardly change the envelope.
      const Scalar d = std::min({joint.deceleration, joint.acceleration, Scalar(16) * range / (T * T)});
      joint.velocity_offset = std::isfinite(d) ? T * d : Scalar(0);
      joint.deceleration = d;
      // At the bound on position that is passed to Limits, the envelope is −velocity_offset. At the end of the range,
      // the envelope must be zero.
      const Scalar extension = std::isfinite(d) ? T * T * d / Scalar(2) : Scalar(0);
      joint.upper += extension - end;
      joint.lower -= extension - end;
      bounds.set(i, joint);
    }
    return {bounds, H};
  }

  /// The box, clipped to the accelerations that the bound on jerk admits after `last`.
  [[nodiscard]] Box<N, Scalar> within_jerk(const Box<N, Scalar>& box, const JointVector& last) const noexcept {
    if (!bounds_jerk_) return box;
    const auto clipped = [&](const JointVector& u) {
      return entrywise(u, [&](Eigen::Index i) {
        return std::min(std::max(u.coeff(i), last.coeff(i) - step_.coeff(i)), last.coeff(i) + step_.coeff(i));
      });
    };
    return {clipped(box.lower), clipped(box.upper)};
  }

  /// H g/h: 1.172, the smallest possible value (horizon()), times 1.28, a margin for accelerations that exceed the
  /// commanded accelerations.
  static constexpr Scalar kMargin = Scalar(1.5);
  /// Smallest H [s]. Noise of ±0.001 rad/s on q̇ then causes accelerations of at most 0.5 % of 5 rad/s² after stop()
  /// (MeasuredDelay.every_preset_stops).
  static constexpr Scalar kQuiet = Scalar(0.014);
  /// Changes of the braking acceleration above this fraction of its bound are not filtered: 50 times the noise of 0.5 %
  /// (kQuiet).
  static constexpr Scalar kLarge = Scalar(0.25);
  /// Smallest D/H: 1 + 1/√2, which minimises T.
  static constexpr Scalar kRest = Scalar(1.70710678118654752440);
  /// Distance from the end of an envelope to the end of the range: twice the step of a coarse encoder of 1e-4 rad, but
  /// at most the fraction kLeast of the range.
  static constexpr Scalar kEnd = Scalar(2e-4);
  static constexpr Scalar kLeast = Scalar(1e-3);

  static constexpr Scalar kZero = std::numeric_limits<Scalar>::min() / std::numeric_limits<Scalar>::epsilon();

  bool delayed_;
  Limiter<kLevel, N, Scalar> limiter_;
  JointVector unit_;  ///< Unit of each joint's null-space motion.
  JointVector step_;  ///< Largest change of the acceleration in a tick.
  Scalar filter_;     ///< Fraction of a small change of the braking acceleration that is applied in a tick.
  bool bounds_jerk_;
};

/// Replaces MeasuredLimiter for schemes that return velocities.
struct NoMeasuredLimiter {
  template <typename MotionLimits>
  NoMeasuredLimiter(const MotionLimits&, int delay) {
    require_measured_delay(delay);
  }
};

}  // namespace fpbm
