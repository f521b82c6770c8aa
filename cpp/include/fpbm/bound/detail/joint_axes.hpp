#pragma once

#include <cstddef>

#include "fpbm/core/types.hpp"
#include "fpbm/geometry/rotation.hpp"

namespace fpbm {

/// Axes of all joints of a robot in a posture, for the gradients of coordinates of points and directions.
template <int Joints, typename Scalar = double>
struct JointAxes {
  using Vector3 = Vector<3, Scalar>;

  /// Rows k of axes and moments for joint k with the axis zₖ through pₖ: zₖ and zₖ × pₖ for a revolute joint, 0 and −zₖ
  /// for a prismatic joint.
  Matrix<Joints, 3, Scalar> axes;
  Matrix<Joints, 3, Scalar> moments;

  /// Sets all axes. state: of the robot.
  template <typename Robot, typename RobotState>
  void set(const Robot& robot, const RobotState& state) noexcept {
    axes.resize(robot.joints(), 3);
    moments.resize(robot.joints(), 3);
    for (Eigen::Index k = 0; k < axes.rows(); ++k) {
      const auto joint = static_cast<std::size_t>(k + 1);
      const Vector3 z = state.R[joint].col(2);
      const bool turns = robot.turns(k);
      axes.row(k) = turns ? z : Vector3(Vector3::Zero());
      moments.row(k) = turns ? Vector3(cross(z, state.p[joint])) : Vector3(-z);
    }
  }

  /// Gradient of n·x with respect to the joints, for a point x of a link:
  ///
  ///   revolute joint:    n·(zₖ × (x − pₖ)) = zₖ·(x × n) − n·(zₖ × pₖ)
  ///   prismatic joint:   n·zₖ
  ///
  /// If x is a direction, the term with pₖ and the gradient of a prismatic joint are zero. joints: the joints that move
  /// the link.
  [[nodiscard]] Vector<Joints, Scalar> gradient(const Vector3& n, const Vector3& x, JointBits joints,
                                                bool is_direction = false) const noexcept {
    const Vector3 m = cross(x, n);
    const Scalar by_moment(is_direction ? 0 : 1);
    const auto along = [](const Matrix<Joints, 3, Scalar>& rows, Eigen::Index k, const Vector3& v) noexcept {
      return rows.coeff(k, 0) * v.coeff(0) + rows.coeff(k, 1) * v.coeff(1) + rows.coeff(k, 2) * v.coeff(2);
    };
    Vector<Joints, Scalar> gradient;
    gradient.resize(axes.rows());
    for (Eigen::Index k = 0; k < axes.rows(); ++k) {
      gradient.coeffRef(k) = along(axes, k, m) - by_moment * along(moments, k, n);
    }
    for (Eigen::Index k = 0; k < axes.rows(); ++k, joints >>= 1U) {
      if ((joints & 1U) == 0) gradient.coeffRef(k) = Scalar(0);
    }
    return gradient;
  }
};

}  // namespace fpbm
