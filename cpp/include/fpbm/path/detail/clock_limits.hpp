#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "fpbm/core/detail/validation.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/model/joint.hpp"
#include "fpbm/path/detail/clock_bounds.hpp"

namespace fpbm {

/// Throws std::invalid_argument unless a FastestClock can keep the limits.
template <int N>
void require_clock_limits(const JointLimits<N>& limits) {
  for (Eigen::Index i = 0; i < limits.acceleration.size(); ++i) {
    const auto positive = [i](const char* name, double bound) {
      if (!(bound > 0.0)) validation::fail(validation::element(name, i), bound, "positive");
    };
    positive("limits.velocity", limits.velocity(i));
    positive("limits.acceleration", limits.acceleration(i));
    positive("limits.jerk", limits.jerk(i));
    if (!std::isfinite(limits.acceleration(i))) {
      validation::fail(validation::element("limits.acceleration", i), limits.acceleration(i),
                       "finite: the clock needs a bound on each acceleration");
    }
  }
}

/// Largest velocity of a joint at a distance from an end of its range, from which a Tracker can stop: the braking
/// envelope. At the end of its range, a joint may stand.
[[nodiscard]] inline double braking_velocity(const JointBounds<double>& joint, double distance) noexcept {
  constexpr double kLeast = 1e-6;  // [rad/s] or [m/s]
  if (std::isfinite(joint.deceleration)) {
    return std::max(std::sqrt(2.0 * joint.deceleration * distance) - joint.velocity_offset, kLeast);
  }
  const double ramp = joint.acceleration / joint.jerk;
  const double offset = JointBounds<double>::kOffset * joint.acceleration * ramp;
  return std::max(std::sqrt(offset * offset + 2.0 * joint.acceleration * distance) - offset, kLeast);
}

/// Bounds of the joints at a fraction of a joint path with the value and derivatives d. Throws std::invalid_argument if
/// a joint leaves its range.
template <int N>
[[nodiscard]] ClockBounds clock_bounds(const std::array<Vector<N>, 6>& d, const JointLimits<N>& limits,
                                       double fraction) {
  constexpr double kRoundOff = 1e-12;  // [rad] or [m], of the spline for a joint that stands at an end of its range.
  Vector<N> velocity = limits.velocity;
  for (Eigen::Index k = 0; k < velocity.size(); ++k) {
    const double q = d[0](k);
    if (q < limits.lower(k) - kRoundOff || q > limits.upper(k) + kRoundOff) {
      validation::reject("path", ": leaves the range of joint ", k, " at the fraction ", fraction, ": position ", q,
                         " is ", std::max(q - limits.upper(k), limits.lower(k) - q), " outside of [", limits.lower(k),
                         ", ", limits.upper(k), "]");
    }
    const double distance = std::max(d[1](k) > 0.0 ? limits.upper(k) - q : q - limits.lower(k), 0.0);
    velocity(k) = std::min(velocity(k), braking_velocity(limits.joint(k), distance));
  }
  return ClockBounds(std::array<Vector<N>, 3>{d[1], d[2], d[3]}, velocity, limits.acceleration, limits.jerk);
}

}  // namespace fpbm
