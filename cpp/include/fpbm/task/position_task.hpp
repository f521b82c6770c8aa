#pragma once

#include <array>

#include "fpbm/core/space.hpp"
#include "fpbm/task/link_frame.hpp"
#include "fpbm/task/task_gains.hpp"

namespace fpbm {

/// Position of a frame's origin: M of its coordinates, along the base frame's axes or the frame's own.
///
/// A task is data: which frame of the robot, which rows, which gains. RobotTasks calls bind() in its constructor, and
/// evaluate() in every state, for the task's
///
///   x      point of the Space, in the base frame, as references have it
///   J, J̇   in the Space's rows, along the base frame's axes [m, rad]; J̇ if the state moves
///   S      selection: the task's rows are S J. If kWhole, S is the identity, and only its diagonal is read.
template <int M = 3, typename Scalar_ = double>
struct PositionTask {
  using Scalar = Scalar_;
  using Space = Position<3>;
  static constexpr int kRows = M;
  static constexpr bool kWhole = false;

  LinkFrame<Scalar> frame;
  TaskGains<Scalar> gains;
  std::array<int, M> rows = first_rows();  ///< Coordinates 0 (x), 1 (y) and 2 (z), each once.
  bool in_frame = false;                   ///< Along the frame's axes; otherwise the base frame's.

  /// Throws std::invalid_argument where the task does not suit a robot.
  template <typename Robot>
  void bind(const Robot& robot) {
    frame.bind(robot);
    require_different("rows", rows, 3);
  }

  template <typename Robot>
  void evaluate(const Robot& robot, const typename Robot::State& state, Vector<3, Scalar>& x,
                Matrix<3, Robot::kDof, Scalar>& J, Matrix<3, Robot::kDof, Scalar>& Jd,
                Matrix<M, 3, Scalar>& S) const noexcept {
    x = frame.origin(robot, state);
    robot.jacobian(state, frame.link(), x, J, Jd);
    Matrix<3, 3, Scalar> axes = identity<Matrix<3, 3, Scalar>>();
    if (in_frame) axes = frame.at(robot, state).R;
    for (int i = 0; i < M; ++i) {
      for (int j = 0; j < 3; ++j) S.coeffRef(i, j) = axes.coeff(j, rows[static_cast<std::size_t>(i)]);
    }
  }
  /// The coordinate that row i is; -1 where it is a component along an axis of the frame.
  [[nodiscard]] int coordinate(int i) const noexcept { return in_frame ? -1 : rows[static_cast<std::size_t>(i)]; }

 private:
  [[nodiscard]] static std::array<int, M> first_rows() noexcept {
    static_assert(M >= 1 && M <= 3, "a position has 1 to 3 rows");
    std::array<int, M> rows{};
    for (int i = 0; i < M; ++i) rows[static_cast<std::size_t>(i)] = i;
    return rows;
  }
};

}  // namespace fpbm
