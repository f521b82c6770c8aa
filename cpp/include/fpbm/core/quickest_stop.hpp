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

  /// Some seconds later, at constant jerk.
  [[nodiscard]] AxisState ahead(Scalar seconds, Scalar jerk) const noexcept {
    const Scalar t = seconds;
    return {q + t * (v + t * (a / Scalar(2) + t * jerk / Scalar(6))), v + t * (a + t * jerk / Scalar(2)), a + t * jerk};
  }
};

/// The quickest stop of one axis within bounds A on its acceleration and J on its jerk, in closed form: the jerk is
/// −sJ, 0 and sJ in turn, with s the sign of v + a|a|/2J, the velocity that is left once a has been let go.
///
/// A state with s > 0 lies on the curve of jerk −J through a state without acceleration, whose velocity is v + a²/2J
/// and whose position is q + va/J + a³/3J²; from there the stop takes a way of way(v + a²/2J).
template <typename Scalar>
struct QuickestStop {
  Scalar acceleration;  ///< A, positive; infinite for none.
  Scalar jerk;          ///< J, positive and finite.

  /// Sign of the velocity that the stop takes away.
  [[nodiscard]] Scalar sign(Scalar v, Scalar a) const noexcept {
    return v + a * std::abs(a) / (Scalar(2) * jerk) < Scalar(0) ? Scalar(-1) : Scalar(1);
  }

  /// Way to rest from a velocity ≥ 0 without acceleration.
  [[nodiscard]] Scalar way(Scalar velocity) const noexcept {
    using std::sqrt;
    const Scalar ramp = acceleration / jerk;
    return velocity <= acceleration * ramp ? velocity * sqrt(velocity / jerk)
                                           : velocity * (velocity / acceleration + ramp) / Scalar(2);
  }

  /// Position at rest.
  [[nodiscard]] Scalar rest(const AxisState<Scalar>& state) const noexcept {
    const auto [q, v, a] = state;
    const Scalar s = sign(v, a);
    const Scalar lost = a / jerk;
    const Scalar most = std::max(s * v + a * lost / Scalar(2), Scalar(0));
    return q + s * v * lost + a * lost * lost / Scalar(3) + s * way(most);
  }

  /// Some seconds along the stop, from |a| ≤ A; at rest exactly once it has ended.
  [[nodiscard]] AxisState<Scalar> ahead(const AxisState<Scalar>& state, Scalar seconds) const noexcept {
    using std::sqrt;
    const auto [q, v, a] = state;
    const Scalar s = sign(v, a);
    const Scalar most = std::max(s * v + a * a / (Scalar(2) * jerk), Scalar(0));
    const Scalar ramp = acceleration / jerk;
    const bool even = most > acceleration * ramp;
    const Scalar last = even ? ramp : sqrt(most / jerk);
    const Scalar first = std::max(s * a / jerk + last, Scalar(0));
    const Scalar left = first + (even ? most / acceleration - ramp : Scalar(0)) + last - seconds;
    const AxisState<Scalar> end{rest(state), Scalar(0), Scalar(0)};
    if (!(left > Scalar(0))) return end;
    // Back from the end, so that velocity and acceleration vanish together.
    if (left <= last) return end.ahead(-left, s * jerk);
    if (seconds <= first) return state.ahead(seconds, -s * jerk);
    return state.ahead(first, -s * jerk).ahead(seconds - first, Scalar(0));
  }
};

/// Largest x in [low, high] where a rising function is not above zero, or low where it is above zero all the way. In
/// rounds + 2 evaluations at most, by the Illinois method; what it returns is never above zero.
template <typename Scalar, typename Function>
[[nodiscard]] Scalar largest_below_zero(Function&& function, Scalar low, Scalar high, int rounds = 6) noexcept {
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
