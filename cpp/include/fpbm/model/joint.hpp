#pragma once

#include <limits>
#include <string>

#include "fpbm/core/types.hpp"
#include "fpbm/geometry/rotation.hpp"

namespace fpbm {

enum class JointType : unsigned char {
  kRevolute,    ///< Rotates within bounds [rad].
  kContinuous,  ///< Rotates without bounds [rad].
  kPrismatic,   ///< Translates [m].
};

/// Bounds on the motion of one joint, infinite if there is no bound.
template <typename Scalar = double>
struct JointBounds {
  static constexpr Scalar kNone = std::numeric_limits<Scalar>::infinity();
  /// c J/A² of the braking envelope of a joint with a bound on jerk and without a given envelope: the velocity v toward
  /// an end at the distance D is bounded by v²/2A + v c/A ≤ D (docs/tick.md, Bounds on jerk). At least 1 is necessary.
  /// With 2, a stop along the envelope needs jerks of at most A²/c = J/2.
  static constexpr Scalar kOffset = Scalar(2);

  Scalar lower = -kNone;        ///< [rad] or [m]
  Scalar upper = kNone;         ///< [rad] or [m]
  Scalar velocity = kNone;      ///< In both directions [rad/s] or [m/s].
  Scalar acceleration = kNone;  ///< In both directions [rad/s²] or [m/s²].
  Scalar jerk = kNone;          ///< In both directions [rad/s³] or [m/s³].
  /// Braking envelope: toward an end, the velocity is at most −velocity_offset + √(2 deceleration · distance to the
  /// end).
  Scalar velocity_offset = 0;   ///< [rad/s] or [m/s]
  Scalar deceleration = kNone;  ///< [rad/s²] or [m/s²]
  Scalar effort = kNone;        ///< Torque or force, in both directions [Nm] or [N].
};

/// Coupling of a joint to another joint, the leader: position = ratio · position of the leader + offset.
template <typename Scalar = double>
struct Mimic {
  int joint = -1;  ///< Index of the leader in the chain, or −1 for a joint with a drive.
  Scalar ratio = 1;
  Scalar offset = 0;  ///< [rad] or [m]
};

/// Inertia of a link, in the frame of the link.
template <typename Scalar = double>
struct LinkInertia {
  Scalar mass = 0;                                               ///< [kg]
  Vector<3, Scalar> centre = {Scalar(0), Scalar(0), Scalar(0)};  ///< Centre of mass [m].
  /// Rotational inertia about the centre of mass, along the axes of the frame [kg m²].
  Matrix<3, 3, Scalar> inertia = filled<Matrix<3, 3, Scalar>>(3);
};

/// Inertia and friction of the drive of a joint. The torque of the drive is M q̈ + h + viscous q̇ + dry sign(q̇).
template <typename Scalar = double>
struct JointDrive {
  Scalar rotor_inertia = 0;  ///< Inertia of the rotor times the square of the gear ratio [kg m²] or [kg].
  Scalar viscous = 0;        ///< [Nm s/rad] or [N s/m]
  Scalar dry = 0;            ///< [Nm] or [N]
};

/// One joint of a chain. The name, for messages, is a std::string, or a std::string_view of a text that must outlive
/// the joint.
template <typename Scalar = double, typename Name = std::string>
struct Joint {
  JointType type = JointType::kRevolute;
  Transform<Scalar> placement = {};  ///< Frame of the joint in the frame of the previous joint, both at position zero.
  Vector<3, Scalar> axis = {Scalar(0), Scalar(0), Scalar(1)};  ///< In the frame of the joint, of any length.
  JointBounds<Scalar> bounds = {};
  Name name = {};
  Mimic<Scalar> mimic = {};
  LinkInertia<Scalar> moved =
      {};  ///< The link that the joint moves. Its frame is the frame of the joint after the motion.
  JointDrive<Scalar> drive = {};
};

/// Bounds on the motion of all joints of an arm, infinite if there is no bound.
template <int N, typename Scalar = double>
struct JointLimits {
  Vector<N, Scalar> lower;                                  ///< [rad] or [m]
  Vector<N, Scalar> upper;                                  ///< [rad] or [m]
  Vector<N, Scalar> velocity;                               ///< [rad/s] or [m/s]
  Vector<N, Scalar> acceleration;                           ///< [rad/s²] or [m/s²]
  Vector<N, Scalar> jerk = unbounded(acceleration.size());  ///< [rad/s³] or [m/s³]
  /// See JointBounds. [rad/s, rad/s²] or [m/s, m/s²]
  Vector<N, Scalar> velocity_offset = filled<Vector<N, Scalar>>(acceleration.size());
  Vector<N, Scalar> deceleration = unbounded(acceleration.size());
  Vector<N, Scalar> effort = unbounded(acceleration.size());  ///< [Nm] or [N]
  /// Bits of the continuous joints: joints that rotate without bounds, so that positions that differ by 2π are equal. A
  /// joint with a finite bound is never continuous.
  JointBits continuous = 0;

  /// Limits of dof joints without bounds.
  [[nodiscard]] static JointLimits none(Eigen::Index dof) {
    const Vector<N, Scalar> infinite = unbounded(dof);
    return {filled<Vector<N, Scalar>>(dof, -JointBounds<Scalar>::kNone), infinite, infinite, infinite};
  }

  template <typename Other>
  [[nodiscard]] JointLimits<N, Other> cast() const {
    return {lower.template cast<Other>(),        upper.template cast<Other>(),  velocity.template cast<Other>(),
            acceleration.template cast<Other>(), jerk.template cast<Other>(),   velocity_offset.template cast<Other>(),
            deceleration.template cast<Other>(), effort.template cast<Other>(), continuous};
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
    effort(i) = bounds.effort;
  }

  /// The bounds of joint i.
  [[nodiscard]] JointBounds<Scalar> joint(Eigen::Index i) const noexcept {
    return {lower(i), upper(i), velocity(i), acceleration(i), jerk(i), velocity_offset(i), deceleration(i), effort(i)};
  }

  /// Copy of the limits. If jerk, velocity_offset, deceleration or effort has no entries, the copy has no bounds of
  /// this kind.
  [[nodiscard]] JointLimits complete() const {
    const JointLimits given{lower, upper, velocity, acceleration};
    JointLimits all = *this;
    if (jerk.size() == 0) all.jerk = given.jerk;
    if (velocity_offset.size() == 0) all.velocity_offset = given.velocity_offset;
    if (deceleration.size() == 0) all.deceleration = given.deceleration;
    if (effort.size() == 0) all.effort = given.effort;
    return all;
  }

  /// Infinite entries for dof joints.
  [[nodiscard]] static Vector<N, Scalar> unbounded(Eigen::Index dof) {
    return filled<Vector<N, Scalar>>(dof, JointBounds<Scalar>::kNone);
  }
};

}  // namespace fpbm
