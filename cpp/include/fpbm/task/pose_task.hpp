#pragma once

#include "fpbm/geometry/space.hpp"
#include "fpbm/task/detail/link_frame.hpp"
#include "fpbm/task/detail/task_gains.hpp"
#include "fpbm/task/detail/task_rows.hpp"

namespace fpbm {

/// Pose of a frame. For fewer rows, combine a PositionTask and an AxisTask on one level.
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

  template <typename Robot, typename Rows>
  void evaluate(const Robot& robot, const typename Robot::State& state, Transform<Scalar>& x, Vector<6, Scalar>& xd,
                Matrix<6, 6, Scalar>& S, Rows level) const noexcept {
    x = frame.at(robot, state);
    const Vector<3, Scalar> w = robot.angular_velocity(state, frame.link());
    const Scalar length = robot.length();
    const auto set = [&](Eigen::Index j, const auto& columns, const auto& rates) noexcept {
      for (int i = 0; i < 3; ++i) {
        const Pair<Scalar> unit(length);
        level.set(i, j, columns.linear.coeff(i), rates.linear.coeff(i));
        level.set(3 + i, j, unit * columns.angular.coeff(i), unit * rates.angular.coeff(i));
      }
    };
    const Vector<3, Scalar> v = robot.columns(state, frame.link(), x.p, set);
    S = identity<Matrix<6, 6, Scalar>>();
    for (int i = 0; i < 3; ++i) {
      S.coeffRef(3 + i, 3 + i) = length;
      xd.coeffRef(i) = v.coeff(i);
      xd.coeffRef(3 + i) = w.coeff(i);
    }
  }
};

}  // namespace fpbm
