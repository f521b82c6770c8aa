#pragma once

#include "fpbm/core/orientation.hpp"
#include "fpbm/task/link_frame.hpp"
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
  void bind(const Robot& robot) {
    frame.bind(robot);
  }

  template <typename Robot>
  void evaluate(const Robot& robot, const typename Robot::State& state, Matrix<3, 3, Scalar>& x,
                Matrix<3, Robot::kDof, Scalar>& J, Matrix<3, Robot::kDof, Scalar>& Jd,
                Matrix<3, 3, Scalar>& S) const noexcept {
    x = frame.at(robot, state).R;
    robot.angular_jacobian(state, frame.link(), J, Jd);
    S = identity<Matrix<3, 3, Scalar>>();
  }
};

}  // namespace fpbm
