#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "fpbm/path/path.hpp"

namespace fpbm {

/// Distance over time from rest to rest: a ramp up to a speed, constant speed, and a ramp down. In a ramp, the
/// acceleration is a trapezoid with the bounds on acceleration and jerk, or constant if the jerk is unbounded. If the
/// distance is short, the profile does not reach the speed.
///
/// The duration is rounded up to a multiple of 0.01 s, so that usual steps divide the duration. Longer ramps, not a
/// lower speed, fill the time.
template <typename Scalar>
class SpeedProfile {
 public:
  /// All arguments are positive; jerk may be infinite.
  SpeedProfile(Scalar length, Scalar speed, Scalar acceleration, Scalar jerk) : length_(length), speed_(speed) {
    const Scalar build_up = acceleration / jerk;  // Time to build up the acceleration.
    // Two ramps to the speed v, each with the duration r, have the length v r. For larger v, a ramp has the bound on
    // acceleration, and r = v/a + a/j; otherwise, r = 2 √(v/j).
    const Scalar root = std::sqrt(build_up * build_up + Scalar(4) * length / acceleration);
    speed_ = std::min(speed_, (root - build_up) * acceleration / Scalar(2));
    if (speed_ < acceleration * build_up) speed_ = std::min(speed, std::cbrt(length * length * jerk / Scalar(4)));
    rise_ = std::min(build_up, std::sqrt(speed_ / jerk));
    ramp_ = speed_ < acceleration * build_up ? Scalar(2) * rise_ : speed_ / acceleration + rise_;
    const Scalar duration = length_ / speed_ + ramp_;
    constexpr Scalar kRounding = Scalar(16) * std::numeric_limits<Scalar>::epsilon();
    duration_ = std::ceil(Scalar(100) * duration * (Scalar(1) - kRounding)) / Scalar(100);
    if (const Scalar ramp = duration_ - length_ / speed_; Scalar(2) * ramp <= duration_) {
      rise_ *= ramp / ramp_;
      ramp_ = ramp;
    } else {
      const Scalar slower = duration_ / duration;
      speed_ /= slower;
      rise_ *= slower;
      ramp_ *= slower;
    }
  }

  [[nodiscard]] Scalar duration() const noexcept { return duration_; }

  /// Distance and its first two derivatives at 0 ≤ t ≤ duration().
  [[nodiscard]] Phase<Scalar> at(Scalar t) const noexcept {
    if (Scalar(2) * t > duration_) {
      const Phase<Scalar> back = begin(duration_ - t);
      return {length_ - back.s, back.sd, -back.sdd};
    }
    return begin(t);
  }

 private:
  /// Ramp up and constant speed. The second half of a ramp is symmetric to the first half.
  [[nodiscard]] Phase<Scalar> begin(Scalar t) const noexcept {
    if (t >= ramp_) return {speed_ * (t - ramp_ / Scalar(2)), speed_, Scalar(0)};
    if (Scalar(2) * t <= ramp_) return first_half(t);
    const Phase<Scalar> other = first_half(ramp_ - t);
    return {speed_ * (t - ramp_ / Scalar(2)) + other.s, speed_ - other.sd, other.sdd};
  }

  [[nodiscard]] Phase<Scalar> first_half(Scalar t) const noexcept {
    const Scalar acceleration = speed_ / (ramp_ - rise_);
    if (t < rise_) {
      const Scalar now = acceleration * t / rise_;
      return {now * t * t / Scalar(6), now * t / Scalar(2), now};
    }
    const Scalar half = rise_ / Scalar(2);
    return {acceleration * ((t - half) * (t - half) / Scalar(2) + rise_ * rise_ / Scalar(24)),
            acceleration * (t - half), acceleration};
  }

  Scalar length_;
  Scalar speed_;     ///< Largest speed [m/s].
  Scalar rise_;      ///< Time of constant jerk at the start of a ramp [s].
  Scalar ramp_;      ///< Duration of a ramp [s].
  Scalar duration_;  ///< [s]
};

}  // namespace fpbm
