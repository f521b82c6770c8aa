#pragma once

#include "fpbm/geometry/detail/direction.hpp"
#include "fpbm/linalg/detail/entrywise.hpp"
#include "fpbm/linalg/detail/sums.hpp"
#include "fpbm/model/detail/link.hpp"
#include "fpbm/task/detail/link_frame.hpp"
#include "fpbm/task/detail/task_gains.hpp"
#include "fpbm/task/detail/task_rows.hpp"

namespace fpbm {

/// Rows of J̇ for ω⊥, the angular velocity perpendicular to an axis a of the frame, for two joints (docs/kinematics.md,
/// Secondary objectives, Axis of a frame):
///
///   d/dt ω⊥ = (J q̈ + J̇ q̇)⊥ − (aᵀω)(ω × a),   ω = J q̇.
///
/// Lower levels determine the rotation about a, which would disturb the motion of a without the last term.
/// columns, rates: angular rows of J and J̇. turning: ω × a.
template <typename Scalar>
[[nodiscard, gnu::always_inline]] inline Vector<3, Pair<Scalar>> without_spin(
    const Vector<3, Pair<Scalar>>& columns, const Vector<3, Pair<Scalar>>& rates, const Vector<3, Scalar>& a,
    const Vector<3, Scalar>& turning) noexcept {
  using Two = Pair<Scalar>;
  const Two spin = along(a, columns);
  return entrywise(rates, [&](Eigen::Index k) { return rates.coeff(k) - spin * Two(turning.coeff(k)); });
}

/// Axis alignment: an axis a of a frame points along a direction d, which may move. The task has 2 rows, and the
/// rotation about the axis is free.
///
/// The error is the rotation vector of the smallest rotation from a to d. The rows are the components of the angular
/// velocity along two unit vectors b₁, b₂ of the frame, which are perpendicular to a and to each other: S = [b₁ b₂]ᵀ.
/// At velocity level, the angle θ between a and d obeys θ̇ + kθ = 0 for all initial angles except θ = π. At
/// acceleration level, θ obeys θ̈ + k₁θ̇ + k₂θ = 0 from rest, for any rotation about a (without_spin()).
template <typename Scalar_ = double>
class AxisTask {
 public:
  using Scalar = Scalar_;
  using Space = Direction;
  static constexpr int kRows = 2;
  static constexpr bool kWhole = false;

  LinkFrame<Scalar> frame;
  TaskGains<Scalar> gains;

  /// axis: in the frame, of any length. Throws std::invalid_argument if the axis is zero or not finite.
  AxisTask(const LinkFrame<Scalar>& frame_, const TaskGains<Scalar>& gains_,
           const Vector<3, Scalar>& axis = {Scalar(0), Scalar(0), Scalar(1)})
      : frame(frame_), gains(gains_), axes_(frame_) {
    validation::require_finite("axis", axis);
    if (!(norm(axis) > Scalar(0))) validation::reject("axis", " is zero: must be a nonzero vector");
    to_axis_ = z_to(axis);
  }

  template <typename Robot>
  void bind(const Robot& robot) {
    Transform<Scalar> turned;
    turned.R = to_axis_;
    axes_ = LinkFrame<Scalar>(frame.link(), frame.offset() * turned);
    axes_.bind(robot);
  }

  template <typename Robot, typename Rows>
  void evaluate(const Robot& robot, const typename Robot::State& state, Vector<3, Scalar>& x, Vector<3, Scalar>& xd,
                Matrix<2, 3, Scalar>& S, Rows level) const noexcept {
    const Matrix<3, 3, Scalar> axes = axes_.axes(robot, state);  // b₁, b₂ and a.
    x = column(axes, 2);
    xd = robot.angular_velocity(state, frame.link());
    for (int i = 0; i < 2; ++i) {
      for (int j = 0; j < 3; ++j) S(i, j) = robot.length() * axes(j, i);
    }
    const Vector<3, Scalar> turning = cross(xd, x);
    const Vector<3, Scalar> b1(S(0, 0), S(0, 1), S(0, 2));
    const Vector<3, Scalar> b2(S(1, 0), S(1, 1), S(1, 2));
    robot.angular_columns(state, frame.link(), [&](Eigen::Index j, const auto& columns, const auto& rates) noexcept {
      const auto of_axis = without_spin(columns, rates, x, turning);
      level.set(0, j, along(b1, columns), along(b1, of_axis));
      level.set(1, j, along(b2, columns), along(b2, of_axis));
    });
  }

 private:
  Matrix<3, 3, Scalar> to_axis_;  ///< Columns b₁, b₂ and a, in the frame.
  LinkFrame<Scalar> axes_;        ///< Frame with the axes b₁, b₂ and a.
};

}  // namespace fpbm
