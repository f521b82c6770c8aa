#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "fpbm/model/detail/velocity_envelope.hpp"
#include "fpbm/path/detail/time_optimal_axis.hpp"
#include "fpbm/target/detail/target_bounds.hpp"

namespace fpbm {

/// One axis of a moving target in a tick, relative to its position at the start of the tick.
template <typename Scalar>
struct MovingAxis {
  AxisState<Scalar> start;
  AxisState<Scalar> end;   ///< At the end of the tick.
  AxisState<Scalar> then;  ///< At the time of interest in the tick.
  Scalar jerk;             ///< Bound on the magnitude of the jerk in the tick.
};

/// A tick of an axis that joins a moving target within bounds on position, velocity, acceleration and jerk.
///
/// If the target itself keeps the bounds, the axis moves with the target, and the difference to the target vanishes in
/// minimum time within the parts of the bounds that the motion of the target does not need (TimeOptimalAxis). An axis
/// on the target therefore stays on the target. Otherwise, the axis approaches the target in the frame that moves at
/// the velocity of the target, as if the target had no acceleration. The quickest stop of the axis never leaves the
/// range of the remaining points of the target, and if it is outside of this range, never moves away from the range:
/// the axis does not overshoot, and ends within the range, also after the last point. Toward the ends of a joint, the
/// velocity of the quickest stop is within an envelope.
template <typename Scalar>
struct JoiningAxis {
  using Envelope = VelocityEnvelope<Level::kAcceleration, Scalar>;

  TimeOptimalAxis<Scalar> axis;
  Envelope envelope;    ///< Toward both ends, with stop position 0; delay 0: no envelope.
  Range<Scalar> ends;   ///< Range of the axis, relative to its position, with the round-off error of the position.
  Range<Scalar> range;  ///< Range of the remaining points, relative to the axis.
  Scalar tick;          ///< [s]
  Scalar tolerance;     ///< TimeOptimalAxis::tolerance()

  /// State after `seconds` [s] in the tick. from: at the start of the tick, with position 0. error: displacement to the
  /// target. on_target: set to whether the axis moves exactly with the target.
  [[nodiscard]] AxisState<Scalar> after(Scalar seconds, const AxisState<Scalar>& from, Scalar error,
                                        const MovingAxis<Scalar>& target, bool& on_target) const noexcept {
    const TimeOptimalAxis<Scalar> spare = spare_axis(target);
    const bool may_join = spare.stop.acceleration > Scalar(0) && spare.stop.jerk > Scalar(0) &&
                          std::abs(from.a - target.start.a) <= spare.stop.acceleration;
    const auto joined = [&](Scalar t, const AxisState<Scalar>& moved) noexcept {
      const AxisState<Scalar> left{Scalar(0), from.v - target.start.v, from.a - target.start.a};
      const Scalar v = axis.nearest_velocity(target.start.v);
      const AxisState<Scalar> to = spare.approach(left, error, v, t, tolerance);
      on_target = to.q == error && to.v == Scalar(0) && to.a == Scalar(0);
      return AxisState<Scalar>{to.q + moved.q, to.v + moved.v, to.a + moved.a};
    };
    // Ends of the stop: within the range with its tolerance, or not farther beyond the range than now.
    const Range<Scalar> now = extremes(from);
    const Range<Scalar> most{std::min(std::max(range.low - tolerance, ends.low), now.low),
                             std::max(std::min(range.high + tolerance, ends.high), now.high)};
    const Scalar beyond_now = beyond_envelope(from);
    const auto stays = [&](const AxisState<Scalar>& to) noexcept {
      const Range<Scalar> stop = extremes(to);
      return stop.low >= most.low && stop.high <= most.high && beyond_envelope(to) <= std::max(tolerance, beyond_now);
    };
    if (may_join) {
      const AxisState<Scalar> end = joined(tick, target.end);
      if (keeps_bounds(from, end) && stays(end)) return seconds == tick ? end : joined(seconds, target.then);
    }
    on_target = false;
    const auto chasing = [&](const TimeOptimalAxis<Scalar>& fast, Scalar t) noexcept {
      const Scalar v = fast.nearest_velocity(target.start.v);
      const AxisState<Scalar> to = fast.approach({Scalar(0), from.v - v, from.a}, error, v, t, tolerance);
      return AxisState<Scalar>{to.q + t * v, to.v + v, to.a};
    };
    const AxisState<Scalar> end = chasing(axis, tick);
    if (stays(end)) return seconds == tick ? end : chasing(axis, seconds);
    const Range<Scalar> stop = extremes(end);
    const bool far = stop.high > most.high;
    const bool near = stop.low < most.low;
    if (!(envelope.delay > Scalar(0))) {
      return axis.approach(from, far ? range.high : range.low, Scalar(0), seconds, tolerance);
    }
    // The envelope admits the velocity at the end of the stop everywhere before.
    TimeOptimalAxis<Scalar> slow = axis;
    slow.velocity = std::min({axis.velocity, envelope_at(ends.high - stop.high), envelope_at(stop.low - ends.low)});
    const auto slower = [&](Scalar t) noexcept {
      return far || near ? slow.approach(from, far ? range.high : range.low, Scalar(0), t, tolerance)
                         : chasing(slow, t);
    };
    return stays(slower(tick)) ? slower(seconds) : axis.stop.ahead(from, seconds);
  }

 private:
  /// Extreme positions of the quickest stop: its start, its end and, if the velocity changes its sign before, the point
  /// of zero velocity.
  [[nodiscard]] Range<Scalar> extremes(const AxisState<Scalar>& state) const noexcept {
    const Scalar end = axis.stop.end_position(state);
    Range<Scalar> reached{end, end};
    reached.include(state.q);
    const Scalar a = std::abs(state.a);
    const Scalar root = a * a - Scalar(2) * axis.stop.jerk * std::abs(state.v);
    if (state.v * state.a < Scalar(0) && root > Scalar(0)) {
      reached.include(state.ahead((a - std::sqrt(root)) / axis.stop.jerk, std::copysign(axis.stop.jerk, state.v)).q);
    }
    return reached;
  }

  /// Largest excess of the quickest stop over the envelope, as a displacement (VelocityEnvelope::excess()).
  [[nodiscard]] Scalar beyond_envelope(const AxisState<Scalar>& state) const noexcept {
    if (!(envelope.delay > Scalar(0))) return Scalar(0);
    return std::max(envelope.excess(axis.stop.jerk, {state.q - ends.high, state.v, state.a}),
                    envelope.excess(axis.stop.jerk, {ends.low - state.q, -state.v, -state.a}));
  }
  /// Velocity that the envelope admits at a distance from an end.
  [[nodiscard]] Scalar envelope_at(Scalar distance) const noexcept {
    const Scalar twice = Scalar(2) * std::max(distance, Scalar(0));
    return twice / (envelope.delay + std::sqrt(envelope.delay * envelope.delay + twice * envelope.softness));
  }

  /// Axis with the parts of the bounds that the target does not need in the tick. Between the ends of the tick, the
  /// acceleration of the target exceeds the accelerations at the ends by at most half of the jerk times the tick.
  [[nodiscard]] TimeOptimalAxis<Scalar> spare_axis(const MovingAxis<Scalar>& target) const noexcept {
    const Scalar fastest = std::max(std::abs(target.start.a), std::abs(target.end.a)) + target.jerk * tick / Scalar(2);
    // The sum of both motions has round-off errors, for which 64 epsilon are reserved.
    constexpr Scalar kReserve = Scalar(1) - Scalar(64) * std::numeric_limits<Scalar>::epsilon();
    return {axis.velocity, {kReserve * axis.stop.acceleration - fastest, kReserve * axis.stop.jerk - target.jerk}};
  }

  /// Whether the bounds are kept at the end of the tick, and the velocity in the tick and in a stop after the tick.
  [[nodiscard]] bool keeps_bounds(const AxisState<Scalar>& from, const AxisState<Scalar>& to) const noexcept {
    const Scalar change = to.a * std::abs(to.a) / (Scalar(2) * axis.stop.jerk);
    return std::abs(to.a) <= axis.stop.acceleration && std::abs(to.a - from.a) <= axis.stop.jerk * tick &&
           std::abs(from.v) <= axis.velocity && std::abs(to.v) + tick * std::abs(to.a) <= axis.velocity &&
           std::abs(to.v + change) <= axis.velocity && is_motion(from, to);
  }

  /// Whether the displacement and the change of velocity are those of a motion within the bound on jerk. The rates of a
  /// target with errors may be as large as any number, whose round-off is then larger than the bounds.
  [[nodiscard]] bool is_motion(const AxisState<Scalar>& from, const AxisState<Scalar>& to) const noexcept {
    const Scalar half = tick / Scalar(2);
    const Scalar jump = tick * half * axis.stop.jerk / Scalar(2);
    const Scalar round_off = Scalar(32) * std::numeric_limits<Scalar>::epsilon() * axis.velocity;
    return std::abs(to.v - from.v - half * (to.a + from.a)) <= jump + round_off &&
           std::abs(to.q - half * (to.v + from.v)) <= tick * jump + tolerance;
  }
};

}  // namespace fpbm
