#pragma once

#include <array>
#include <utility>

#include "fpbm/core/detail/has_member.hpp"
#include "fpbm/core/detail/validation.hpp"
#include "fpbm/linalg/detail/product.hpp"
#include "fpbm/linalg/detail/sums.hpp"
#include "fpbm/model/detail/composite_inertia.hpp"
#include "fpbm/model/detail/gravity_torque.hpp"
#include "fpbm/model/detail/link_pairs.hpp"
#include "fpbm/model/detail/newton_euler.hpp"
#include "fpbm/model/detail/physical_inertia.hpp"
#include "fpbm/model/robot.hpp"

namespace fpbm {

/// Dynamics of a robot with a fixed base:
///
///   τ = M(q) q̈ + h(q, q̇),   h(q, q̇) = C(q, q̇) q̇ + g(q) + viscous friction,
///
/// by the recursive Newton-Euler algorithm and the composite-rigid-body algorithm (Featherstone 2008), on the
/// placements of RobotState (docs/dynamics.md). M includes the inertia of the rotors. Dry friction (JointDrive::dry) is
/// not in τ: its sign is not known at rest. Joints that follow a drive add to the torque of the drive.
///
/// Call Robot::update(q, qd, state) once, then any of the functions with this state. Torques are in Nm, or N for
/// prismatic joints. Immutable, except for the payload.
template <int N, typename Scalar_ = double, int Joints = N>
class Dynamics {
 public:
  using Scalar = Scalar_;
  using JointVector = Vector<N, Scalar>;
  using JointMatrix = Matrix<N, N, Scalar>;
  using Vector3 = Vector<3, Scalar>;
  using Robot_ = Robot<N, Scalar, Joints>;
  using State = RobotState<N, Scalar, Joints>;
  static constexpr int kDof = N;
  /// Standard gravity, rounded as in Pinocchio and MuJoCo [m/s²].
  static constexpr Scalar kGravity = Scalar(9.81);

  /// source: the Tree or the Chain of the robot. gravity: in the base frame, by default along −z [m/s²]. Throws
  /// std::invalid_argument under the conditions of Robot, if gravity is not finite, or if the inertia of a link is not
  /// physical: not symmetric, or principal moments that are negative or violate the triangle inequality. Links may have
  /// no mass.
  template <typename Source>
  explicit Dynamics(const Source& source, const Vector3& gravity = {Scalar(0), Scalar(0), -kGravity})
      : robot_(source), gravity_(gravity) {
    validation::require_finite("gravity", gravity);
    if constexpr (kHas<Source, TipOf>) tip_link_ = robot_.joints();
    for (int link = 1; link <= robot_.joints(); ++link) {
      const auto& joint = joint_of(source, link - 1);
      require_physical(chain_check::name_of(source, link - 1) + ".moved", joint.moved);
      pairs_.set_joint(robot_, link, joint.drive);
      set_link(link, placed(robot_.in_joint(link, {}), joint.moved));
    }
  }

  [[nodiscard]] const Robot_& robot() const noexcept { return robot_; }
  [[nodiscard]] int dof() const noexcept { return robot_.dof(); }
  /// Acceleration of gravity in the base frame [m/s²].
  [[nodiscard]] const Vector3& gravity() const noexcept { return gravity_; }
  /// Inertia of a link, 1 to Robot::joints(), with the payload, relative to the placement of the joint of the link.
  [[nodiscard]] const LinkInertia<Scalar>& link(int link) const noexcept { return links_[index(link)]; }

  /// Fixes a payload to a link, and removes the previous payload. A payload without mass and inertia removes only. May
  /// be called in a control loop: no heap allocation.
  ///
  /// link: 1 to Robot::joints(), or Robot::kTip for a chain. load: inertia of the payload in a frame of the link.
  /// offset: this frame in the frame of the link, or of the tip. Returns false, without effect, if the link does not
  /// exist, or the inertia is not physical (see the constructor).
  bool set_payload(int link, const LinkInertia<Scalar>& load, const Transform<Scalar>& offset = {}) noexcept {
    const int number = link == Robot_::kTip ? tip_link_ : link;
    if (number < 1 || number > robot_.joints()) return false;
    const LinkInertia<Scalar> seen = placed(robot_.in_joint(link, offset), load);
    if (fault_of(seen) != InertiaFault::kNone) return false;
    if (loaded_ > 0) set_link(loaded_, unloaded_);
    loaded_ = number;
    unloaded_ = links_[index(number)];
    set_link(number, joined(unloaded_, seen));
    return true;
  }

  /// τ of the drives for the accelerations qdd [rad/s²] or [m/s²]. state: from Robot::update(q, qd, state).
  [[nodiscard]] JointVector inverse_dynamics(const State& state, const JointVector& qdd) const noexcept {
    const Vector<Joints, Scalar> accelerations = robot_.drives().rates(qdd);
    Vector<Joints, Scalar> torques;
    pairs_.is_tree ? newton_euler<true>(robot_, pairs_, state, accelerations, gravity_, torques)
                   : newton_euler<false>(robot_, pairs_, state, accelerations, gravity_, torques);
    return robot_.drives().by_drive(torques);
  }
  /// h(q, q̇).
  [[nodiscard]] JointVector bias(const State& state) const noexcept {
    return inverse_dynamics(state, filled<JointVector>(dof()));
  }
  /// g(q), the torque at rest.
  [[nodiscard]] JointVector gravity_torque(const State& state) const noexcept {
    Vector<Joints, Scalar> torques;
    gravity_torques(robot_, pairs_, state, gravity_, torques);
    return robot_.drives().by_drive(torques);
  }
  /// M(q), symmetric. Positive definite if every drive moves a mass or has rotor inertia (require_inertia()).
  [[nodiscard]] JointMatrix mass_matrix(const State& state) const noexcept {
    Matrix<Joints, Joints, Scalar> of_joints;
    pairs_.is_tree ? composite_inertia<true>(robot_, pairs_, state, of_joints)
                   : composite_inertia<false>(robot_, pairs_, state, of_joints);
    if constexpr (N != Joints) {
      return of_drives(of_joints);
    } else {
      if constexpr (N == Eigen::Dynamic) {
        if (robot_.drives().follows()) return of_drives(of_joints);
      }
      return of_joints;
    }
  }

  /// ½ q̇ᵀM q̇ [J], rotors included.
  [[nodiscard]] Scalar kinetic_energy(const State& state) const noexcept {
    return dot(state.qd, product(mass_matrix(state), state.qd)) / Scalar(2);
  }
  /// Potential energy in gravity of the links that joints move [J], 0 if all centres of mass are at the origin of the
  /// base frame.
  [[nodiscard]] Scalar potential_energy(const State& state) const noexcept {
    Scalar energy(0);
    for (int link = 1; link <= robot_.joints(); ++link) {
      const auto& [mass, centre, inertia] = links_[index(link)];
      energy -= mass * dot(gravity_, robot_.point(state, link, centre));
    }
    return energy;
  }

 private:
  template <typename Source>
  using TipOf = decltype(std::declval<Source>().tip);

  [[nodiscard]] static std::size_t index(int i) noexcept { return static_cast<std::size_t>(i); }

  void set_link(int link, const LinkInertia<Scalar>& inertia) noexcept {
    links_[index(link)] = inertia;
    pairs_.set_link(robot_, link, inertia);
  }

  /// GᵀM G, where G has the velocity of each joint per velocity of each drive.
  [[nodiscard]] JointMatrix of_drives(const Matrix<Joints, Joints, Scalar>& M) const noexcept {
    Matrix<Joints, N, Scalar> half;
    JointMatrix result;
    robot_.drives().set_by_drive(M, half);
    robot_.drives().set_by_drive(transpose_of(half), result);
    for (Eigen::Index j = 1; j < result.cols(); ++j) {  // Equal up to round-off.
      for (Eigen::Index i = 0; i < j; ++i) result.coeffRef(j, i) = result.coeff(i, j);
    }
    return result;
  }

  Robot_ robot_;
  Vector3 gravity_;
  LinkPairs<N, Scalar, Joints> pairs_;
  /// Relative to the placements of the joints. Entry 0, the base, is not used.
  std::array<LinkInertia<Scalar>, static_cast<std::size_t>(kCapacity<Joints>) + 1> links_;
  LinkInertia<Scalar> unloaded_;  ///< The link with the payload, without the payload.
  int loaded_ = 0;                ///< Number of the link with the payload, or 0.
  int tip_link_ = 0;              ///< Number of the link with the tip of a chain, or 0.
};

/// Throws std::invalid_argument if a drive moves no link with mass or inertia and has no rotor inertia: M would be
/// singular. source: a Tree or a Chain. The message names the joint.
template <typename Source>
void require_inertia(const Source& source) {
  const auto count = static_cast<Eigen::Index>(source.joints.size());
  JointBits moving = 0;   // Joints that move a mass.
  JointBits driving = 0;  // Drives with inertia, of their own or of a joint that follows.
  for (Eigen::Index i = count; i-- > 0;) {
    const auto& joint = joint_of(source, i);
    const auto& [mass, centre, inertia] = joint.moved;
    const bool has_inertia = mass > 0 || largest_magnitude(inertia) > 0;
    if (has_inertia || (moving >> i & 1U) != 0) {
      moving |= joint_bit(i);
      if (const int carrier = parent_of(source, i); carrier > 0) moving |= joint_bit(carrier - 1);
    }
    if ((moving >> i & 1U) == 0 && !(joint.drive.rotor_inertia > 0)) continue;
    if (joint.mimic.joint < 0) driving |= joint_bit(i);
    if (joint.mimic.joint >= 0 && joint.mimic.ratio != 0) driving |= joint_bit(joint.mimic.joint);
  }
  for (Eigen::Index i = 0; i < count; ++i) {
    if (joint_of(source, i).mimic.joint >= 0 || (driving >> i & 1U) != 0) continue;
    validation::reject(chain_check::name_of(source, i),
                       " moves no mass and has no rotor inertia: give the mass of a link that the joint moves");
  }
}

}  // namespace fpbm
