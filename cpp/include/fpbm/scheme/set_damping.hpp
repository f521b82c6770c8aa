#pragma once

#include <type_traits>

#include "fpbm/singular/damping.hpp"

namespace fpbm {

/// Whether a scheme wraps another, its member `scheme`.
template <typename Scheme, typename = void>
inline constexpr bool kIsWrapper = false;
template <typename Scheme>
inline constexpr bool kIsWrapper<Scheme, std::void_t<decltype(Scheme::scheme)>> = true;

/// Whether a scheme has a member `singular`, its damping near singular postures.
template <typename Scheme, typename = void>
inline constexpr bool kTakesDamping = false;
template <typename Scheme>
inline constexpr bool kTakesDamping<Scheme, std::void_t<decltype(Scheme::singular)>> = true;

/// Sets the damping of a scheme, through its wrappers, unless the scheme has its own.
template <typename Scheme, typename Scalar>
void set_damping(Scheme& scheme, const SingularDamping<Scalar>& damping) noexcept {
  if constexpr (kIsWrapper<Scheme>) {
    set_damping(scheme.scheme, damping);
  } else if constexpr (kTakesDamping<Scheme>) {
    if (scheme.singular.radius() == Scalar(0)) scheme.singular = damping;
  }
}

}  // namespace fpbm
