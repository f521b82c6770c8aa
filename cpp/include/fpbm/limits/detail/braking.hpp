#pragma once

#include "fpbm/limits/limits.hpp"

namespace fpbm {

/// Braking motion: all joints reduce their velocities in proportion, as fast as their bounds on acceleration and jerk
/// allow. If the box requires a joint to brake harder, the joint brakes harder. At acceleration level, a joint beyond
/// its range stops beyond its range.
///
/// least: smallest time constant of the stop [s], by default one tick. At the end of the stop, the velocities decay as
/// exp(−t/least).
template <Level kLevel, int N, typename Scalar>
[[nodiscard]] Vector<N, Scalar> brake_in_proportion(const Limits<kLevel, N, Scalar>& limits,
                                                    const State<N, Scalar>& state, const Box<N, Scalar>& box,
                                                    Scalar least) noexcept {
  const Vector<N, Scalar>& most = limits.bounds().acceleration;
  Scalar rate = Scalar(1) / least;
  for (Eigen::Index i = 0; i < state.qd.size(); ++i) {
    const Scalar speed = std::abs(state.qd(i));
    const Scalar fastest = limits.bounds_jerk(i) ? limits.jerk_limited(i).change(speed) : most(i);
    if (rate * speed > fastest) rate = fastest / speed;
  }
  if constexpr (kLevel == Level::kAcceleration) {
    // `halt` is in the box of every viable state. If the box requires a joint beyond its range to return, `halt` is
    // outside the box: the joint stops first, and returns later.
    return entrywise(state.qd, [&](Eigen::Index i) {
      const Scalar halt = std::min(std::max(state.qd(i) / -least, -most(i)), most(i));
      const Scalar lower = std::min(box.lower(i), halt);
      const Scalar upper = std::max(box.upper(i), halt);
      return std::max(std::min(-rate * state.qd(i), upper), lower);
    });
  }
  const Scalar left = Scalar(1) - rate * limits.tick();
  return box.nearest(entrywise(state.qd, [&](Eigen::Index i) { return left * state.qd(i); }));
}
template <Level kLevel, int N, typename Scalar>
[[nodiscard]] Vector<N, Scalar> brake_in_proportion(const Limits<kLevel, N, Scalar>& limits,
                                                    const State<N, Scalar>& state, const Box<N, Scalar>& box) noexcept {
  return brake_in_proportion(limits, state, box, limits.tick());
}

/// Braking motion after a tick with the acceleration `last`: as brake_in_proportion(), but each joint with a bound on
/// jerk follows its own shortest stop.
template <Level kLevel, int N, typename Scalar>
[[nodiscard]] Vector<N, Scalar> brake(const Limits<kLevel, N, Scalar>& limits, const State<N, Scalar>& state,
                                      const Vector<N, Scalar>& last) noexcept {
  const Box<N, Scalar> box = limits.box(state, last);
  const JointLimits<N, Scalar>& bounds = limits.bounds();
  Vector<N, Scalar> u = brake_in_proportion(limits, state, box);
  for (Eigen::Index i = 0; i < u.size(); ++i) {
    if (!limits.bounds_jerk(i)) continue;
    const Scalar quickest = limits.motion(state.qd(i), limits.jerk_limited(i).brake(state.qd(i), last(i)));
    const bool within = bounds.lower(i) <= state.q(i) && state.q(i) <= bounds.upper(i);
    u(i) = within || kLevel == Level::kVelocity ? std::clamp(quickest, box.lower(i), box.upper(i)) : quickest;
  }
  return u;
}

/// Acceleration of the next tick in the shortest stop of joint i alone, after a tick with the accelerations `last`.
template <Level kLevel, int N, typename Scalar>
[[nodiscard]] Scalar brake_alone(const Limits<kLevel, N, Scalar>& limits, Eigen::Index i, const State<N, Scalar>& state,
                                 const Vector<N, Scalar>& last) noexcept {
  const Scalar most = limits.bounds().acceleration(i);
  if (!limits.bounds_jerk(i)) return std::clamp(-state.qd(i) / limits.tick(), -most, most);
  const auto joint = limits.jerk_limited(i);
  const bool within = limits.bounds().lower(i) <= state.q(i) && state.q(i) <= limits.bounds().upper(i);
  if (!within) return joint.brake(state.qd(i), last(i));  // A joint beyond its range stops there.
  const auto [low, high] = joint.viable(joint.after(last(i)), state.q(i), state.qd(i));
  return std::clamp(joint.brake(state.qd(i), last(i)), low, high);
}

/// Bounds on the displacement in the shortest stop of joint i alone [rad] or [m], from the velocity qd and the
/// acceleration `last`. after_ramp: velocity after a ramp in which the acceleration decreases to zero.
template <Level kLevel, int N, typename Scalar>
[[nodiscard]] Interval<Scalar> displacement_alone(const Limits<kLevel, N, Scalar>& limits, Eigen::Index i, Scalar qd,
                                                  Scalar last, Scalar after_ramp) noexcept {
  const Scalar h = limits.tick();
  const Scalar most = limits.bounds().acceleration(i);
  if (!limits.bounds_jerk(i)) {
    const Scalar distance = std::abs(qd) * (std::abs(qd) / most + h) / Scalar(2);
    return qd > Scalar(0) ? Interval<Scalar>{Scalar(0), distance} : Interval<Scalar>{-distance, Scalar(0)};
  }
  // Upper bound: the velocity never exceeds `top`. The joint moves at `top` until the acceleration is zero, and then
  // makes the shortest stop from `top`.
  const Scalar jerk = limits.bounds().jerk(i);
  const Scalar ramp = std::abs(last) / jerk;
  const Scalar top = std::abs(qd) + std::abs(last) * ramp / Scalar(2);
  const Scalar distance = top * (ramp + Scalar(2) * h) + QuickestStop<Scalar>{most, jerk}.stopping_distance(top);
  const bool forth = qd > Scalar(0) && after_ramp >= Scalar(0);
  const bool back = qd < Scalar(0) && after_ramp <= Scalar(0);
  return {forth ? Scalar(0) : -distance, back ? Scalar(0) : distance};
}

/// Accelerations of a tick with unknown joint states: the acceleration `last`, reduced toward zero as fast as the
/// bounds on jerk allow.
template <Level kLevel, int N, typename Scalar>
[[nodiscard]] Vector<N, Scalar> fade(const Limits<kLevel, N, Scalar>& limits, const Vector<N, Scalar>& last) noexcept {
  const Vector<N, Scalar>& jerk = limits.bounds().jerk;
  return entrywise(last, [&](Eigen::Index i) {
    const Scalar step = limits.tick() * jerk(i);
    return last(i) - std::max(std::min(last(i), step), -step);
  });
}

}  // namespace fpbm
