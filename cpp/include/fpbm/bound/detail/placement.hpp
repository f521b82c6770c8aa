#pragma once

#include <cstddef>
#include <vector>

#include "fpbm/bound/detail/shape.hpp"
#include "fpbm/model/detail/robot_state.hpp"

namespace fpbm {

/// The bodies of a clearance in a posture, in the base frame. Clearance::place() sets all members.
template <int N, typename Scalar = double, int Joints = N>
struct Placement {
  using Vector3 = Vector<3, Scalar>;

  RobotState<N, Scalar, Joints> state;
  std::vector<Capsule<Scalar>> bodies;
  std::vector<Vector3> centres;       ///< Centres of the smallest balls around the bodies [m].
  std::vector<Vector3> speed_points;  ///< Points [m] or directions whose speeds are bounded.
  /// Row k of axes and moments for joint k with the axis zₖ through pₖ: zₖ and zₖ × pₖ for a revolute joint, 0 and −zₖ
  /// for a prismatic joint.
  Matrix<Joints, 3, Scalar> axes;
  Matrix<Joints, 3, Scalar> moments;

  /// Sets gradients[e] to the gradient of n·xₑ with respect to the joints, for two points x₀ and x₁ of one link:
  ///
  ///   revolute joint:    n·(zₖ × (x − pₖ)) = zₖ·(x × n) − n·(zₖ × pₖ)
  ///   prismatic joint:   n·zₖ
  ///
  /// If x is a direction, the term with pₖ and the gradient of a prismatic joint are zero. joints: the joints that move
  /// the link.
  void set_gradients(const Vector3& n, const Vector3& x0, const Vector3& x1, JointBits joints, bool is_direction,
                     Vector<Joints, Scalar> (&gradients)[2]) const noexcept {
    const Vector3 m0 = cross(x0, n);
    const Vector3 m1 = cross(x1, n);
    const Scalar by_moment(is_direction ? 0 : 1);
    const auto along = [](const Matrix<Joints, 3, Scalar>& rows, Eigen::Index k, const Vector3& v) noexcept {
      return rows.coeff(k, 0) * v.coeff(0) + rows.coeff(k, 1) * v.coeff(1) + rows.coeff(k, 2) * v.coeff(2);
    };
    for (auto& each : gradients) each.resize(axes.rows());
    for (Eigen::Index k = 0; k < axes.rows(); ++k) {
      const Scalar moment = by_moment * along(moments, k, n);
      gradients[0].coeffRef(k) = along(axes, k, m0) - moment;
      gradients[1].coeffRef(k) = along(axes, k, m1) - moment;
    }
    for (Eigen::Index k = 0; k < axes.rows(); ++k, joints >>= 1U) {
      if ((joints & 1U) == 0) gradients[0].coeffRef(k) = gradients[1].coeffRef(k) = Scalar(0);
    }
  }

  /// Sets axes and moments from the state. turns(k): whether joint k is revolute.
  template <typename Turns>
  void set_axes(Eigen::Index joints, const Turns& turns) noexcept {
    axes.resize(joints, 3);
    moments.resize(joints, 3);
    for (Eigen::Index k = 0; k < joints; ++k) {
      const auto joint = static_cast<std::size_t>(k + 1);
      const Vector3 z = state.R[joint].col(2);
      const bool turn = turns(k);
      axes.row(k) = turn ? z : Vector3(Vector3::Zero());
      moments.row(k) = turn ? Vector3(cross(z, state.p[joint])) : Vector3(-z);
    }
  }
};

}  // namespace fpbm
