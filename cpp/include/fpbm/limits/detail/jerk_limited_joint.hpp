#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "fpbm/core/detail/quickest_stop.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/limits/detail/box.hpp"
#include "fpbm/model/detail/velocity_envelope.hpp"

namespace fpbm {

/// A joint with a bound J on jerk, in a loop of ticks of length h (docs/tick.md, Bounds on jerk).
///
/// The acceleration u is constant during a tick. The jerk is (u − u₋)/h, where u₋ is the acceleration of the previous
/// tick. A state (q, q̇, u) is viable toward the upper end if the velocity bound and the envelope hold while the
/// acceleration decreases at the jerk −J. For the lower end, the same condition applies to −q. From a viable state, the
/// joint can follow an envelope of offset c and deceleration d ≤ A until rest, since following the envelope needs jerks
/// of at most d²/c ≤ J.
///
/// The piecewise-constant acceleration leads the continuous ramp. Therefore, after a viable state, at least one
/// admissible acceleration leads to a viable state, and no margin is needed. The largest velocity and the largest
/// excess over an envelope increase with u. Therefore, the accelerations that lead to a viable state are an interval.
///
/// If no envelope is given, c = 2A²/J. With c = 0, a joint that is pushed against its end would chatter.
///
/// At velocity level, q changes by h q̇, where q̇ is the velocity at the end of the tick. While the joint stops, this
/// displacement is smaller than with continuous ramps. While the speed still increases, the slack of the
/// piecewise-constant acceleration compensates for the larger displacement.
template <Level kLevel, typename Scalar>
struct JerkLimitedJoint {
  using Envelope = VelocityEnvelope<kLevel, Scalar>;

  QuickestStop<Scalar> stop;
  Scalar velocity;  ///< Bound on |q̇|.
  Envelope upper;   ///< Bounds q, and q̇ near the upper end.
  Envelope lower;   ///< For −q.
  Scalar tick;      ///< h [s]

  /// Whether some state that differs from `at` by at most `error` is viable. Velocities may be differences of positions
  /// over a tick.
  [[nodiscard]] bool viable(const AxisState<Scalar>& at, const AxisState<Scalar>& error = {}) const noexcept {
    return is_far_from_bounds(at) || is_viable_near_bounds(at, error);
  }

  /// Accelerations within the bounds on acceleration and jerk in the tick after the acceleration `last`.
  [[nodiscard]] Interval<Scalar> after(Scalar last) const noexcept {
    const Scalar step = stop.jerk * tick;
    return {std::clamp(last - step, -stop.acceleration, stop.acceleration),
            std::clamp(last + step, -stop.acceleration, stop.acceleration)};
  }
  /// Accelerations within the bound on acceleration, for every last acceleration.
  [[nodiscard]] Interval<Scalar> after_any() const noexcept { return {-stop.acceleration, stop.acceleration}; }

  /// Accelerations in the interval `some` that lead to a viable state. If no acceleration leads to a viable state,
  /// returns the acceleration after which the state is nearest to a viable state. A joint beyond its range returns, and
  /// stops at its end.
  [[nodiscard]] Interval<Scalar> viable(Interval<Scalar> some, Scalar q, Scalar qd) const noexcept {
    const Scalar high = largest_viable(upper, q, qd, some);
    const Scalar low = -largest_viable(lower, -q, -qd, {-some.high, -some.low});
    return low <= high ? Interval<Scalar>{low, high} : least_excess(some, q, qd);
  }

  /// Largest acceleration b whose decrease to zero by steps of Jh changes the velocity by at most `amount`:
  /// h (b + (b − Jh) + (b − 2Jh) + …) ≤ amount.
  [[nodiscard]] Scalar change(Scalar amount) const noexcept {
    const Scalar step = stop.jerk * tick;
    const Scalar sum = amount / tick;
    const Scalar steps = std::floor((std::sqrt(Scalar(1) + Scalar(8) * sum / step) - Scalar(1)) / Scalar(2));
    return std::min(stop.acceleration, (sum + step * steps * (steps + Scalar(1)) / Scalar(2)) / (steps + Scalar(1)));
  }

  /// Acceleration of the next tick of the shortest stop, at whose end q̇ = u = 0.
  [[nodiscard]] Scalar brake(Scalar qd, Scalar last) const noexcept {
    const auto [low, high] = after(last);
    const Scalar most = change(std::abs(qd));
    return std::clamp(qd > Scalar(0) ? -most : most, low, high);
  }

 private:
  [[nodiscard, gnu::noinline]] bool is_viable_near_bounds(const AxisState<Scalar>& at,
                                                          const AxisState<Scalar>& error) const noexcept {
    return is_viable_toward(upper, {at.q - error.q, at.v - error.v, at.a - error.a}, error.q / tick) &&
           is_viable_toward(lower, {-at.q - error.q, -at.v - error.v, -at.a - error.a}, error.q / tick);
  }

  /// Sufficient condition for a viable state, far from all bounds: |q̇| + u²/2J is within the bound on q̇, and a stop
  /// from this velocity ends before both envelopes. Most states satisfy the sufficient condition. If the result is
  /// false, the state may still be viable.
  [[nodiscard]] bool is_far_from_bounds(const AxisState<Scalar>& at) const noexcept {
    const Scalar inverse_jerk = Scalar(1) / stop.jerk;
    const Scalar size = std::abs(at.a);
    const Scalar fastest = std::abs(at.v) + size * size * inverse_jerk / Scalar(2);
    const Scalar longest = (stop.acceleration + size) * inverse_jerk;
    const auto stops_before = [&](const Envelope& envelope, Scalar q) noexcept {
      return q - envelope.stop_position + envelope.excess_bound(fastest, longest) <= Scalar(0);
    };
    return fastest <= velocity && stops_before(upper, at.q) && stops_before(lower, -at.q);
  }

  /// Whether a state satisfies the two conditions of docs/tick.md, Bounds on jerk, toward one end: w + a²/2J ≤ v for
  /// a > 0, up to `slack` [rad/s], and G ≤ 0 (VelocityEnvelope::excess()). w is the velocity of the state, a its
  /// acceleration, and v the bound on the velocity.
  [[nodiscard]] bool is_viable_toward(const Envelope& envelope, const AxisState<Scalar>& at,
                                      Scalar slack) const noexcept {
    const Scalar rises = std::max(at.a, Scalar(0));
    return at.v + rises * rises / (Scalar(2) * stop.jerk) <= velocity + slack &&
           !(envelope.excess(stop.jerk, {at.q - envelope.stop_position, at.v, at.a}) > Scalar(0));
  }

  /// Iterations of the search for G = 0. The iterates approach the solution from below. In 1,562 random states near the
  /// envelope (J/A from 20 to 500 /s, ticks of 1 and 10 ms), the result is at most 3e-6 Jh below the solution (4
  /// iterations: 4e-4 Jh, 10 iterations: round-off).
  static constexpr int kRounds = 6;
  static constexpr int kExactRounds = 20;  ///< Twice the iterations after which the error is round-off.

  /// Largest acceleration in the interval `some` after which the state is viable toward one end (is_viable_toward()). q
  /// and qd increase toward this end. rounds: largest number of iterations of the search for G = 0.
  ///
  /// If no acceleration leads to a viable state, returns some.low. Exception: a joint that would exceed the envelope
  /// only by round-off stops within the tick, at the acceleration −q̇/h.
  [[nodiscard]] Scalar largest_viable(const Envelope& envelope, Scalar q, Scalar qd, Interval<Scalar> some,
                                      int rounds = kRounds) const noexcept {
    const Scalar speed_slack = velocity - qd;
    const Scalar greatest = std::max(some.high, Scalar(0));
    const Scalar inverse_jerk = Scalar(1) / stop.jerk;
    const Scalar gain = greatest * (tick + greatest * inverse_jerk / Scalar(2));
    // Most joints are far from all bounds, and pass this test of some.high: no velocity of the stop exceeds `top`, and
    // the excess has its maximum within the time `longest`.
    const Scalar top = std::max(qd + gain, Scalar(0));
    const Scalar longest = tick + (stop.acceleration + greatest) * inverse_jerk;
    if (gain <= speed_slack && q - envelope.stop_position + envelope.excess_bound(top, longest) <= Scalar(0)) {
      return some.high;
    }
    const Scalar high = within_velocity(speed_slack, some);
    if (!(envelope.stop_position < std::numeric_limits<Scalar>::infinity())) return high;
    const Scalar from = q - envelope.stop_position;
    // Upper end of the search: the acceleration that the envelope admits without a bound on jerk. If the joint already
    // brakes along the envelope, this acceleration is the solution. Otherwise, the acceleration is slightly too large.
    const Scalar falling = (envelope.largest_velocity(q, qd, tick) - qd) / tick;
    const auto excess = [&](Scalar u) noexcept { return this->excess_after(envelope, from, qd, u); };
    const Scalar found =
        largest_below_zero(excess, some.low, from > Scalar(0) ? high : std::clamp(falling, some.low, high), rounds);
    if (found > some.low) return found;
    // No acceleration above some.low keeps the envelope. If the excess is only round-off error, the joint stops at its
    // end: with some.low, the joint would leave its end at full jerk.
    const Scalar halts = std::clamp(-qd / tick, some.low, high);
    return excess(halts) <= envelope.round_off(q) ? halts : found;
  }

  /// Largest acceleration u in the interval `some` with which q̇ increases by at most `speed_slack` [rad/s], in the
  /// tick and in the following reduction of u to zero at the jerk −J. u is the positive root of u h + u²/2J =
  /// speed_slack, or speed_slack/h if `speed_slack` is negative. If the velocity is unbounded, returns some.high.
  [[nodiscard]] Scalar within_velocity(Scalar speed_slack, Interval<Scalar> some) const noexcept {
    const Scalar ratio = tick / speed_slack;
    const Scalar fastest = speed_slack > Scalar(0)
                               ? Scalar(2) / (ratio + std::sqrt(ratio * ratio + Scalar(2) / (speed_slack * stop.jerk)))
                               : speed_slack / tick;
    return std::clamp(fastest, some.low, some.high);
  }

  /// Largest excess over an envelope [rad] or [m] after a tick with the acceleration u. from: q − r at the start of
  /// the tick. If from > 0, the joint is beyond its end, and the result is the position at the end of the shortest
  /// stop, relative to the stop position.
  [[nodiscard]] Scalar excess_after(const Envelope& envelope, Scalar from, Scalar qd, Scalar u) const noexcept {
    const Scalar next = qd + tick * u;
    const Scalar displacement = tick * (kLevel == Level::kVelocity ? next : qd + tick * u / Scalar(2));
    if (from > Scalar(0)) return stop.end_position({from + displacement, next, u});
    const Scalar excess = envelope.excess(stop.jerk, {from + displacement, next, u});
    // The joint reverses within the tick, at from − qd²/2u.
    return qd > Scalar(0) && next < Scalar(0) ? std::max(excess, from - qd * qd / (Scalar(2) * u)) : excess;
  }

  /// Result of viable() if few iterations find no acceleration that keeps the envelopes of both ends. After
  /// more iterations, only round-off errors can prevent a result. In the result, the bound on velocity has priority,
  /// and both envelopes are exceeded equally.
  [[nodiscard, gnu::noinline]] Interval<Scalar> least_excess(Interval<Scalar> some, Scalar q,
                                                             Scalar qd) const noexcept {
    const Interval<Scalar> mirrored{-some.high, -some.low};
    const Scalar high = largest_viable(upper, q, qd, some, kExactRounds);
    const Scalar low = -largest_viable(lower, -q, -qd, mirrored, kExactRounds);
    if (low <= high) return {low, high};
    const Scalar fastest = within_velocity(velocity - qd, some);
    const Scalar slowest = -within_velocity(velocity + qd, mirrored);
    if (!(slowest <= fastest)) return {(slowest + fastest) / Scalar(2), (slowest + fastest) / Scalar(2)};
    const Scalar slack = std::max(upper.round_off(q), lower.round_off(-q));
    const auto conflict = [&](Scalar u) noexcept {
      const Scalar above = excess_after(upper, q - upper.stop_position, qd, u);
      const Scalar below = excess_after(lower, -q - lower.stop_position, -qd, -u);
      return std::max(above, below) <= slack ? Scalar(0) : above - below;
    };
    const Scalar u = largest_below_zero(conflict, std::clamp(high, slowest, fastest), std::clamp(low, slowest, fastest),
                                        kExactRounds);
    return {u, u};
  }
};

}  // namespace fpbm
