#pragma once

#include <type_traits>
#include <utility>

#include "fpbm/core/detail/validation.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/simulate/detail/stability.hpp"
#include "fpbm/task/detail/task_gains.hpp"

namespace fpbm {

/// Properties of a tick that determine whether the gains of a scheme are stable.
template <typename Scalar = double>
struct TickOfGains {
  Scalar dt;                ///< Length of the tick [s].
  Scalar integral_gain;     ///< kᵢ [1/s³], or [1/s²] at velocity level.
  bool null_space = false;  ///< Whether the gains belong to the null space, to which continue_tick() does not apply.
};

/// Gains of one error with their names: k₁ [1/s] and k₂ [1/s²], or k₂ alone [1/s] at velocity level.
template <typename Scalar>
struct NamedGains {
  const char* name1;
  Scalar k1;
  const char* name2;
  Scalar k2;
};

/// Throws std::invalid_argument if a tick with these gains does not damp the error (simulate/detail/stability.hpp).
template <Level kLevel, typename Scalar>
void require_stable_gains(const NamedGains<Scalar>& gains, const TickOfGains<Scalar>& tick) {
  const auto& [name1, k1, name2, k2] = gains;
  const Scalar h = tick.dt;
  const Scalar integral = tick.integral_gain;
  // The gains factor · k₁ and factor² · k₂ (velocity level: factor · k) scale the time of the error dynamics: the error
  // decays more slowly by this factor.
  const auto stable = [&](Scalar factor, Scalar ki) {
    if constexpr (kLevel == Level::kVelocity) {
      const Scalar x1 = factor * gains.k2 * h;
      const Scalar x3 = ki * h * h;
      return is_stable_velocity(x1, x3) && (!tick.null_space || is_stable_velocity_of_middle(x1));
    } else {
      const Scalar x1 = factor * gains.k1 * h;
      const Scalar x2 = factor * factor * gains.k2 * h * h;
      const Scalar x3 = ki * h * h * h;
      if (!is_stable_acceleration(x1, x2, x3)) return false;
      return tick.null_space ? is_stable_acceleration_of_middle(x1, x2) : is_stable_acceleration_of_levels(x1, x2, x3);
    }
  };
  if (!stable(Scalar(1), Scalar(0))) {
    const Scalar factor = largest_factor<Scalar>([&](Scalar s) { return stable(s, Scalar(0)); });
    const Scalar square = kLevel == Level::kVelocity ? factor : factor * factor;
    if (!(k1 > Scalar(0))) {
      validation::fail(name2, k2, "at most ", square * k2, " at a tick of ", h,
                       " s: lower the gain, or shorten the tick");
    }
    if (!(k2 > Scalar(0))) {
      validation::fail(name1, k1, "at most ", factor * k1, " at a tick of ", h,
                       " s: lower the gain, or shorten the tick");
    }
    validation::fail(name1, k1, "at most ", factor * k1, " with ", name2, " = ", square * k2, " at a tick of ", h,
                     " s: lower both gains, or shorten the tick");
  }
  if (integral != Scalar(0) && !stable(Scalar(1), integral)) {
    const Scalar most = integral * largest_factor<Scalar>([&](Scalar s) { return stable(Scalar(1), s * integral); });
    validation::fail("integral_gain", integral, "at most ", most, " with the scheme's feedback gains at a tick of ", h,
                     " s: lower the gain, or raise ", kLevel == Level::kVelocity ? name2 : name1);
  }
}

/// Largest stiffness kₚh² of the null space at acceleration level. RK4 is stable up to 6, but a stiff spring moves the
/// joints so far within a tick that its acceleration disturbs the task in the new posture. Of 18 rest postures, 0.3
/// rad per joint from the start posture, with critical damping at 1 ms, none loses the task at 0.03, two at 0.1 and
/// five at 0.25 (TickGains.a_stiff_rest_posture_does_not_change_the_task).
inline constexpr double kSpring = 0.1;

/// Whether a scheme has the members of this library for its parameters.
template <typename Scheme, typename = void>
inline constexpr bool kWraps = false;
template <typename Scheme>
inline constexpr bool kWraps<Scheme, std::void_t<decltype(Scheme::scheme)>> = true;
template <typename Scheme, typename = void>
inline constexpr bool kHasGains = false;
template <typename Scheme>
inline constexpr bool kHasGains<Scheme, std::void_t<decltype(Scheme::k1), decltype(Scheme::k2)>> = true;
template <typename Scheme, typename = void>
inline constexpr bool kKnowsGains = false;
template <typename Scheme>
inline constexpr bool kKnowsGains<Scheme, std::void_t<decltype(std::declval<const Scheme&>().gains())>> = true;
template <typename Scheme, typename = void>
inline constexpr bool kHasGain = false;
template <typename Scheme>
inline constexpr bool kHasGain<Scheme, std::void_t<decltype(Scheme::k)>> = true;
template <typename Scheme, typename = void>
inline constexpr bool kHasSprings = false;
template <typename Scheme>
inline constexpr bool kHasSprings<Scheme, std::void_t<decltype(Scheme::null_space.stiffness_range())>> = true;

/// Feedback gains of a scheme, or zero for a scheme without the members of this library.
template <typename Scalar, typename Scheme>
[[nodiscard]] TaskGains<Scalar> gains_of(const Scheme& scheme) noexcept {
  if constexpr (kWraps<Scheme>) {
    return gains_of<Scalar>(scheme.scheme);
  } else if constexpr (kHasGains<Scheme>) {
    return TaskGains<Scalar>::unchecked(scheme.k1, scheme.k2);
  } else if constexpr (kHasGain<Scheme>) {
    return TaskGains<Scalar>::unchecked(Scalar(0), scheme.k);
  } else if constexpr (kKnowsGains<Scheme>) {
    return scheme.gains();
  } else {
    return TaskGains<Scalar>::unchecked(Scalar(0), Scalar(0));
  }
}

/// Throws std::invalid_argument if a tick does not damp the errors that a scheme feeds back: the task error, with k₁
/// and k₂ or k, and with the tracker's integral; the null-space error, with the smallest and the largest stiffness of
/// the joints. Accepts a scheme without gains. For a scheme type of your own, an overload in its namespace is used.
template <typename Scheme, typename Scalar>
void require_stable(const Scheme& scheme, const TickOfGains<Scalar>& tick) {
  constexpr Level kLevel = Scheme::kLevel;
  const TickOfGains<Scalar> of_null_space{tick.dt, Scalar(0), true};
  const Scalar none(0);
  if constexpr (kWraps<Scheme>) {
    require_stable(scheme.scheme, tick);
  } else {
    if constexpr (kLevel == Level::kAcceleration && kHasGains<Scheme>) {
      require_stable_gains<kLevel, Scalar>({"k1", scheme.k1, "k2", scheme.k2}, tick);
    }
    if constexpr (kLevel == Level::kVelocity && kHasGain<Scheme>) {
      require_stable_gains<kLevel, Scalar>({"", none, "k", scheme.k}, tick);
    }
    if constexpr (kHasSprings<Scheme>) {
      const Scalar damping = kLevel == Level::kVelocity ? none : scheme.null_space.damping();
      const auto [least, most] = scheme.null_space.stiffness_range();
      if (const Scalar square = tick.dt * tick.dt;
          kLevel == Level::kAcceleration && !(most * square <= Scalar(kSpring))) {
        validation::fail("null_stiffness", most, "at most ", Scalar(kSpring) / square, " at a tick of ", tick.dt,
                         " s: lower the gain, or shorten the tick");
      }
      require_stable_gains<kLevel, Scalar>({"null_damping", damping, "null_stiffness", most}, of_null_space);
      require_stable_gains<kLevel, Scalar>({"null_damping", damping, "null_stiffness", least}, of_null_space);
    }
  }
}

}  // namespace fpbm
