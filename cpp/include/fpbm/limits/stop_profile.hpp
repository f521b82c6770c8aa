#pragma once

#include <algorithm>
#include <cmath>

#include "fpbm/core/level.hpp"

namespace fpbm {

/// Ticks in which a velocity v is taken away: `wait` without acceleration, then decelerations of b w_k, whose shares
/// w_k rise and fall by 1/ramp a tick, as far as 1, in `brake` ticks.
///
/// The ticks are alike from both ends, so that the way is v times `wait` and half of `brake`; their shares add up to
/// brake − ramp + 1, which makes b = v / (h (brake − ramp + 1)).
template <typename Scalar>
struct StopProfile {
  Scalar wait = Scalar(0);
  Scalar ramp = Scalar(1);
  Scalar brake = Scalar(0);  ///< 0, or 2 ramp − 1 at least.

  /// The quickest for a velocity, within bounds on deceleration and jerk, in ticks of length h.
  [[nodiscard]] static StopProfile quickest(Scalar velocity, Scalar deceleration, Scalar jerk, Scalar h) noexcept {
    using std::abs;
    using std::ceil;
    using std::sqrt;
    const Scalar speed = abs(velocity);
    if (!(speed > Scalar(0))) return {};
    Scalar ramp(1);
    if (std::isfinite(jerk)) ramp = ceil(std::min(deceleration / jerk, sqrt(speed / jerk)) / h);
    return {Scalar(0), ramp, std::max(Scalar(2) * ramp, ramp + ceil(speed / (h * deceleration))) - Scalar(1)};
  }

  /// One in which joints of both stop, each no harder than in its own.
  [[nodiscard]] StopProfile together(const StopProfile& other) const noexcept {
    const Scalar longest = std::max(ramp, other.ramp);
    const Scalar even = std::max(brake - ramp, other.brake - other.ramp);  // Must not fall: b depends on it.
    return {std::max(wait, other.wait), longest, longest + std::max(longest - Scalar(1), even)};
  }

  /// Way for each unit of velocity, in ticks. At velocity level a tick moves by the velocity at its end.
  [[nodiscard]] Scalar way(Level level) const noexcept {
    return wait + (level == Level::kVelocity ? std::max(brake - Scalar(1), Scalar(0)) : brake) / Scalar(2);
  }

  /// Share of the velocity that tick k, from 0 on, takes away.
  [[nodiscard]] Scalar share(Scalar k) const noexcept {
    const Scalar at = k - wait;
    if (!(Scalar(0) <= at && at < brake)) return Scalar(0);
    return std::min({at + Scalar(1), ramp, brake - at}) / (ramp * (brake - ramp + Scalar(1)));
  }

  [[nodiscard]] Scalar ticks() const noexcept { return wait + brake; }
};

}  // namespace fpbm
