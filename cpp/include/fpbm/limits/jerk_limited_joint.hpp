#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "fpbm/core/level.hpp"
#include "fpbm/core/quickest_stop.hpp"
#include "fpbm/limits/velocity_envelope.hpp"

namespace fpbm {

/// Accelerations of a joint from low to high.
template <typename Scalar>
struct Interval {
  Scalar low;
  Scalar high;
};

/// A joint with a bound J on its jerk, in a loop of ticks of length h.
///
/// Its acceleration u is constant over a tick; its jerk is (u − u₋)/h, with u₋ the tick before. A state (q, q̇, u) is
/// viable where u can be let go, at jerk −J, before q̇ exceeds its bounds or the envelopes of both ends of the range. An
/// envelope of offset c and deceleration d ≤ A can then be followed to rest, since that takes jerks of d²/c ≤ J.
/// Letting go in ticks leaves a little room, since steps of acceleration come at the start of a tick, before the ramps
/// that they stand for; so from a viable state one of the accelerations in reach always leads to a viable state, with
/// no margin. The greatest velocity rises with u, and so does the excess over an envelope: those accelerations are an
/// interval.
///
/// Where no envelope is given, c = 2A²/J: with c = 0 a joint that is pushed against its end would tremble there.
///
/// At velocity level q moves by h q̇ of the tick's end, less than its ramps while it stops; where it still speeds up,
/// the room that is left makes up for that.
template <Level kLevel, typename Scalar>
struct JerkLimitedJoint {
  QuickestStop<Scalar> stop;
  Scalar velocity;                         ///< Bound on q̇ either way.
  VelocityEnvelope<kLevel, Scalar> upper;  ///< Bounds q, and q̇ near its end.
  VelocityEnvelope<kLevel, Scalar> lower;  ///< For −q.
  Scalar tick;                             ///< h [s]

  /// Whether a state within some errors of this one is viable. A velocity may be a difference of positions over a tick.
  [[nodiscard]] bool viable(const AxisState<Scalar>& at, const AxisState<Scalar>& error = {}) const noexcept {
    return far_from_bounds(at) || viable_near_bounds(at, error);
  }

  /// Accelerations within the bounds on acceleration and jerk after another one.
  [[nodiscard]] Interval<Scalar> after(Scalar last) const noexcept {
    const Scalar step = stop.jerk * tick;
    return {std::clamp(last - step, -stop.acceleration, stop.acceleration),
            std::clamp(last + step, -stop.acceleration, stop.acceleration)};
  }
  /// After any other.
  [[nodiscard]] Interval<Scalar> after_any() const noexcept { return {-stop.acceleration, stop.acceleration}; }

  /// Which of some accelerations lead to a viable state; the nearest to them where none does. A joint beyond its range
  /// returns, and comes to rest at its end.
  [[nodiscard]] Interval<Scalar> viable(Interval<Scalar> some, Scalar q, Scalar qd) const noexcept {
    const Scalar high = most(upper, q, qd, some);
    const Scalar low = -most(lower, -q, -qd, {-some.high, -some.low});
    return low <= high ? Interval<Scalar>{low, high} : between(some, q, qd);
  }

  /// Greatest acceleration b from which steps of Jh to zero, h (b + (b − Jh) + (b − 2Jh) + …), change the velocity by
  /// no more than a given amount.
  [[nodiscard]] Scalar change(Scalar amount) const noexcept {
    using std::floor;
    using std::sqrt;
    const Scalar step = stop.jerk * tick;
    const Scalar sum = amount / tick;
    const Scalar steps = floor((sqrt(Scalar(1) + Scalar(8) * sum / step) - Scalar(1)) / Scalar(2));
    return std::min(stop.acceleration, (sum + step * steps * (steps + Scalar(1)) / Scalar(2)) / (steps + Scalar(1)));
  }

  /// Acceleration of the next tick on the quickest way to q̇ = u = 0.
  [[nodiscard]] Scalar brake(Scalar qd, Scalar last) const noexcept {
    const auto [low, high] = after(last);
    const Scalar most = change(std::abs(qd));
    return std::clamp(qd > Scalar(0) ? -most : most, low, high);
  }

 private:
  [[nodiscard, gnu::noinline]] bool viable_near_bounds(const AxisState<Scalar>& at,
                                                       const AxisState<Scalar>& error) const noexcept {
    return keeps(upper, {at.q - error.q, at.v - error.v, at.a - error.a}, error.q / tick) &&
           keeps(lower, {-at.q - error.q, -at.v - error.v, -at.a - error.a}, error.q / tick);
  }

  /// Whether a state is so far from all bounds that it is viable: |q̇| + u²/2J is within the bound on q̇, and a stop from
  /// that velocity ends before both envelopes. Most states are so far. False says nothing.
  [[nodiscard]] bool far_from_bounds(const AxisState<Scalar>& at) const noexcept {
    const Scalar inverse_jerk = Scalar(1) / stop.jerk;
    const Scalar size = std::abs(at.a);
    const Scalar fastest = std::abs(at.v) + size * size * inverse_jerk / Scalar(2);
    const Scalar longest = (stop.acceleration + size) * inverse_jerk;
    const auto room = [&](const VelocityEnvelope<kLevel, Scalar>& envelope, Scalar q) noexcept {
      return q - envelope.rest + most_excess(envelope, fastest, longest) <= Scalar(0);
    };
    return fastest <= velocity && room(upper, at.q) && room(lower, -at.q);
  }

  /// The most that a stop adds to the excess over an envelope [rad] or [m]: v (t + c/d + v/2d) for velocities up to v =
  /// fastest [rad/s], if the excess is greatest within the time t = longest [s].
  [[nodiscard]] static Scalar most_excess(const VelocityEnvelope<kLevel, Scalar>& envelope, Scalar fastest,
                                          Scalar longest) noexcept {
    return fastest * (longest + envelope.delay + fastest * envelope.softness / Scalar(2));
  }

  [[nodiscard]] bool keeps(const VelocityEnvelope<kLevel, Scalar>& envelope, const AxisState<Scalar>& at,
                           Scalar slack) const noexcept {
    const Scalar rises = std::max(at.a, Scalar(0));
    return at.v + rises * rises / (Scalar(2) * stop.jerk) <= velocity + slack &&
           !(envelope.excess(stop.jerk, {at.q - envelope.rest, at.v, at.a}) > Scalar(0));
  }

  /// Largest of some accelerations that keep the bounds of one side; the smallest where none does.
  [[nodiscard]] Scalar most(const VelocityEnvelope<kLevel, Scalar>& envelope, Scalar q, Scalar qd,
                            Interval<Scalar> some, int rounds = 6) const noexcept {
    const Scalar room = velocity - qd;
    const Scalar greatest = std::max(some.high, Scalar(0));
    const Scalar inverse_jerk = Scalar(1) / stop.jerk;
    const Scalar gain = greatest * (tick + greatest * inverse_jerk / Scalar(2));
    // Most joints are far from all bounds. No velocity of a stop exceeds top, and its excess is greatest within
    // longest.
    const Scalar top = std::max(qd + gain, Scalar(0));
    const Scalar longest = tick + (stop.acceleration + greatest) * inverse_jerk;
    if (gain <= room && q - envelope.rest + most_excess(envelope, top, longest) <= Scalar(0)) return some.high;
    const Scalar high = within_velocity(room, some);
    if (!(envelope.rest < std::numeric_limits<Scalar>::infinity())) return high;
    const Scalar from = q - envelope.rest;
    // Enough where the acceleration falls already: a little too much elsewhere.
    const Scalar falling = (envelope.furthest(q, qd, tick) - qd) / tick;
    const auto beyond = [&](Scalar u) noexcept { return this->beyond(envelope, from, qd, u); };
    const Scalar found =
        largest_below_zero(beyond, some.low, from > Scalar(0) ? high : std::clamp(falling, some.low, high), rounds);
    if (found > some.low) return found;
    // None, or the smallest: a joint that round-off brought to its end would leave it with all of its jerk.
    const Scalar halts = std::clamp(-qd / tick, some.low, high);
    return beyond(halts) <= round_off(envelope, q) ? halts : found;
  }

  /// Largest of some accelerations that can be let go before q̇ has risen by room: the root of u h + u²/2J = room, or of
  /// u h = room where u falls. Infinite where the velocity is not bounded.
  [[nodiscard]] Scalar within_velocity(Scalar room, Interval<Scalar> some) const noexcept {
    using std::sqrt;
    const Scalar share = tick / room;
    const Scalar fastest =
        room > Scalar(0) ? Scalar(2) / (share + sqrt(share * share + Scalar(2) / (room * stop.jerk))) : room / tick;
    return std::clamp(fastest, some.low, some.high);
  }

  /// How far a joint that is `from` beyond an end's rest, at velocity qd, goes beyond its envelope after a tick of
  /// acceleration u.
  [[nodiscard]] Scalar beyond(const VelocityEnvelope<kLevel, Scalar>& envelope, Scalar from, Scalar qd,
                              Scalar u) const noexcept {
    const Scalar next = qd + tick * u;
    const Scalar way = tick * (kLevel == Level::kVelocity ? next : qd + tick * u / Scalar(2));
    if (from > Scalar(0)) return stop.rest({from + way, next, u});
    const Scalar most = envelope.excess(stop.jerk, {from + way, next, u});
    // Where the joint turns back within the tick.
    return qd > Scalar(0) && next < Scalar(0) ? std::max(most, from - qd * qd / (Scalar(2) * u)) : most;
  }

  /// viable() where a few rounds leave no acceleration that keeps both ends' envelopes: more rounds find some, except
  /// for round-off. There the bound on velocity goes first, and the envelopes are exceeded alike.
  [[nodiscard, gnu::noinline]] Interval<Scalar> between(Interval<Scalar> some, Scalar q, Scalar qd) const noexcept {
    constexpr int kRounds = 20;
    const Interval<Scalar> mirrored{-some.high, -some.low};
    const Scalar high = most(upper, q, qd, some, kRounds);
    const Scalar low = -most(lower, -q, -qd, mirrored, kRounds);
    if (low <= high) return {low, high};
    const Scalar fastest = within_velocity(velocity - qd, some);
    const Scalar slowest = -within_velocity(velocity + qd, mirrored);
    if (!(slowest <= fastest)) return {(slowest + fastest) / Scalar(2), (slowest + fastest) / Scalar(2)};
    const Scalar slack = std::max(round_off(upper, q), round_off(lower, -q));
    const auto conflict = [&](Scalar u) noexcept {
      const Scalar above = beyond(upper, q - upper.rest, qd, u);
      const Scalar below = beyond(lower, -q - lower.rest, -qd, -u);
      return std::max(above, below) <= slack ? Scalar(0) : above - below;
    };
    const Scalar u =
        largest_below_zero(conflict, std::clamp(high, slowest, fastest), std::clamp(low, slowest, fastest), kRounds);
    return {u, u};
  }

  /// Round-off of a distance to one end.
  [[nodiscard]] static Scalar round_off(const VelocityEnvelope<kLevel, Scalar>& envelope, Scalar q) noexcept {
    return std::isfinite(envelope.rest)
               ? Scalar(8) * std::numeric_limits<Scalar>::epsilon() * (std::abs(q) + std::abs(envelope.rest))
               : Scalar(0);
  }
};

}  // namespace fpbm
