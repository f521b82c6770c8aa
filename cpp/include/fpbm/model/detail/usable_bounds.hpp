#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "fpbm/core/detail/validation.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/model/joint.hpp"

namespace fpbm {

/// Bounds of joint i for a loop of ticks of length h. Throws std::invalid_argument, with the joint and the value, if
/// the bounds are invalid.
///
/// If the joint has an envelope, the ends of the range become the positions at which the envelope is zero. If the joint
/// cannot brake along the envelope, the envelope is replaced by a lower envelope with the same zero and the same slope
/// at the zero.
///
/// At velocity level, a missing bound on acceleration becomes the acceleration that changes the velocity from one bound
/// to the other in a tick. A bound on velocity or acceleration is reduced to 1024 times the largest value that a tick
/// can use, and to a number whose square is finite, because squares of DBL_MAX overflow. In a tick, no joint moves
/// farther than its range, or changes its velocity by more than twice the velocity bound. A bound on jerk that admits
/// the change from one acceleration bound to the other in a tick is removed.
template <Level kLevel, typename Scalar>
[[nodiscard]] JointBounds<Scalar> usable_bounds(Eigen::Index i, JointBounds<Scalar> bounds, Scalar tick) {
  const auto require = [i](bool good, const char* name, Scalar value, const char* what) {
    if (!good) validation::fail(validation::element(name, i), value, what);
  };
  require(bounds.lower < bounds.upper, "limits.lower", bounds.lower, "below limits.upper");
  require(bounds.velocity > Scalar(0), "limits.velocity", bounds.velocity, "positive");
  require(bounds.acceleration > Scalar(0), "limits.acceleration", bounds.acceleration, "positive");
  require(bounds.jerk > Scalar(0), "limits.jerk", bounds.jerk, "positive");
  require(!std::isfinite(bounds.jerk) || std::isfinite(bounds.acceleration), "limits.acceleration", bounds.acceleration,
          "finite if the joint jerk is bounded: give a bound");
  require(bounds.deceleration > Scalar(0), "limits.deceleration", bounds.deceleration, "positive");
  require(bounds.velocity_offset >= Scalar(0) && std::isfinite(bounds.velocity_offset), "limits.velocity_offset",
          bounds.velocity_offset, "finite and not negative");

  // With A = 1024 V/h, the braking distance V²/2A is 1/2048 of the displacement V h of a tick, so that a larger bound
  // has almost no effect.
  constexpr auto kPlenty = Scalar(1024);
  const Scalar most =
      std::ldexp(Scalar(1), std::numeric_limits<Scalar>::max_exponent * 3 / 8);  // The square of `most` is finite.
  const Scalar range = bounds.upper - bounds.lower;
  if (std::isfinite(bounds.velocity)) bounds.velocity = std::min({bounds.velocity, kPlenty * (range / tick), most});
  if (std::isfinite(bounds.acceleration)) {
    const Scalar speed = std::min(bounds.velocity, Scalar(2) * (range / tick));
    bounds.acceleration = std::min({bounds.acceleration, kPlenty * (speed / tick), most});
  } else if (std::isfinite(bounds.lower) || std::isfinite(bounds.upper) || std::isfinite(bounds.velocity)) {
    require(kLevel == Level::kVelocity, "limits.acceleration", bounds.acceleration,
            "finite if the joint position or velocity is bounded: give a bound");
    const Scalar speed = std::isfinite(bounds.velocity) ? bounds.velocity : range / tick;
    if (std::isfinite(speed)) bounds.acceleration = Scalar(2) * speed / tick;
  }
  if (bounds.jerk * tick >= Scalar(2) * bounds.acceleration) bounds.jerk = JointBounds<Scalar>::kNone;
  if (!std::isfinite(bounds.deceleration)) return bounds;
  const Scalar short_of = bounds.velocity_offset * bounds.velocity_offset / (Scalar(2) * bounds.deceleration);
  bounds.upper -= short_of;
  bounds.lower += short_of;
  require(bounds.lower < bounds.upper, "limits.velocity_offset", bounds.velocity_offset,
          "smaller: it leaves no range for the joint");
  const Scalar delay = std::max(bounds.velocity_offset / bounds.deceleration, tick / Scalar(2));
  bounds.deceleration = std::min({bounds.deceleration, bounds.acceleration, bounds.jerk * delay});
  bounds.velocity_offset = delay * bounds.deceleration;
  return bounds;
}

}  // namespace fpbm
