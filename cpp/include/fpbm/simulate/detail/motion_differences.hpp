#pragma once

#include <algorithm>
#include <cmath>

#include "fpbm/core/types.hpp"
#include "fpbm/model/joint.hpp"
#include "fpbm/path/fastest_clock.hpp"
#include "fpbm/path/spline.hpp"

namespace fpbm {

/// The factor by which a clock must be slower, so that the differences of positions at every dt [s] keep the bounds on
/// velocity, acceleration and jerk, from rest to rest.
template <int N>
[[nodiscard]] double excess_of_differences(const Spline<N>& joints, const FastestClock& clock,
                                           const JointLimits<N>& limits, double dt) {
  const JointLimits<N> complete = limits.complete();
  const auto ratio = [](const Vector<N>& difference, const Vector<N>& bound) {
    return difference.cwiseAbs().cwiseQuotient(bound).maxCoeff();
  };
  Vector<N> q = joints.at(clock.at(0.0).s).x;
  Vector<N> velocity = filled<Vector<N>>(q.size());
  Vector<N> acceleration = velocity;
  double excess = 0.0;
  const auto ticks = static_cast<int>(std::lround(clock.duration() / dt));
  for (int k = 1; k <= ticks + 2; ++k) {
    const Vector<N> next = joints.at(clock.at(k * dt).s).x;
    const Vector<N> v = (next - q) / dt;
    const Vector<N> a = (v - velocity) / dt;
    excess = std::max({excess, ratio(v, complete.velocity), std::sqrt(ratio(a, complete.acceleration)),
                       std::cbrt(ratio((a - acceleration) / dt, complete.jerk))});
    q = next;
    velocity = v;
    acceleration = a;
  }
  return excess;
}

}  // namespace fpbm
