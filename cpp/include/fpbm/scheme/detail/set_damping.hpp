#pragma once

#include <type_traits>
#include <utility>

#include "fpbm/core/detail/mask.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/singular/damping.hpp"

namespace fpbm {

/// Damping for a scheme without its own damping.
template <typename Scalar = double>
struct DefaultDamping {
  SingularDamping<Scalar> singular;  ///< Damping near singular postures.
  Scalar null_space;                 ///< Null-space damping kₙ, at acceleration level only [1/s]. 0: none.
  JointBits continuous = 0;          ///< Continuous joints of the arm, for the null space of the scheme.
};

/// Sets the continuous joints of a scheme that has a member `null_space`, or of the scheme that a wrapper has. No
/// effect on other schemes.
template <typename Scheme>
auto set_continuous_joints(Scheme& scheme, JointBits joints, int)
    -> decltype(scheme.null_space.with_continuous_joints(joints), void()) {
  scheme.null_space = scheme.null_space.with_continuous_joints(joints);
}
template <typename Scheme>
auto set_continuous_joints(Scheme& scheme, JointBits joints, int)
    -> decltype(set_continuous_joints(scheme.scheme, joints, 0), void()) {
  set_continuous_joints(scheme.scheme, joints, 0);
}
template <typename Scheme>
void set_continuous_joints(Scheme&, JointBits, long) {}

/// Whether a scheme has the members of this library for its damping: `singular`, and at acceleration level
/// `null_space`.
template <typename Scheme, Level = Scheme::kLevel, typename = void>
inline constexpr bool kHasDamping = false;
template <typename Scheme>
inline constexpr bool kHasDamping<Scheme, Level::kVelocity, std::void_t<decltype(Scheme::singular)>> = true;
template <typename Scheme>
inline constexpr bool
    kHasDamping<Scheme, Level::kAcceleration, std::void_t<decltype(Scheme::singular), decltype(Scheme::null_space)>> =
        true;

/// Sets the damping that a scheme does not have. If the radius of the scheme is 0, sets the damping near singular
/// postures. At acceleration level, if the null-space damping of the scheme is 0, sets the null-space damping. With
/// lanes, call set_damping() for the scheme of each lane.
///
/// A scheme type without the members for damping needs an overload in its own namespace before it can be used in a
/// Tracker or an AnyScheme:
///
///   void set_damping(MyScheme& scheme, const fpbm::DefaultDamping<>& damping);
///
/// An empty body states that the scheme has no damping.
template <typename Scheme, typename Scalar>
std::enable_if_t<kHasDamping<Scheme>> set_damping(Scheme& scheme, const DefaultDamping<Scalar>& damping) {
  static_assert(!kInLanes<Scalar>, "call set_damping() for each lane's scheme");
  if (scheme.singular.radius() == Scalar(0)) scheme.singular = damping.singular;
  if constexpr (Scheme::kLevel == Level::kAcceleration) {
    if (scheme.null_space.damping() == Scalar(0)) {
      scheme.null_space = scheme.null_space.with_damping(damping.null_space);
    }
  }
  set_continuous_joints(scheme, damping.continuous, 0);
}

/// set_damping() for a wrapper with a member `scheme`, for example ManipulabilityAscent.
template <typename Scheme, typename Scalar>
auto set_damping(Scheme& scheme, const DefaultDamping<Scalar>& damping)
    -> decltype(set_damping(scheme.scheme, damping)) {
  set_damping(scheme.scheme, damping);
}

/// Whether set_damping() is defined for a scheme.
template <typename Scheme, typename Scalar, typename = void>
inline constexpr bool kTakesDamping = false;
template <typename Scheme, typename Scalar>
inline constexpr bool kTakesDamping<
    Scheme, Scalar,
    std::void_t<decltype(set_damping(std::declval<Scheme&>(), std::declval<const DefaultDamping<Scalar>&>()))>> = true;

/// set_damping(). If set_damping() is not defined for the scheme, the compiler prints a message.
template <typename Scheme, typename Scalar>
void give_damping(Scheme& scheme, const DefaultDamping<Scalar>& damping) {
  static_assert(
      kTakesDamping<Scheme, Scalar>,
      "set_damping() is not defined for this scheme: add the members `singular` and `null_space`, or declare "
      "set_damping(MyScheme&, const fpbm::DefaultDamping<>&) in the namespace of the scheme; an empty body means no "
      "damping");
  if constexpr (kTakesDamping<Scheme, Scalar>) set_damping(scheme, damping);
}

}  // namespace fpbm
