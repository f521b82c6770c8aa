#pragma once

#include <array>

#include "fpbm/core/detail/validation.hpp"
#include "fpbm/linalg/detail/entrywise.hpp"
#include "fpbm/linalg/detail/sums.hpp"
#include "fpbm/model/robot.hpp"

namespace fpbm {

/// Dynamics of a robot with a fixed base:
///
///   τ = M(q) q̈ + h(q, q̇),   h(q, q̇) = C(q, q̇) q̇ + g(q) + friction,
///
/// by the recursive Newton-Euler algorithm and the composite-rigid-body algorithm (Featherstone 2008), in the base
/// frame, on the placements of RobotState (docs/dynamics.md). Joints that follow a drive add to the torque of the
/// drive. Immutable, except for the payload.
///
/// Torques are in Nm, or N for prismatic joints.
template <int N, typename Scalar_ = double, int Joints = N>
class Dynamics {
 public:
  using Scalar = Scalar_;
  using JointVector = Vector<N, Scalar>;
  using JointMatrix = Matrix<N, N, Scalar>;
  using Vector3 = Vector<3, Scalar>;
  using State = RobotState<N, Scalar, Joints>;
  static constexpr int kDof = N;
  /// Standard gravity along −z, rounded as in Pinocchio and MuJoCo [m/s²].
  static constexpr Scalar kGravity = Scalar(9.81);

  /// source: the Tree or the Chain of the robot. gravity: in the base frame [m/s²]. Throws std::invalid_argument under
  /// the conditions of Robot.
  template <typename Source>
  explicit Dynamics(const Source& source, const Vector3& gravity = {Scalar(0), Scalar(0), -kGravity})
      : robot_(source), gravity_(gravity) {
    for (std::size_t i = 0; i < source.joints.size(); ++i) {
      const auto& joint = joint_of(source, static_cast<Eigen::Index>(i));
      const Matrix<3, 3, Scalar> R = robot_.in_joint(static_cast<int>(i) + 1, {}).R;
      links_[i + 1] = {joint.moved.mass, times(R, joint.moved.centre),
                       times(times(R, joint.moved.inertia), transposed(R))};
      drives_[i] = joint.drive;
    }
  }

  [[nodiscard]] const Robot<N, Scalar, Joints>& robot() const noexcept { return robot_; }
  [[nodiscard]] int dof() const noexcept { return robot_.dof(); }
  /// Acceleration of gravity in the base frame [m/s²].
  [[nodiscard]] const Vector3& gravity() const noexcept { return gravity_; }

  /// τ of the drives for the accelerations qdd [rad/s²] or [m/s²]. state: from Robot::update(q, qd, state).
  [[nodiscard]] JointVector inverse_dynamics(const State& state, const JointVector& qdd) const noexcept {
    return torque<true>(state, qdd);
  }
  /// h(q, q̇).
  [[nodiscard]] JointVector bias(const State& state) const noexcept {
    return torque<true>(state, filled<JointVector>(dof()));
  }
  /// g(q), the torque at rest.
  [[nodiscard]] JointVector gravity_torque(const State& state) const noexcept {
    return torque<false>(state, filled<JointVector>(dof()));
  }
  /// M(q), symmetric and positive definite if every joint moves a mass.
  [[nodiscard]] JointMatrix mass_matrix(const State& state) const noexcept {
    JointMatrix M;
    M.resize(dof(), dof());
    State rest = state;
    rest.qd = filled<JointVector>(dof());
    for (Eigen::Index k = 0; k < dof(); ++k) {
      JointVector unit = filled<JointVector>(dof());
      unit(k) = Scalar(1);
      const JointVector g = torque<false>(state, filled<JointVector>(dof()));
      M.col(k) = torque<false>(state, unit) - g;
    }
    return M;
  }

 private:
  [[nodiscard]] static std::size_t index(Eigen::Index i) noexcept { return static_cast<std::size_t>(i); }

  template <bool kMoves>
  [[nodiscard]] JointVector torque(const State& state, const JointVector& qdd) const noexcept {
    struct Link {
      Vector3 wd, a, f, n;
    };
    std::array<Link, static_cast<std::size_t>(kCapacity<Joints>) + 1> links;
    const Vector3 zero = Vector3::Zero();
    links[0] = {zero, -gravity_, zero, zero};
    const Vector<Joints, Scalar> rates =
        kMoves ? robot_.drives().rates(state.qd) : filled<Vector<Joints, Scalar>>(robot_.joints());
    const Vector<Joints, Scalar> accelerations = robot_.drives().rates(qdd);
    for (int i = 1; i <= robot_.joints(); ++i) {
      const int p = robot_.parent(i);
      const Link& parent = links[index(p)];
      const Vector3 wp = kMoves ? state.angular_velocity(p) : zero;
      const Vector3 w = kMoves ? state.angular_velocity(i) : zero;
      const Vector3 z = state.R[index(i)].col(2);
      const Vector3 r = state.p[index(i)] - (p > 0 ? state.p[index(p)] : zero);
      const Scalar qd = rates(i - 1);
      const Scalar u = accelerations(i - 1);
      Link& link = links[index(i)];
      link.a = parent.a + cross<Scalar>(parent.wd, r) + cross<Scalar>(wp, cross<Scalar>(wp, r));
      link.wd = parent.wd;
      if (robot_.turns(i - 1)) {
        link.wd += u * z + cross<Scalar>(wp, Vector3(qd * z));
      } else {
        link.a += u * z + Scalar(2) * cross<Scalar>(wp, Vector3(qd * z));
      }
      const LinkInertia<Scalar>& body = links_[index(i)];
      const Matrix<3, 3, Scalar>& R = state.R[index(i)];
      const Vector3 c = R * body.centre;
      const Matrix<3, 3, Scalar> I = R * body.inertia * R.transpose();
      link.f = body.mass * (link.a + cross<Scalar>(link.wd, c) + cross<Scalar>(w, cross<Scalar>(w, c)));
      link.n = I * link.wd + cross<Scalar>(w, Vector3(I * w)) + cross<Scalar>(c, link.f);
    }
    Vector<Joints, Scalar> torques;
    torques.resize(robot_.joints());
    for (int i = robot_.joints(); i > 0; --i) {
      const Link& link = links[index(i)];
      const Vector3 z = state.R[index(i)].col(2);
      const JointDrive<Scalar>& drive = drives_[index(i - 1)];
      torques(i - 1) = (robot_.turns(i - 1) ? link.n : link.f).dot(z) + drive.rotor_inertia * accelerations(i - 1) +
                       drive.viscous * rates(i - 1);
      const int p = robot_.parent(i);
      const Vector3 r = state.p[index(i)] - (p > 0 ? state.p[index(p)] : zero);
      links[index(p)].f += link.f;
      links[index(p)].n += link.n + cross<Scalar>(r, link.f);
    }
    return robot_.drives().by_drive(torques);
  }

  Robot<N, Scalar, Joints> robot_;
  Vector3 gravity_;
  /// Relative to the placements of the joints.
  std::array<LinkInertia<Scalar>, static_cast<std::size_t>(kCapacity<Joints>) + 1> links_;
  std::array<JointDrive<Scalar>, static_cast<std::size_t>(kCapacity<Joints>)> drives_;
};

}  // namespace fpbm
