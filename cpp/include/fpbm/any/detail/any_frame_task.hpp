#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "fpbm/any/detail/frame_space.hpp"
#include "fpbm/model/detail/center_of_mass.hpp"
#include "fpbm/model/detail/link.hpp"
#include "fpbm/task/axis_task.hpp"
#include "fpbm/task/detail/link_frame.hpp"
#include "fpbm/task/detail/task_gains.hpp"
#include "fpbm/task/relative_task.hpp"

namespace fpbm {

/// Coordinates that a task controls: coordinates of a frame, or the position of the centre of mass, which has no frame.
enum class FrameCoordinates { kPosition, kOrientation, kPose, kAxis, kCenterOfMass };

/// Task whose type and rows are known at run time: PositionTask, OrientationTask, PoseTask, AxisTask, a pose with fewer
/// rows, a RelativeTask of one of these tasks, or a CenterOfMassTask.
class AnyFrameTask {
 public:
  using Scalar = double;
  using Space = FrameSpace;
  static constexpr int kRows = Eigen::Dynamic;
  static constexpr bool kWhole = false;
  /// Whether a task selects x, y, z and the rotations about these axes.
  using Selection = std::array<bool, 6>;

  TaskGains<> gains = TaskGains<>(0.0, 0.0);

  /// Empty task, without rows.
  AnyFrameTask() = default;

  /// selected: rows that the kind does not have are ignored; kAxis ignores all rows. in_frame: whether the rows are
  /// along the axes of the frame, instead of the base frame. axis: in the frame, read by kAxis only. reference: the
  /// frame that replaces the base frame in a relative task. Throws std::invalid_argument if no row is selected, or the
  /// axis is zero or not finite.
  AnyFrameTask(FrameCoordinates kind, const LinkFrame<>& frame, const TaskGains<>& gains_, const Selection& selected,
               bool in_frame, const Vector<3>& axis = {0.0, 0.0, 1.0},
               std::optional<LinkFrame<>> reference = std::nullopt)
      : gains(gains_), frame_(frame), reference_(std::move(reference)), kind_(kind), in_frame_(in_frame) {
    if (kind == FrameCoordinates::kAxis) {
      validation::require_finite("axis", axis);
      if (!(norm(axis) > 0.0)) validation::reject("axis", " is zero: must be a nonzero vector");
      to_axis_ = z_to(axis);
      count_ = 2;
      return;
    }
    for (int row = 0; row < 6; ++row) {
      const bool linear = row < 3;
      const bool has = linear ? kind != FrameCoordinates::kOrientation
                              : kind == FrameCoordinates::kOrientation || kind == FrameCoordinates::kPose;
      if (has && selected[static_cast<std::size_t>(row)]) rows_[static_cast<std::size_t>(count_++)] = row;
    }
    if (count_ == 0) validation::reject("rows", " select no row of the task: must select at least one");
    const auto turns = std::count_if(rows_.begin(), rows_.begin() + count_, [](int row) { return row >= 3; });
    free_turns_ = turns == 1 || turns == 2;
  }

  [[nodiscard]] int rows() const noexcept { return count_; }

  template <typename Robot>
  void bind(const Robot& robot) {
    if (kind_ == FrameCoordinates::kCenterOfMass) return require_mass(robot);
    frame_.bind(robot);
    if (reference_) {
      reference_->bind(robot);
      require_relative_motion(robot, frame_, *reference_);
    }
  }

  template <typename Robot, typename Rows>
  void evaluate(const Robot& robot, const typename Robot::State& state, FrameSpace::Point<double>& x, Vector<6>& xd,
                Matrix<Eigen::Dynamic, 6>& S, Rows level) const noexcept {
    x.is_axis = kind_ == FrameCoordinates::kAxis;
    x.is_empty = count_ == 0;
    x.has_free_turns = free_turns_;
    S.resize(count_, 6);
    if (count_ == 0) return;
    if (kind_ == FrameCoordinates::kCenterOfMass) return evaluate_center(robot, state, x, xd, S, level);
    if (reference_) {
      evaluate_frame(RelativeView<Robot>(robot, state, *reference_), state, x, xd, S, level);
    } else {
      evaluate_frame(robot, state, x, xd, S, level);
    }
  }

 private:
  template <typename Robot, typename Rows>
  void evaluate_frame(const Robot& robot, const typename Robot::State& state, FrameSpace::Point<double>& x,
                      Vector<6>& xd, Matrix<Eigen::Dynamic, 6>& S, Rows level) const noexcept {
    x.at = frame_.at(robot, state);
    if (x.is_axis) x.at.R = times(x.at.R, to_axis_);
    // Whether the linear and angular rows are along the axes of the frame, instead of the base frame.
    const bool along_frame = x.is_axis || in_frame_;
    std::array<Vector<3>, 6> axes;
    for (int i = 0; i < count_; ++i) {
      const int row = x.is_axis ? 3 + i : rows_[static_cast<std::size_t>(i)];
      const double unit = row < 3 ? 1.0 : robot.length();
      for (int j = 0; j < 6; ++j) {
        const double entry = along_frame ? x.at.R(j % 3, row % 3) : j == row ? 1.0 : 0.0;
        S(i, j) = (row < 3) == (j < 3) ? unit * entry : 0.0;
      }
      const int part = row < 3 ? 0 : 3;
      axes[static_cast<std::size_t>(i)] = Vector<3>(S(i, part), S(i, part + 1), S(i, part + 2));
    }
    const Vector<3> w = robot.angular_velocity(state, frame_.link());
    const Vector<3> a = column(x.at.R, 2);
    const Vector<3> turning = x.is_axis ? cross(w, a) : filled<Vector<3>>(3);
    const auto set = [&](Eigen::Index j, const auto& columns, const auto& rates) noexcept {
      const auto angular_rates = without_spin(columns.angular, rates.angular, a, turning);
      for (int i = 0; i < count_; ++i) {
        const bool linear = !x.is_axis && rows_[static_cast<std::size_t>(i)] < 3;
        const Vector<3>& axis = axes[static_cast<std::size_t>(i)];
        level.set(i, j, along(axis, linear ? columns.linear : columns.angular),
                  along(axis, linear ? rates.linear : angular_rates));
      }
    };
    const Vector<3> v = robot.columns(state, frame_.link(), x.at.p, set);
    for (int i = 0; i < 3; ++i) {
      xd(i) = v(i);
      xd(3 + i) = w(i);
    }
  }

  template <typename Robot, typename Rows>
  void evaluate_center(const Robot& robot, const typename Robot::State& state, FrameSpace::Point<double>& x,
                       Vector<6>& xd, Matrix<Eigen::Dynamic, 6>& S, Rows level) const noexcept {
    x.at = {};
    xd = filled<Vector<6>>(6);
    Vector<3> v;
    Matrix<3, Robot::kDof> J;
    Matrix<3, Robot::kDof> Jd;
    center_of_mass(robot, state, x.at.p, v, J, Jd);
    for (int i = 0; i < 3; ++i) xd(i) = v(i);
    for (int i = 0; i < count_; ++i) {
      const int row = rows_[static_cast<std::size_t>(i)];
      for (int j = 0; j < 6; ++j) S(i, j) = j == row ? 1.0 : 0.0;
      for (Eigen::Index j = 0; j < J.cols(); j += 2) level.set(i, j, two_of_row(J, row, j), two_of_row(Jd, row, j));
    }
  }

  LinkFrame<> frame_ = LinkFrame<>(0);
  std::optional<LinkFrame<>> reference_;
  FrameCoordinates kind_ = FrameCoordinates::kPose;
  bool in_frame_ = false;
  bool free_turns_ = false;  ///< Point::has_free_turns.
  int count_ = 0;
  std::array<int, 6> rows_{};  ///< Selected rows.
  Matrix<3, 3> to_axis_ = identity<Matrix<3, 3>>();
};

}  // namespace fpbm
