#pragma once

#include "fpbm/geometry/detail/orientation.hpp"
#include "fpbm/task/detail/link_frame.hpp"
#include "fpbm/task/detail/task_gains.hpp"
#include "fpbm/task/detail/task_rows.hpp"

namespace fpbm {

/// Orientation of a frame. If one rotation is to be free, use an AxisTask.
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

  template <typename Robot, typename Rows>
  void evaluate(const Robot& robot, const typename Robot::State& state, Matrix<3, 3, Scalar>& x, Vector<3, Scalar>& xd,
                Matrix<3, 3, Scalar>& S, Rows level) const noexcept {
    x = frame.axes(robot, state);
    xd = robot.angular_velocity(state, frame.link());
    const Pair<Scalar> unit(robot.length());
    robot.angular_columns(state, frame.link(), [&](Eigen::Index j, const auto& columns, const auto& rates) noexcept {
      for (int i = 0; i < 3; ++i) level.set(i, j, unit * columns.coeff(i), unit * rates.coeff(i));
    });
    S = identity<Matrix<3, 3, Scalar>>();
    for (int i = 0; i < 3; ++i) S.coeffRef(i, i) = robot.length();
  }
};

}  // namespace fpbm
