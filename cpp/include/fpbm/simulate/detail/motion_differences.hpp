#pragma once

#include <algorithm>
#include <cmath>

#include "fpbm/core/types.hpp"
#include "fpbm/model/joint.hpp"
#include "fpbm/path/fastest.hpp"
#include "fpbm/path/spline.hpp"

namespace fpbm {

/// Calls f(v, a, j) for each tick of dt [s] of a motion, from rest to rest: velocities, accelerations and jerks by
/// differences of positions.
template <int N, typename F>
void each_difference(const Spline<N>& joints, const FastestClock& clock, double dt, const F& f) {
  Vector<N> q = joints.at(clock.at(0.0).s).x;
  Vector<N> velocity = filled<Vector<N>>(q.size());
  Vector<N> acceleration = velocity;
  const auto ticks = static_cast<int>(std::lround(clock.duration() / dt));
  for (int k = 1; k <= ticks + 2; ++k) {
    const Vector<N> next = joints.at(clock.at(k * dt).s).x;
    const Vector<N> v = (next - q) / dt;
    const Vector<N> a = (v - velocity) / dt;
    f(v, a, Vector<N>((a - acceleration) / dt));
    q = next;
    velocity = v;
    acceleration = a;
  }
}

/// The factor by which a clock must be slower, so that the differences of positions at every dt [s] keep the bounds on
/// velocity, acceleration and jerk.
template <int N>
[[nodiscard]] double excess_of_differences(const Spline<N>& joints, const FastestClock& clock,
                                           const JointLimits<N>& limits, double dt) {
  const JointLimits<N> complete = limits.complete();
  const auto ratio = [](const Vector<N>& difference, const Vector<N>& bound) {
    return difference.cwiseAbs().cwiseQuotient(bound).maxCoeff();
  };
  double excess = 0.0;
  each_difference(joints, clock, dt, [&](const Vector<N>& v, const Vector<N>& a, const Vector<N>& j) {
    excess = std::max({excess, ratio(v, complete.velocity), std::sqrt(ratio(a, complete.acceleration)),
                       std::cbrt(ratio(j, complete.jerk))});
  });
  return excess;
}

/// The least ramp [s] of a PathFollower along a motion, so that all joints keep their bounds whenever the follower
/// changes its rate r: with |ṙ| ≤ c/ramp and |r̈| ≤ 4c/ramp², c = 4/3, and the derivatives v, a, j at r = 1,
///   |a| + |v| c/ramp ≤ A  and  |j| + 3|a| c/ramp + |v| 4c/ramp² ≤ J.
/// The motion must have a reserve to its bounds A and J.
template <int N>
[[nodiscard]] double least_ramp(const Spline<N>& joints, const FastestClock& clock, const JointLimits<N>& limits,
                                double dt) {
  const JointLimits<N> complete = limits.complete();
  constexpr double c = 4.0 / 3.0;
  double ramp = dt;
  each_difference(joints, clock, dt, [&](const Vector<N>& v, const Vector<N>& a, const Vector<N>& j) {
    for (Eigen::Index i = 0; i < v.size(); ++i) {
      ramp = std::max(ramp, c * std::abs(v(i)) / (complete.acceleration(i) - std::abs(a(i))));
      if (!std::isfinite(complete.jerk(i))) continue;
      const double left = complete.jerk(i) - std::abs(j(i));
      const double half = 1.5 * c * std::abs(a(i)) / left;
      ramp = std::max(ramp, half + std::sqrt(half * half + 4.0 * c * std::abs(v(i)) / left));
    }
  });
  return ramp;
}

}  // namespace fpbm
