#pragma once

#include "fpbm/core/detail/validation.hpp"

namespace fpbm {

/// Feedback gains of a task. The error e obeys ë + k₁ė + k₂e = 0, or ė + k e = 0 at velocity level (docs/equations.md,
/// Error dynamics).
template <typename Scalar = double>
struct TaskGains {
  Scalar k1;  ///< Velocity gain [1/s], not used at velocity level.
  Scalar k2;  ///< Position gain k₂ [1/s²], or k [1/s] at velocity level.

  /// For acceleration level. Throws std::invalid_argument if a gain is negative or not finite.
  TaskGains(Scalar k1_, Scalar k2_) : k1(k1_), k2(k2_) {
    validation::require_non_negative("k1", k1);
    validation::require_non_negative("k2", k2);
  }
  /// Gains that have been validated.
  [[nodiscard]] static TaskGains unchecked(Scalar k1, Scalar k2) noexcept {
    TaskGains gains;
    gains.k1 = k1;
    gains.k2 = k2;
    return gains;
  }
  /// For velocity level.
  explicit TaskGains(Scalar k) : k1(0), k2(k) { validation::require_non_negative("k", k); }

 private:
  TaskGains() = default;
};

}  // namespace fpbm
