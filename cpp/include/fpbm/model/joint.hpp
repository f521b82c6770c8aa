#pragma once

#include <limits>
#include <string>

#include "fpbm/core/rotation.hpp"
#include "fpbm/core/types.hpp"

namespace fpbm {

enum class JointType : unsigned char {
  kRevolute,    ///< Turns, within bounds [rad].
  kContinuous,  ///< Turns, unbounded.
  kPrismatic,   ///< Slides [m].
};

/// Bounds on the motion of one joint; infinite where there is none.
template <typename Scalar = double>
struct JointBounds {
  static constexpr Scalar kNone = std::numeric_limits<Scalar>::infinity();

  Scalar lower = -kNone;        ///< [rad] or [m]
  Scalar upper = kNone;         ///< [rad] or [m]
  Scalar velocity = kNone;      ///< Either way [rad/s] or [m/s].
  Scalar acceleration = kNone;  ///< Either way [rad/s²] or [m/s²].
  Scalar jerk = kNone;          ///< Either way [rad/s³] or [m/s³].
  /// Toward an end, the velocity is at most −velocity_offset + √(2 deceleration · distance to it).
  Scalar velocity_offset = 0;   ///< [rad/s] or [m/s]
  Scalar deceleration = kNone;  ///< [rad/s²] or [m/s²]
};

/// Coupling of a joint to another, its leader: position = ratio · leader's position + offset.
template <typename Scalar = double>
struct Mimic {
  int joint = -1;  ///< The leader's index in the chain, or −1: a joint with a drive of its own.
  Scalar ratio = 1;
  Scalar offset = 0;  ///< [rad] or [m]
};

/// One joint of a chain. Its name, for messages, is a std::string, or a std::string_view of a text that outlives it.
template <typename Scalar = double, typename Name = std::string>
struct Joint {
  JointType type = JointType::kRevolute;
  Transform<Scalar> placement = {};  ///< The joint's frame in that of the joint before, both at zero.
  Vector<3, Scalar> axis = {Scalar(0), Scalar(0), Scalar(1)};  ///< In the joint's frame; its length does not matter.
  JointBounds<Scalar> bounds = {};
  Name name = {};
  Mimic<Scalar> mimic = {};
};

/// Bounds on the motion of all joints of an arm; infinite where there is none.
template <int N, typename Scalar = double>
struct JointLimits {
  Vector<N, Scalar> lower;                                  ///< [rad] or [m]
  Vector<N, Scalar> upper;                                  ///< [rad] or [m]
  Vector<N, Scalar> velocity;                               ///< [rad/s] or [m/s]
  Vector<N, Scalar> acceleration;                           ///< [rad/s²] or [m/s²]
  Vector<N, Scalar> jerk = unbounded(acceleration.size());  ///< [rad/s³] or [m/s³]
  /// As in JointBounds [rad/s, rad/s²] or [m/s, m/s²].
  Vector<N, Scalar> velocity_offset = filled<Vector<N, Scalar>>(acceleration.size());
  Vector<N, Scalar> deceleration = unbounded(acceleration.size());

  /// No bounds at all, for dof joints.
  [[nodiscard]] static JointLimits none(Eigen::Index dof) {
    const Vector<N, Scalar> infinite = unbounded(dof);
    return {filled<Vector<N, Scalar>>(dof, -JointBounds<Scalar>::kNone), infinite, infinite, infinite};
  }

  template <typename Other>
  [[nodiscard]] JointLimits<N, Other> cast() const {
    return {lower.template cast<Other>(),        upper.template cast<Other>(), velocity.template cast<Other>(),
            acceleration.template cast<Other>(), jerk.template cast<Other>(),  velocity_offset.template cast<Other>(),
            deceleration.template cast<Other>()};
  }

  /// Sets the bounds of joint i.
  void set(Eigen::Index i, const JointBounds<Scalar>& bounds) noexcept {
    lower(i) = bounds.lower;
    upper(i) = bounds.upper;
    velocity(i) = bounds.velocity;
    acceleration(i) = bounds.acceleration;
    jerk(i) = bounds.jerk;
    velocity_offset(i) = bounds.velocity_offset;
    deceleration(i) = bounds.deceleration;
  }

  /// The bounds of joint i.
  [[nodiscard]] JointBounds<Scalar> joint(Eigen::Index i) const noexcept {
    return {lower(i), upper(i), velocity(i), acceleration(i), jerk(i), velocity_offset(i), deceleration(i)};
  }

  /// The same, with no bound where the last three have not been given a size.
  [[nodiscard]] JointLimits complete() const {
    const JointLimits given{lower, upper, velocity, acceleration};
    JointLimits all = *this;
    if (jerk.size() == 0) all.jerk = given.jerk;
    if (velocity_offset.size() == 0) all.velocity_offset = given.velocity_offset;
    if (deceleration.size() == 0) all.deceleration = given.deceleration;
    return all;
  }

  /// No bound, for dof joints.
  [[nodiscard]] static Vector<N, Scalar> unbounded(Eigen::Index dof) {
    return filled<Vector<N, Scalar>>(dof, JointBounds<Scalar>::kNone);
  }
};

}  // namespace fpbm
