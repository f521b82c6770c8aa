#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <tuple>
#include <type_traits>

#include "fpbm/core/joint_space.hpp"
#include "fpbm/core/level.hpp"
#include "fpbm/core/parts.hpp"
#include "fpbm/task/stack.hpp"
#include "fpbm/task/task_gains.hpp"

namespace fpbm {

/// Error of one joint that the feedback of a posture task uses (docs/tasks.md, Posture tasks).
///
/// Let λ be the rate of the error dynamics: the slowest root of λ² − k₁λ + k₂ = 0, k₁/2 if the roots are complex, or k
/// at velocity level. A joint that approaches its target with the velocity v = λe decelerates with λ²e. If λ²e exceeds
/// the deceleration a, the error is reduced, so that the joint follows v² = 2a (e − a/2λ²) within its bound on velocity.
template <Level kLevel, typename Scalar>
struct JointApproach {
  TaskGains<Scalar> gains;
  Scalar velocity;      ///< Bound on velocity.
  Scalar acceleration;  ///< Bound on acceleration.
  Scalar jerk;          ///< Bound on jerk.

  [[nodiscard]] Scalar operator()(Scalar error) const noexcept {
    const Scalar size = std::abs(error);
    // Most errors are small. λ² ≤ k₂ and λ ≥ k₂/k₁.
    const Scalar square = kLevel == Level::kVelocity ? gains.k2 * gains.k2 : gains.k2;
    const Scalar most = kLevel == Level::kVelocity ? velocity : gains.k1 * velocity;
    const Scalar rate = kLevel == Level::kVelocity ? gains.k2 : gains.k1;
    if (square * size <= acceleration && gains.k2 * size <= most && rate * size <= kRamp * jerk) return error;
    return std::copysign(reduced(size), error);
  }

 private:
  /// The error of magnitude `size` is reduced to this magnitude.
  [[nodiscard, gnu::cold, gnu::noinline]] Scalar reduced(Scalar size) const noexcept {
    const auto [k1, k2] = std::pair(gains.k1, gains.k2);
    Scalar lambda = k2;
    if constexpr (kLevel == Level::kAcceleration) {
      const Scalar discriminant = k1 * k1 - Scalar(4) * k2;
      lambda = discriminant > Scalar(0) ? Scalar(2) * k2 / (k1 + std::sqrt(discriminant)) : k1 / Scalar(2);
    }
    const Scalar deceleration = std::min(kFraction * acceleration, kRamp * lambda * jerk);
    const Scalar linear = deceleration / (lambda * lambda);  // Error below which v = λe.
    const auto used = [&](Scalar v, Scalar a) noexcept {
      return kLevel == Level::kVelocity ? v / k2 : (k1 * v - a) / k2;
    };
    Scalar result = size;
    if (size > linear) {
      const Scalar v = std::sqrt(Scalar(2) * deceleration * (size - linear / Scalar(2)));
      result = linear * (used(v, deceleration) / used(lambda * linear, deceleration));
    }
    return k1 > Scalar(0) || kLevel == Level::kVelocity ? std::min(result, used(velocity, Scalar(0))) : result;
  }

  static constexpr Scalar kFraction = Scalar(0.8);
  static constexpr Scalar kRamp = Scalar(0.25);
};

/// Reduces the errors of the posture tasks of a stack, joint by joint (JointApproach). correction: after begin().
template <Level kLevel, typename Space, typename Arm, typename Limits, typename Correction>
void approach_postures([[maybe_unused]] const Arm& arm, [[maybe_unused]] const Limits& limits,
                       [[maybe_unused]] Correction& correction) noexcept {
  if constexpr (kIsProduct<Space>) {
    using Scalar = typename Arm::Scalar;
    const auto& bounds = limits.bounds();
    Space::each([&](auto space, auto i, int row) noexcept {
      if constexpr (kIsJointSpace<decltype(space)>) {
        constexpr std::size_t kIndex = decltype(i)::value;
        const auto& task = std::get<kIndex>(arm.stack().tasks());
        for (int r = 0; r < rows_of(task); ++r) {
          const int joint = task.joint(r);
          const JointApproach<kLevel, Scalar> approach{task.gains, bounds.velocity.coeff(joint),
                                                       bounds.acceleration.coeff(joint), bounds.jerk.coeff(joint)};
          correction.reduce(row + r, approach(correction.error().coeff(row + r)), kIndex < Space::kFirst);
        }
      }
    });
  }
}

}  // namespace fpbm
