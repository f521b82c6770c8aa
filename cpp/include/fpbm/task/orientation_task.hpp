#pragma once

#include "fpbm/core/orientation.hpp"
#include "fpbm/task/task_gains.hpp"

namespace fpbm {

/// Orientation of a frame. To leave one rotation free, use an AxisTask.
template <typename Scalar_ = double>
struct OrientationTask {
  using Scalar = Scalar_;
  using Space = Orientation;
  static constexpr int kRows = 3;
  static constexpr bool kWhole = true;

  LinkFrame<Scalar> frame;
  TaskGains<Scalar> gains;

  template <typename Robot>
  void require_robot(const Robot& robot) const {
    robot.require_link("frame", frame.link);
  }

  template <typename Robot>
  void evaluate(const Robot& robot, const typename Robot::State& state, Matrix<3, 3, Scalar>& x,
                Matrix<3, Robot::kDof, Scalar>& J, Matrix<3, Robot::kDof, Scalar>& Jd,
                Matrix<3, 3, Scalar>& S) const noexcept {
    const Transform<Scalar> at = robot.frame(state, frame.link, frame.offset);
    Matrix<6, Robot::kDof, Scalar> all;
    Matrix<6, Robot::kDof, Scalar> rates;
    robot.jacobian(state, frame.link, at.p, all, rates);
    x = at.R;
    J = all.template bottomRows<3>();
    Jd = rates.template bottomRows<3>();
    S = identity<Matrix<3, 3, Scalar>>();
  }
};

}  // namespace fpbm
