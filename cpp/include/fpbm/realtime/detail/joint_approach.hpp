#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <tuple>
#include <type_traits>

#include "fpbm/core/detail/parts.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/geometry/detail/joint_space.hpp"
#include "fpbm/limits/limits.hpp"
#include "fpbm/task/detail/task_gains.hpp"
#include "fpbm/task/stack.hpp"

namespace fpbm {

/// Reduces the error of a joint that the feedback of a posture task uses, so that the bounds admit the approach
/// (docs/tasks.md, Posture tasks).
///
/// Let λ be the rate of the feedback: the slow root of λ² − k₁λ + k₂ = 0, k₁/2 if the roots are complex, or k at
/// velocity level. The feedback moves a joint with the error e at the velocity v = λe, and decelerates with λ²e. Beyond
/// the error d/λ², where d is the deceleration of the joint, v = λe would need a larger deceleration. There, the joint
/// follows v² = 2d (e − d/2λ²), up to its bound on velocity.
template <Level kLevel, typename Scalar>
struct JointApproach {
  TaskGains<Scalar> gains;
  Scalar velocity;      ///< Bound on velocity.
  Scalar deceleration;  ///< d
  Scalar jerk;          ///< Bound on jerk.

  /// Fraction of an error of this size that the feedback uses.
  [[nodiscard]] Scalar fraction(Scalar size) const noexcept {
    // Most errors are small. At acceleration level, λ² ≤ k₂ and λ ≥ k₂/k₁.
    const Scalar rate = kSecondOrder ? gains.k1 : gains.k2;
    const Scalar square = kSecondOrder ? gains.k2 : gains.k2 * gains.k2;
    const bool small = square * size <= deceleration &&
                       gains.k2 * size <= (kSecondOrder ? rate : Scalar(1)) * velocity && rate * size <= kRamp * jerk;
    return small ? Scalar(1) : reduced(size) / size;
  }

 private:
  static constexpr bool kSecondOrder = kLevel == Level::kAcceleration;

  /// Error that the feedback uses instead of an error of this size.
  [[nodiscard, gnu::cold, gnu::noinline]] Scalar reduced(Scalar size) const noexcept {
    const Scalar k1 = gains.k1;
    const Scalar k2 = gains.k2;
    Scalar lambda = k2;
    if constexpr (kSecondOrder) {
      const Scalar discriminant = k1 * k1 - Scalar(4) * k2;
      lambda = discriminant > Scalar(0) ? Scalar(2) * k2 / (k1 + std::sqrt(discriminant)) : k1 / Scalar(2);
    }
    if (!(lambda > Scalar(0))) return size;
    const Scalar d = std::min(deceleration, kRamp * lambda * jerk);
    const Scalar linear = d / (lambda * lambda);
    // Error with which the feedback moves the joint at the velocity v, and decelerates with a.
    const auto used = [&](Scalar v, Scalar a) noexcept { return kSecondOrder ? (k1 * v - a) / k2 : v / k2; };
    Scalar result = size;
    if (size > linear) {
      const Scalar v = std::sqrt(Scalar(2) * d * (size - linear / Scalar(2)));
      result = linear * (used(v, d) / used(lambda * linear, d));
    }
    return std::min(result, used(velocity, Scalar(0)));
  }

  /// The deceleration begins within the time 1/4λ at the bound on jerk.
  static constexpr Scalar kRamp = Scalar(0.25);
};

/// Deceleration with which joint i approaches the target of a posture task. At velocity level, the limiter changes
/// velocities that are a tick of full acceleration away: with a bound on jerk, this change has a smaller acceleration.
/// 0.95 of this acceleration: PostureApproach.needs_at_most_twice_the_least_time_at_velocity_level needs 2.03 times the
/// least time with 0.8, and has an overshoot of 0.02 with 1.
template <Level kLevel, int N, typename Scalar>
[[nodiscard]] Scalar approach_deceleration(const Limits<kLevel, N, Scalar>& limits, int i) noexcept {
  const Scalar most = limits.bounds().acceleration.coeff(i);
  const Scalar part = Scalar(0.8) * most;  // The remaining acceleration corrects deviations from v.
  if (kLevel == Level::kAcceleration || !limits.bounds_jerk(i)) return part;
  return std::min(part, Scalar(0.95) * limits.jerk_limited(i).change(most * limits.tick()));
}

/// Reduces the errors of the posture tasks of a stack by the smallest fraction of all joints (JointApproach), so that
/// the joints move along a straight line and arrive together. At velocity level, limits slow all levels together
/// (followable_fraction()). Therefore the error of a lower level is within the error bound instead, so that the motion
/// to a far posture does not slow the first level. correction: after begin(). displacement(joint): of a joint since
/// begin() [rad] or [m].
template <Level kLevel, typename Space, typename Arm, typename Limits, typename Correction, typename Displacement>
void approach_postures([[maybe_unused]] const Arm& arm, [[maybe_unused]] const Limits& limits,
                       [[maybe_unused]] Correction& correction,
                       [[maybe_unused]] const Displacement& displacement) noexcept {
  if constexpr (kIsProduct<Space>) {
    using Scalar = typename Arm::Scalar;
    const auto& bounds = limits.bounds();
    Space::each([&](auto space, auto i, int row) noexcept {
      if constexpr (kIsJointSpace<decltype(space)>) {
        constexpr std::size_t kIndex = decltype(i)::value;
        const auto& task = std::get<kIndex>(arm.stack().tasks());
        constexpr bool kBounded = kLevel == Level::kVelocity && kIndex >= static_cast<std::size_t>(Space::kFirst);
        const auto error = [&](int r) noexcept {
          return correction.error().coeff(row + r) - (kBounded ? Scalar(0) : displacement(task.joint(r)));
        };
        Scalar fraction(1);
        if constexpr (kBounded) {
          Scalar square(0);
          for (int r = 0; r < rows_of(task); ++r) square += error(r) * error(r);
          fraction = std::min(fraction, correction.error_bound() / std::sqrt(square));
        }
        for (int r = 0; r < rows_of(task) && !kBounded; ++r) {
          const int joint = task.joint(r);
          const JointApproach<kLevel, Scalar> approach{task.gains, bounds.velocity.coeff(joint),
                                                       approach_deceleration(limits, joint), bounds.jerk.coeff(joint)};
          const Scalar joint_fraction = approach.fraction(std::abs(error(r)));
          if (!(fraction <= joint_fraction)) fraction = joint_fraction;
        }
        if (fraction == Scalar(1)) return;
        for (int r = 0; r < rows_of(task); ++r) {
          correction.reduce(row + r, (Scalar(1) - fraction) * error(r), kIndex < Space::kFirst);
        }
      }
    });
  }
}

}  // namespace fpbm
