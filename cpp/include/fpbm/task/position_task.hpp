#pragma once

#include <array>

#include "fpbm/geometry/space.hpp"
#include "fpbm/task/detail/link_frame.hpp"
#include "fpbm/task/detail/task_gains.hpp"
#include "fpbm/task/detail/task_rows.hpp"

namespace fpbm {

/// Position of the origin of a frame: M of its coordinates, along the axes of the base frame or of the frame itself.
///
/// A task is data: the frame of the robot, the rows, and the gains. RobotTasks calls bind() in its constructor, and
/// evaluate() in every state. evaluate() sets
///
///   x      point of the Space, in the base frame, like the references
///   xd     velocity J q̇ of the point, in the rows of the Space, along the axes of the base frame [m/s, rad/s]
///   S      selection, in metres: angular columns are multiplied by the length of the robot. If kWhole, S is diagonal.
///   level  rows S J and S J̇ of the task
template <int M = 3, typename Scalar_ = double>
struct PositionTask {
  using Scalar = Scalar_;
  using Space = Position<3>;
  static constexpr int kRows = M;
  static constexpr bool kWhole = false;

  LinkFrame<Scalar> frame;
  TaskGains<Scalar> gains;
  std::array<int, M> rows = first_rows();  ///< Coordinates 0 (x), 1 (y) or 2 (z), distinct.
  bool in_frame = false;  ///< Whether the rows are along the axes of the frame, instead of the base frame.

  /// Throws std::invalid_argument if the frame does not exist in the robot, or if `rows` are not different numbers from
  /// 0 to 2.
  template <typename Robot>
  void bind(const Robot& robot) {
    frame.bind(robot);
    require_different("rows", rows, 3);
  }

  template <typename Robot, typename Rows>
  void evaluate(const Robot& robot, const typename Robot::State& state, Vector<3, Scalar>& x, Vector<3, Scalar>& xd,
                Matrix<M, 3, Scalar>& S, Rows level) const noexcept {
    x = frame.origin(robot, state);
    Matrix<3, 3, Scalar> axes = identity<Matrix<3, 3, Scalar>>();
    if (in_frame) axes = frame.axes(robot, state);
    for (int i = 0; i < M; ++i) {
      for (int j = 0; j < 3; ++j) S.coeffRef(i, j) = axes.coeff(j, rows[static_cast<std::size_t>(i)]);
    }
    // Row of each coordinate, or -1 if the coordinate has no row. columns.linear stays in registers if k below is
    // constant.
    int row_of[3] = {-1, -1, -1};
    for (int i = 0; i < M; ++i) row_of[rows[static_cast<std::size_t>(i)]] = i;
    xd = robot.columns(state, frame.link(), x, [&](Eigen::Index j, const auto& columns, const auto& rates) noexcept {
      for (int i = 0; in_frame && i < M; ++i) {
        const Vector<3, Scalar> axis = column(axes, rows[static_cast<std::size_t>(i)]);
        level.set(i, j, along(axis, columns.linear), along(axis, rates.linear));
      }
      for (int k = 0; !in_frame && k < 3; ++k) {
        const int i = row_of[k];
        if (M == 3 || i >= 0) level.set(i, j, columns.linear.coeff(k), rates.linear.coeff(k));
      }
    });
  }

  /// Coordinates 0 to M − 1.
  [[nodiscard]] static std::array<int, M> first_rows() noexcept {
    static_assert(M >= 1 && M <= 3, "a position has 1 to 3 rows");
    std::array<int, M> rows{};
    for (int i = 0; i < M; ++i) rows[static_cast<std::size_t>(i)] = i;
    return rows;
  }
};

}  // namespace fpbm
