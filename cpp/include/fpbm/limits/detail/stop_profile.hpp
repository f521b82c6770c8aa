#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "fpbm/core/types.hpp"
#include "fpbm/limits/detail/box.hpp"

namespace fpbm {

/// Profile of the ticks in which a joint stops from a velocity v: `wait` ticks without acceleration, then `brake` ticks
/// with the decelerations b w_k. The weights w_k increase by 1/ramp per tick, are at most 1, and decrease by 1/ramp per
/// tick at the end.
///
/// The weights are symmetric in time, so the stopping distance is h v (wait + brake/2). The sum of the weights is
/// brake − ramp + 1. Therefore b = v/(h (brake − ramp + 1)).
template <typename Scalar>
struct StopProfile {
  Scalar wait = Scalar(0);
  Scalar ramp = Scalar(1);
  Scalar brake = Scalar(0);  ///< 0, or at least 2 ramp − 1.

  /// Shortest profile for a velocity, within bounds on deceleration and jerk, in ticks of length h.
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

  /// Number of ticks in which an acceleration changes to zero by at most `change` in each tick. Accelerations at the
  /// bound on jerk are multiples of `change` up to the round-off error of a difference of velocities, about 300 ε for
  /// 2 rad/s, 1 ms and 7500 rad/s³. Because of the tolerance of 512 ε, the round-off error does not add a tick.
  [[nodiscard]] static Scalar ramp_ticks(Scalar acceleration, Scalar change) noexcept {
    constexpr Scalar kRoundOff = Scalar(512) * std::numeric_limits<Scalar>::epsilon();
    return std::ceil((Scalar(1) - kRoundOff) * (acceleration / change));
  }

  /// Profile with which the joints of both profiles stop. No joint has a larger deceleration than in its own profile.
  [[nodiscard]] StopProfile together(const StopProfile& other) const noexcept {
    const Scalar longest = std::max(ramp, other.ramp);
    // brake − ramp must not decrease, since b depends on this difference.
    const Scalar even = std::max(brake - ramp, other.brake - other.ramp);
    return {std::max(wait, other.wait), longest, longest + std::max(longest - Scalar(1), even)};
  }

  /// Number of ticks at the velocity v that cover the stopping distance. At velocity level, the displacement in a tick
  /// is h times the velocity at the end of the tick.
  [[nodiscard]] Scalar coasting_ticks(Level level) const noexcept {
    return wait + (level == Level::kVelocity ? std::max(brake - Scalar(1), Scalar(0)) : brake) / Scalar(2);
  }

  /// Fraction of the velocity that tick k = 0, 1, … removes.
  [[nodiscard]] Scalar removed_fraction(Scalar k) const noexcept {
    const Scalar at = k - wait;
    if (!(Scalar(0) <= at && at < brake)) return Scalar(0);
    return std::min({at + Scalar(1), ramp, brake - at}) / (ramp * (brake - ramp + Scalar(1)));
  }

  /// Smallest and largest removed_fraction() of the ticks from k to `last`, which has k ≤ last.
  [[nodiscard]] Interval<Scalar> removed_fractions(Scalar k, Scalar last) const noexcept {
    const Scalar middle = wait + std::floor(brake / Scalar(2));
    return {std::min(removed_fraction(k), removed_fraction(last)),
            removed_fraction(std::min(std::max(middle, k), last))};
  }

  /// Fraction of the velocity that remains after k ticks, and the distance in these ticks, in ticks at the velocity v:
  /// sums of removed_fraction(), which are symmetric in time.
  [[nodiscard]] std::pair<Scalar, Scalar> after(Scalar k) const noexcept {
    const Scalar sum = brake - ramp + Scalar(1);
    const Scalar m = std::min(k - wait, brake);
    if (!(m > Scalar(0)) || !(sum > Scalar(0))) return {Scalar(m < brake), std::min(k, wait)};
    const bool late = m + m > brake;
    const Scalar j = late ? brake - m : m;
    const Scalar p = std::min(j, ramp);
    const Scalar even = j - p;
    const Scalar removed = (p * (p + Scalar(1)) / (Scalar(2) * ramp) + even) / sum;
    const Scalar area = (p * (p + Scalar(1)) * (Scalar(2) * p + Scalar(1)) / (Scalar(12) * ramp) +
                         even * (ramp + Scalar(1) + even) / Scalar(2)) /
                        sum;
    return late ? std::pair(removed, wait + brake / Scalar(2) - area) : std::pair(Scalar(1) - removed, wait + m - area);
  }

  [[nodiscard]] Scalar ticks() const noexcept { return wait + brake; }
};

}  // namespace fpbm
