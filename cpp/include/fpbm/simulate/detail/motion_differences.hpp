#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "fpbm/core/types.hpp"
#include "fpbm/model/joint.hpp"
#include "fpbm/path/detail/clock_torques.hpp"
#include "fpbm/path/detail/fastest_clock.hpp"
#include "fpbm/path/spline.hpp"

namespace fpbm {

/// Calls f(q, velocity, acceleration, jerk) with the positions of a motion at every dt [s] and their differences, from
/// rest. After the end, the joints keep the velocity that they have in the null space. moving: whether the tip moves at
/// the start and at the end; differences across a moving end are zero.
template <int N, typename F>
void each_difference(const Spline<N>& joints, const FastestClock& clock, double dt, F&& f,
                     const std::array<bool, 2>& moving = {}) {
  Vector<N> q = joints.at(clock.at(0.0).s).x;
  Vector<N> velocity = filled<Vector<N>>(q.size());
  Vector<N> acceleration = velocity;
  const auto ticks = static_cast<int>(std::lround(clock.duration() / dt));
  const auto end = clock.at(clock.duration());
  const Vector<N> after = joints.at(end.s).xd * end.sd;
  for (int k = 1; k <= (moving[1] ? ticks : ticks + 2); ++k) {
    const Vector<N> next = joints.at(clock.at(k * dt).s).x + std::max(k - ticks, 0) * dt * after;
    const Vector<N> v = (next - q) / dt;
    if (moving[0] && k == 1) velocity = v;
    const Vector<N> a = (v - velocity) / dt;
    if (moving[0] && k == 2) acceleration = a;
    f(next, v, a, Vector<N>((a - acceleration) / dt));
    q = next;
    velocity = v;
    acceleration = a;
  }
}

/// The factor by which a clock must be slower, so that the differences of positions at every dt [s] keep the bounds on
/// velocity, acceleration and jerk, from rest to rest or with moving ends.
template <int N>
[[nodiscard]] double excess_of_differences(const Spline<N>& joints, const FastestClock& clock,
                                           const JointLimits<N>& limits, double dt,
                                           const std::array<bool, 2>& moving = {}) {
  const JointLimits<N> complete = limits.complete();
  const auto ratio = [](const Vector<N>& difference, const Vector<N>& bound) {
    return difference.cwiseAbs().cwiseQuotient(bound).maxCoeff();
  };
  double excess = 0.0;
  const auto largest = [&](const auto&, const Vector<N>& v, const Vector<N>& a, const Vector<N>& j) {
    excess = std::max({excess, ratio(v, complete.velocity), std::sqrt(ratio(a, complete.acceleration)),
                       std::cbrt(ratio(j, complete.jerk))});
  };
  each_difference(joints, clock, dt, largest, moving);
  return excess;
}

/// The factor by which a clock must be slower, so that the torques of a motion that is faster by a factor `faster` keep
/// their bounds at the samples at every dt [s], and with a constant acceleration of each tick at both ends of the tick.
template <int N, typename Kept>
[[nodiscard]] double excess_of_torques(const Spline<N>& joints, const FastestClock& clock, const Kept& bounds,
                                       double faster, double dt) {
  double excess = 0.0;
  const auto add = [&](const Vector<N>& q, const Vector<N>& qd, const Vector<N>& qdd) {
    const auto torques = clock_torques(bounds, q, qd, qdd, faster);
    for (const ClockTorque& torque : torques) excess = std::max(excess, torque.slower());
    return !torques.empty();
  };
  Vector<N> q = joints.at(clock.at(0.0).s).x;
  Vector<N> qd = q;
  const auto ticks = static_cast<int>(std::lround(clock.duration() / dt));
  for (int k = 0; k <= ticks; ++k) {
    const auto [p, rate, change] = clock.at(k * dt);
    const auto at = joints.at(p);
    const Vector<N> next = at.xd * rate;
    if (!add(at.x, next, at.xdd * (rate * rate) + at.xd * change)) break;
    if (k > 0) {
      const Vector<N> mean = (next - qd) / dt;
      add(q, qd, mean);
      add(at.x, next, mean);
    }
    q = at.x;
    qd = next;
  }
  return excess;
}

/// Least ramp of a PathFollower with which no change of its rate r exceeds the bounds of the joints on acceleration and
/// jerk, and the bounds on torques [s]; at most kLongestRamp (docs/paths.md, In a control loop).
///
/// A motion with the velocity v, the acceleration a and the jerk j has, at the rate r, the acceleration a r² + v ṙ and
/// the jerk j r³ + 3 a r ṙ + v r̈. While |ṙ| is k times its bound c/ramp, c = 4/3, the rate is r ≤ 1 − k²/6: a change
/// of the rate begins or ends at a rate of at most 1.
template <int N, typename Kept>
[[nodiscard]] double least_ramp(const Spline<N>& joints, const FastestClock& clock, const JointLimits<N>& limits,
                                const Kept& bounds, double dt) {
  constexpr double kLongestRamp = 10.0;
  constexpr double kRate = 4.0 / 3.0;  // Bounds of PathFollower on ṙ and r̈, times the ramp and its square.
  constexpr double kChange = 16.0 / 3.0;
  constexpr int kSteps = 16;
  // For the time between ticks. With 1, 1 of 40 random motions leaves its path when an operator changes the speed.
  constexpr double kSafety = 1.02;
  const JointLimits<N> complete = limits.complete();
  double inverse = std::numeric_limits<double>::infinity();  // 1/ramp.
  each_difference(joints, clock, dt,
                  [&](const Vector<N>& q, const Vector<N>& v, const Vector<N>& a, const Vector<N>& j) {
                    for (const ClockTorque& torque : clock_torques(bounds, q, v, a)) {
                      for (int step = 1; step <= kSteps; ++step) {
                        const double k = static_cast<double>(step) / kSteps;
                        const double r = 1.0 - k * k / 6.0;
                        const double slack = 1.0 - std::abs(torque.rest + r * torque.odd + r * r * torque.even);
                        inverse = std::min(inverse, std::max(slack, 0.0) / (std::abs(torque.change) * k * kRate));
                      }
                    }

                    for (Eigen::Index i = 0; i < v.size(); ++i) {
                      const double speed = std::abs(v(i));
                      if (!(speed > 0.0)) continue;
                      for (int step = 1; step <= kSteps; ++step) {
                        const double k = static_cast<double>(step) / kSteps;
                        const double r = 1.0 - k * k / 6.0;
                        const double slack = complete.acceleration(i) - std::abs(a(i)) * r * r;
                        inverse = std::min(inverse, slack / (speed * k * kRate));
                        const double jerk = std::max(complete.jerk(i) - std::abs(j(i)) * r * r * r, 0.0);
                        if (!std::isfinite(jerk)) continue;
                        const double half =
                            1.5 * std::abs(a(i)) * r * k * kRate;  // speed kChange x² + 2 half x ≤ jerk, x = 1/ramp.
                        inverse = std::min(inverse, jerk / (half + std::sqrt(half * half + speed * kChange * jerk)));
                      }
                    }
                  });
  return kSafety / std::max(inverse, 1.0 / kLongestRamp);
}

}  // namespace fpbm
