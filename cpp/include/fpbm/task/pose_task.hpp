#pragma once

#include "fpbm/core/space.hpp"
#include "fpbm/task/link_frame.hpp"
#include "fpbm/task/task_gains.hpp"

namespace fpbm {

/// Pose of a frame. For fewer rows, put a PositionTask and an AxisTask side by side on a level.
template <typename Scalar_ = double>
struct PoseTask {
  using Scalar = Scalar_;
  using Space = Pose;
  static constexpr int kRows = 6;
  static constexpr bool kWhole = true;

  LinkFrame<Scalar> frame;
  TaskGains<Scalar> gains;

  template <typename Robot>
  void bind(const Robot& robot) {
    frame.bind(robot);
  }

  template <typename Robot>
  void evaluate(const Robot& robot, const typename Robot::State& state, Transform<Scalar>& x,
                Matrix<6, Robot::kDof, Scalar>& J, Matrix<6, Robot::kDof, Scalar>& Jd,
                Matrix<6, 6, Scalar>& S) const noexcept {
    x = frame.at(robot, state);
    robot.jacobian(state, frame.link(), x.p, J, Jd);
    S = identity<Matrix<6, 6, Scalar>>();
  }
};

}  // namespace fpbm
