#pragma once

#include <limits>

#include "fpbm/core/detail/mask.hpp"

namespace fpbm {

/// Feedback of a task. In a tick of length h, the commanded task acceleration is
///
///   ẍ = s ẍ' + (1 − s) xdd + (k₁' 2(e' − e)/h + k₂'e')/(1 + g),   g = k₁'h/2 + k₂'h²/4,   s = g/(2 + 2g).
///
/// e is the error x ⊖ f(q) at the start of the tick. e' and ẍ' are the error and the task acceleration in the middle of
/// a tick that continues the acceleration of the previous tick. The law is the implicit midpoint rule for
/// ë + k₁'ė + k₂'e = 0 (docs/tick.md, A tick): a tick multiplies an error by
/// (2 + λ'h)/(2 − λ'h), where λ'² + k₁'λ' + k₂' = 0. The gains
///
///   k₁' = k₁ − (k₁² − 3k₂)k₁h²/12,   k₂' = k₂ − (k₁² − 2k₂)k₂h²/12
///
/// have λ' = λ − λ³h²/12 with λ² + k₁λ + k₂ = 0, so that a tick multiplies an error by e^(λh) up to terms of λ⁵h⁵.
/// h = 0: ẍ = xdd + k₁ė + k₂e.
///
/// In float, 2(e' − e)/h is mostly round-off error. Therefore, ė' is used instead, with s = (g − k₂'h²/8)/(1 + g).
template <typename Scalar = double>
struct TickFeedback {
  static constexpr bool kByPositions = std::numeric_limits<Number<Scalar>>::digits > 24;  ///< Whether e' − e is used.

  Scalar velocity_gain;                ///< k₁'/(1 + g) [1/s].
  Scalar position_gain;                ///< k₂'/(1 + g) [1/s²].
  Scalar previous_weight = Scalar(0);  ///< s, weight of ẍ'.
  Scalar lead = Scalar(0);             ///< h' = h (5/8 + g/2)/(1 + g) [s], for the rows J + h'J̇.
  Scalar correction = Scalar(0);  ///< h/(8 + 8g) [s], factor of the change of acceleration δ' of the previous tick.

  TickFeedback() noexcept {}  // NOLINT(modernize-use-equals-default): as LevelRows.
  TickFeedback(Scalar k1, Scalar k2) noexcept : velocity_gain(k1), position_gain(k2) {}
  TickFeedback(Scalar k1, Scalar k2, Scalar h) noexcept {
    const Scalar twelfth = h * h / Scalar(12);
    const Scalar corrected1 = k1 - (k1 * k1 - Scalar(3) * k2) * k1 * twelfth;
    const Scalar corrected2 = k2 - (k1 * k1 - Scalar(2) * k2) * k2 * twelfth;
    const Scalar half_g = h * (corrected1 + corrected2 * h / Scalar(2)) / Scalar(4);
    const Scalar inverse = Scalar(1) / (Scalar(1) + Scalar(2) * half_g);
    velocity_gain = corrected1 * inverse;
    position_gain = corrected2 * inverse;
    previous_weight = half_g * inverse;
    if constexpr (!kByPositions) previous_weight += velocity_gain * h / Scalar(4);
    lead = h * (Scalar(0.625) + half_g) * inverse;
    correction = h / Scalar(8) * inverse;
  }
};

}  // namespace fpbm
