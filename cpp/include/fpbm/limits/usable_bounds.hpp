#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "fpbm/core/level.hpp"
#include "fpbm/core/validation.hpp"
#include "fpbm/model/joint.hpp"

namespace fpbm {

/// Bounds on a joint as a loop of ticks of length h uses them. Throws std::invalid_argument naming the joint where they
/// are none.
///
/// Where the velocity is bounded toward an end, the ends become the places where that bound is zero. A joint that
/// cannot brake along that bound gets one that is zero at the same place with the same slope, and lies below it.
///
/// At velocity level a missing acceleration is the one that changes the velocity at once. A velocity or an acceleration
/// a thousand times what a tick can use is cut down to that, since squares of DBL_MAX overflow: no joint moves farther
/// than its range in a tick, or changes its velocity by more than twice the largest. A jerk that takes the acceleration
/// from one bound to the other in a tick is none.
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

  constexpr auto kPlenty = Scalar(1024);
  const Scalar most =
      std::ldexp(Scalar(1), std::numeric_limits<Scalar>::max_exponent * 3 / 8);  // Its square is finite.
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
