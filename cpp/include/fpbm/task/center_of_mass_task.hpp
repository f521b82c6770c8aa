#pragma once

#include <array>

#include "fpbm/geometry/space.hpp"
#include "fpbm/model/detail/center_of_mass.hpp"
#include "fpbm/task/detail/task_gains.hpp"
#include "fpbm/task/detail/task_rows.hpp"
#include "fpbm/task/position_task.hpp"

namespace fpbm {

/// Position of the centre of mass of a robot: M of its coordinates, along the axes of the base frame.
template <int M = 3, typename Scalar_ = double>
struct CenterOfMassTask {
  using Scalar = Scalar_;
  using Space = Position<3>;
  using Vector3 = Vector<3, Scalar>;
  static constexpr int kRows = M;
  static constexpr bool kWhole = false;

  TaskGains<Scalar> gains;
  std::array<int, M> rows = PositionTask<M, Scalar>::first_rows();  ///< Coordinates 0 (x), 1 (y) or 2 (z), distinct.

  /// Throws std::invalid_argument if the robot has no mass, or if `rows` are not different numbers from 0 to 2.
  template <typename Robot>
  void bind(const Robot& robot) const {
    require_different("rows", rows, 3);
    require_mass(robot);
  }

  template <typename Robot, typename Rows>
  void evaluate(const Robot& robot, const typename Robot::State& state, Vector3& x, Vector3& xd,
                Matrix<M, 3, Scalar>& S, Rows level) const noexcept {
    Matrix<3, Robot::kDof, Scalar> J;
    Matrix<3, Robot::kDof, Scalar> Jd;
    center_of_mass(robot, state, x, xd, J, Jd);
    for (int i = 0; i < M; ++i) {
      const int row = rows[static_cast<std::size_t>(i)];
      for (int j = 0; j < 3; ++j) S.coeffRef(i, j) = Scalar(j == row ? 1 : 0);
      for (Eigen::Index j = 0; j < J.cols(); j += 2) level.set(i, j, two_of_row(J, row, j), two_of_row(Jd, row, j));
    }
  }
};

}  // namespace fpbm
