#pragma once

#include <algorithm>
#include <cmath>

namespace fpbm {

/// Motion along one axis: position q, velocity v, acceleration a.
template <typename Scalar>
struct AxisState {
  Scalar q;
  Scalar v;
  Scalar a;

  /// State after `seconds` [s] at constant jerk.
  [[nodiscard]] AxisState ahead(Scalar seconds, Scalar jerk) const noexcept {
    const Scalar t = seconds;
    return {q + t * (v + t * (a / Scalar(2) + t * jerk / Scalar(6))), v + t * (a + t * jerk / Scalar(2)), a + t * jerk};
  }
};

/// Time-optimal stop of one axis within bounds A on the acceleration and J on the jerk, in closed form. The jerk is
/// −sJ, then 0, then sJ. s is the sign of v + a|a|/2J, the velocity after the jerk ±J has reduced the acceleration to
/// zero.
///
/// A state with s > 0 is on the trajectory of jerk −J through a state with zero acceleration. The state with zero
/// acceleration has the velocity v + a²/2J, the position q + va/J + a³/3J², and the stopping distance
/// stopping_distance(v + a²/2J).
template <typename Scalar>
struct QuickestStop {
  Scalar acceleration;  ///< A, positive; infinite if there is no bound.
  Scalar jerk;          ///< J, positive and finite.

  /// s, the sign of the velocity that the stop removes.
  [[nodiscard]] Scalar sign(Scalar v, Scalar a) const noexcept {
    return v + a * std::abs(a) / (Scalar(2) * jerk) < Scalar(0) ? Scalar(-1) : Scalar(1);
  }

  /// Stopping distance from a velocity ≥ 0 with zero acceleration.
  [[nodiscard]] Scalar stopping_distance(Scalar velocity) const noexcept {
    using std::sqrt;
    const Scalar ramp = acceleration / jerk;
    return velocity <= acceleration * ramp ? velocity * sqrt(velocity / jerk)
                                           : velocity * (velocity / acceleration + ramp) / Scalar(2);
  }

  /// Position at the end of the stop.
  [[nodiscard]] Scalar end_position(const AxisState<Scalar>& state) const noexcept {
    const auto [q, v, a] = state;
    const Scalar s = sign(v, a);
    const Scalar ramp = a / jerk;
    const Scalar fastest = std::max(s * v + a * ramp / Scalar(2), Scalar(0));
    return q + s * v * ramp + a * ramp * ramp / Scalar(3) + s * stopping_distance(fastest);
  }

  /// State after `seconds` [s] of the stop, which starts with |a| ≤ A. After the end of the stop, the velocity and the
  /// acceleration are exactly zero.
  [[nodiscard]] AxisState<Scalar> ahead(const AxisState<Scalar>& state, Scalar seconds) const noexcept {
    using std::sqrt;
    const auto [q, v, a] = state;
    const Scalar s = sign(v, a);
    const Scalar fastest = std::max(s * v + a * a / (Scalar(2) * jerk), Scalar(0));
    const Scalar ramp = acceleration / jerk;
    const bool even = fastest > acceleration * ramp;
    const Scalar last = even ? ramp : sqrt(fastest / jerk);
    const Scalar first = std::max(s * a / jerk + last, Scalar(0));
    const Scalar remaining = first + (even ? fastest / acceleration - ramp : Scalar(0)) + last - seconds;
    const AxisState<Scalar> end{end_position(state), Scalar(0), Scalar(0)};
    if (!(remaining > Scalar(0))) return end;
    // The last phase is computed backward from its end, so that velocity and acceleration reach zero together.
    if (remaining <= last) return end.ahead(-remaining, s * jerk);
    if (seconds <= first) return state.ahead(seconds, -s * jerk);
    return state.ahead(first, -s * jerk).ahead(seconds - first, Scalar(0));
  }
};

/// Largest x in [low, high] at which an increasing function is ≤ 0, approximated from below by the Illinois method with
/// at most rounds + 2 evaluations. If the function is positive at low, returns low. Otherwise, the function is not
/// positive at the returned x.
template <typename Scalar, typename Function>
[[nodiscard]] Scalar largest_below_zero(Function&& function, Scalar low, Scalar high, int rounds) noexcept {
  Scalar above = function(high);
  if (above <= Scalar(0)) return high;
  Scalar below = function(low);
  if (!(below <= Scalar(0))) return low;
  bool moved_low = false;
  bool moved_high = false;
  for (int i = 0; i < rounds; ++i) {
    Scalar x = high - (high - low) * (above / (above - below));
    if (!(low < x && x < high)) x = (low + high) / Scalar(2);
    const Scalar y = function(x);
    if (y <= Scalar(0)) {
      low = x;
      below = y;
      if (moved_low) above /= Scalar(2);
    } else {
      high = x;
      above = y;
      if (moved_high) below /= Scalar(2);
    }
    moved_low = y <= Scalar(0);
    moved_high = !moved_low;
  }
  return low;
}

}  // namespace fpbm
