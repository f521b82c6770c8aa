#pragma once

#include "fpbm/core/direction.hpp"
#include "fpbm/task/task_gains.hpp"

namespace fpbm {

/// Alignment of an axis a of a frame with a direction d that may move: 2 rows. The rotation about the axis is free.
///
/// The error is the rotation vector of the smallest rotation from a to d. The rows are the components of the angular
/// velocity along two unit vectors b₁, b₂ of the frame at right angles to a: S = [b₁ b₂]ᵀ. At velocity level the angle
/// θ between a and d obeys θ̇ + kθ = 0 from everywhere but θ = π.
template <typename Scalar_ = double>
struct AxisTask {
  using Scalar = Scalar_;
  using Space = Direction;
  static constexpr int kRows = 2;
  static constexpr bool kWhole = false;

  LinkFrame<Scalar> frame;
  TaskGains<Scalar> gains;
  Vector<3, Scalar> axis = {Scalar(0), Scalar(0), Scalar(1)};  ///< In the frame; its length does not matter.

  template <typename Robot>
  void require_robot(const Robot& robot) const {
    robot.require_link("frame", frame.link);
    validation::require_finite("axis", axis);
    if (!(norm(axis) > Scalar(0))) validation::reject("axis", " is zero: must point somewhere");
  }

  template <typename Robot>
  void evaluate(const Robot& robot, const typename Robot::State& state, Vector<3, Scalar>& x,
                Matrix<3, Robot::kDof, Scalar>& J, Matrix<3, Robot::kDof, Scalar>& Jd,
                Matrix<2, 3, Scalar>& S) const noexcept {
    const Transform<Scalar> at = robot.frame(state, frame.link, frame.offset);
    Matrix<6, Robot::kDof, Scalar> all;
    Matrix<6, Robot::kDof, Scalar> rates;
    robot.jacobian(state, frame.link, at.p, all, rates);
    const Matrix<3, 3, Scalar> aligned = times(at.R, z_to(axis));  // Its third column is a.
    x = column(aligned, 2);
    J = all.template bottomRows<3>();
    Jd = rates.template bottomRows<3>();
    for (int i = 0; i < 2; ++i) {
      for (int j = 0; j < 3; ++j) S(i, j) = aligned(j, i);
    }
  }
};

}  // namespace fpbm
