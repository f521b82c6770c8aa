#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "fpbm/geometry/detail/direction.hpp"
#include "fpbm/geometry/space.hpp"
#include "fpbm/model/detail/center_of_mass.hpp"
#include "fpbm/model/detail/link.hpp"
#include "fpbm/task/axis_task.hpp"
#include "fpbm/task/detail/link_frame.hpp"
#include "fpbm/task/detail/task_gains.hpp"
#include "fpbm/task/relative_task.hpp"

namespace fpbm {

/// Coordinates that a task controls: coordinates of a frame, or the position of the centre of mass, which has no frame.
enum class FrameCoordinates { kPosition, kOrientation, kPose, kAxis, kCenterOfMass };

/// Largest distance of a rotation from π [rad] at which FrameSpace::turn_fraction() reduces an error. The value
/// is a choice: the error at angle φ is φ (π − φ)/kTurnBand, which changes by at most π/kTurnBand = 6.3 times as much
/// as φ, so that the gain of the feedback increases by at most this factor.
template <typename Scalar>
inline constexpr Scalar kTurnBand = Scalar(0.5);
/// Selected rotation error [rad] above which a reduced error counts as slowed.
template <typename Scalar>
inline constexpr Scalar kSelectedError = Scalar(1e-4);

/// Task space of any task of a frame: poses [m, rad], or directions, which are the z axes of poses. Linear rows are
/// above angular rows, along the axes of the base frame.
struct FrameSpace {
  static constexpr int kRows = 6;
  static constexpr int kTurns = 3;
  using HasSlowedFraction = void;

  template <typename Scalar>
  struct Point {
    Transform<Scalar> at;
    bool is_axis = false;
    bool is_empty = false;        ///< For a task without rows, which has no error and no displacement.
    bool has_free_turns = false;  ///< Whether one or two of the three rotations are rows.
  };

  template <typename Scalar>
  [[nodiscard]] static Point<Scalar> origin() noexcept {
    return {};
  }

  /// Pose::difference(), or for directions Direction::difference() with zeros in the linear rows. If y has free
  /// rotations, the rotation vector is multiplied by turn_fraction().
  template <typename Scalar>
  [[nodiscard]] static Vector<6, Scalar> difference(const Point<Scalar>& x, const Point<Scalar>& y) noexcept {
    if (y.is_empty) return filled<Vector<6, Scalar>>(6);
    if (!y.is_axis) {
      Vector<6, Scalar> result = Pose::difference<Scalar>(x.at, y.at);
      const Scalar fraction = y.has_free_turns ? turn_fraction(result) : Scalar(1);
      for (int i = 3; i < 6 && fraction < Scalar(1); ++i) result(i) *= fraction;
      return result;
    }
    const Vector<3, Scalar> turn = Direction::difference<Scalar>(column(x.at.R, 2), column(y.at.R, 2));
    auto result = filled<Vector<6, Scalar>>(6);
    for (int i = 0; i < 3; ++i) result(3 + i) = turn(i);
    return result;
  }

  template <typename Scalar>
  [[nodiscard]] static Point<Scalar> displace(const Point<Scalar>& y, const Vector<6, Scalar>& d) noexcept {
    if (y.is_empty) return y;
    return {Pose::displace<Scalar>(y.at, d), y.is_axis, false, y.has_free_turns};
  }

  /// Fraction of the rotation vector r in an error with free rotations: 1 for |r| ≤ π − kTurnBand, then decreasing
  /// linearly to 0 at |r| = π. At π, the rotation vector changes its sign, so that a constant fraction would make the
  /// error discontinuous. If all three rotations are rows, the error decreases and |r| does not stay at π.
  template <typename Scalar>
  [[nodiscard]] static Scalar turn_fraction(const Vector<6, Scalar>& difference) noexcept {
    constexpr auto kPi = static_cast<Scalar>(kTwoPi / 2.0);
    const Scalar angle = norm(Vector<3, Scalar>(difference(3), difference(4), difference(5)));
    return angle > kPi - kTurnBand<Scalar> ? (kPi - std::min(angle, kPi)) / kTurnBand<Scalar> : Scalar(1);
  }

  /// turn_fraction() of the error x ⊖ y, or 1 if the selected rows S have no rotation error.
  template <typename Scalar, typename Selection>
  [[nodiscard]] static Scalar slowed_fraction(const Point<Scalar>& x, const Point<Scalar>& y,
                                              const Selection& S) noexcept {
    if (!y.has_free_turns) return Scalar(1);
    Vector<6, Scalar> turn = Pose::difference<Scalar>(x.at, y.at);
    const Scalar fraction = turn_fraction(turn);
    if (!(fraction < Scalar(1))) return Scalar(1);
    for (int i = 0; i < 3; ++i) turn(i) = Scalar(0);
    return (S * turn).norm() > kSelectedError<Scalar> * S.norm() ? fraction : Scalar(1);
  }
};

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
