#pragma once

#include <cmath>
#include <limits>

#include "fpbm/task/detail/tick_feedback.hpp"

/// Stability of a tick with feedback and integral gain kᵢ, for gains times powers of the tick length h: x₁ = k₁h, x₂ =
/// k₂h², x₃ = kᵢh³ at acceleration level; x₁ = kh, x₃ = kᵢh² at velocity level.
namespace fpbm {

/// Whether no root of (z−1)³ + a(z−1)² + b(z−1) + c is outside the unit circle, by Routh's criterion for the polynomial
/// in w with z = (1+w)/(1−w). For small gains, the coefficients of powers of z−1 have no cancellation. round_off: near
/// zero, the error of a sum is at most 12 ε (|a| + |b| + |c|). The factor 64 also covers the errors of a, b and c.
template <typename Scalar>
[[nodiscard]] bool is_in_unit_circle(Scalar a, Scalar b, Scalar c) noexcept {
  const Scalar w3 = Scalar(8) - Scalar(4) * a + Scalar(2) * b - c;
  const Scalar w2 = Scalar(4) * (a - b) + Scalar(3) * c;
  const Scalar w1 = Scalar(2) * b - Scalar(3) * c;
  const Scalar round_off =
      Scalar(64) * std::numeric_limits<Scalar>::epsilon() * (std::abs(a) + std::abs(b) + std::abs(c));
  const auto holds = [&](Scalar value) { return value >= -round_off; };
  return holds(w3) && holds(w2) && holds(w1) && holds(c) && (w2 + round_off) * w1 >= w3 * c;
}

/// Whether a tick damps ë = −x₁ė − x₂e − x₃I. At the end of a tick, the integral I increases by the error e at the
/// start of the tick. Both forms of a tick must be stable: a step of RK4, and a step with the mean acceleration of RK4,
/// as with bounds on jerk and other limits.
template <typename Scalar>
[[nodiscard]] bool is_stable_acceleration(Scalar x1, Scalar x2, Scalar x3 = Scalar(0)) noexcept {
  struct Change {
    Scalar e;
    Scalar v;
  };
  const auto rk4 = [&](Scalar e, Scalar v, Scalar integral) noexcept {
    Change change{Scalar(0), Scalar(0)};
    for (int stage = 4; stage > 0; --stage) {  // A + A²/2 + A³/6 + A⁴/24 by Horner's rule.
      const Scalar at_v = v + change.v;
      change = {at_v / Scalar(stage), -(x2 * (e + change.e) + x1 * at_v + x3 * integral) / Scalar(stage)};
    }
    return change;
  };
  const Change by_e = rk4(Scalar(1), Scalar(0), Scalar(0));
  const Change by_v = rk4(Scalar(0), Scalar(1), Scalar(0));
  const Change by_integral = rk4(Scalar(0), Scalar(0), Scalar(1));
  const auto holds = [&](Scalar e_e, Scalar e_v, Scalar e_integral) noexcept {
    return is_in_unit_circle(-(e_e + by_v.v), e_e * by_v.v - e_v * by_e.v - e_integral,
                             e_integral * by_v.v - e_v * by_integral.v);
  };
  return holds(by_e.e, by_v.e, by_integral.e) &&
         holds(by_e.v / Scalar(2), Scalar(1) + by_v.v / Scalar(2), by_integral.v / Scalar(2));
}

/// Whether a tick of RK4 damps ė = −x₁e − x₃I, with I as in is_stable_acceleration().
template <typename Scalar>
[[nodiscard]] bool is_stable_velocity(Scalar x1, Scalar x3 = Scalar(0)) noexcept {
  const auto rk4 = [&](Scalar e, Scalar integral) noexcept {
    Scalar change(0);
    for (int stage = 4; stage > 0; --stage) change = -(x1 * (e + change) + x3 * integral) / Scalar(stage);
    return change;
  };
  return is_in_unit_circle(-rk4(Scalar(1), Scalar(0)), -rk4(Scalar(0), Scalar(1)), Scalar(0));
}

/// Whether a tick damps the errors of a task, with TickFeedback (docs/tick.md, A tick). The integral is a part of
/// xdd.
template <typename Scalar>
[[nodiscard]] bool is_stable_acceleration_of_levels(Scalar x1, Scalar x2, Scalar x3 = Scalar(0)) noexcept {
  const TickFeedback<Scalar> feedback(x1, x2, Scalar(1));
  const Scalar integral = (Scalar(1) - feedback.previous_weight) * x3;
  return is_in_unit_circle(feedback.velocity_gain + feedback.position_gain,
                           feedback.position_gain + integral / Scalar(2), integral);
}

/// Whether a tick damps the errors of the null space if the acceleration a is computed in the middle of the tick. Up to
/// the middle, the acceleration a' of the previous tick continues (TickState::update_middle): a = −x₁(ė + a'/2) − x₂(e
/// + ė/2 + a'/8).
template <typename Scalar>
[[nodiscard]] bool is_stable_acceleration_of_middle(Scalar x1, Scalar x2) noexcept {
  return is_in_unit_circle(Scalar(1) + Scalar(1.5) * x1 + Scalar(1.125) * x2, x1 + Scalar(2) * x2, x2);
}

/// Whether a tick damps the errors at velocity level if the velocity v is computed in the middle of the tick. Up to the
/// middle, the velocity v' of the previous tick continues: v = −x₁(e + v'/2) − x₃I.
template <typename Scalar>
[[nodiscard]] bool is_stable_velocity_of_middle(Scalar x1, Scalar x3 = Scalar(0)) noexcept {
  return is_in_unit_circle(Scalar(1) + Scalar(1.5) * x1, x1 + x3, x3);
}

/// Largest factor in [0, 1] for which holds(factor) is true, rounded down to four digits. holds() must be true for all
/// smaller factors.
template <typename Scalar, typename Holds>
[[nodiscard]] Scalar largest_factor(const Holds& holds) {
  constexpr Scalar kNarrow = Scalar(1.00001);  // high/low at the end, for four digits.
  constexpr Scalar kDivisor = Scalar(1024);
  // At most 108 steps divide 1 by kDivisor until the result is 0, and 20 steps of bisection reduce high/low from
  // kDivisor to kNarrow.
  constexpr int kRounds = 200;
  Scalar low(0);
  Scalar high(1);
  for (int i = 0; i < kRounds && high > kNarrow * low; ++i) {
    const Scalar middle = low > Scalar(0) ? std::sqrt(low * high) : high / kDivisor;
    (holds(middle) ? low : high) = middle;
  }
  if (!(low > Scalar(0))) return Scalar(0);
  const Scalar digit = std::pow(Scalar(10), std::floor(std::log10(low)) - Scalar(3));
  return std::floor(low / digit) * digit;
}

}  // namespace fpbm
