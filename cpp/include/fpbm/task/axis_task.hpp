#pragma once

#include "fpbm/core/direction.hpp"
#include "fpbm/linalg/product.hpp"
#include "fpbm/linalg/sums.hpp"
#include "fpbm/model/link.hpp"
#include "fpbm/task/link_frame.hpp"
#include "fpbm/task/task_gains.hpp"

namespace fpbm {

/// Makes J̇ q̇ [rad/s²] the drift of ω⊥, the angular velocity at right angles to an axis a of the frame:
///
///   d/dt ω⊥ = (J q̈ + J̇ q̇)⊥ − (aᵀω)(ω × a),   ω = J q̇.
///
/// Without the last term, rotation about a, which lower levels determine, would disturb the motion of a. J, J̇: the last
/// three rows are angular; those of J̇ are changed. w: ω.
template <int M, int N, typename Scalar>
void add_spin(const Matrix<M, N, Scalar>& J, const Vector<3, Scalar>& w, const Vector<3, Scalar>& a,
              Matrix<M, N, Scalar>& Jd) noexcept {
  const auto angular = [](const auto& rows, Eigen::Index j) noexcept {
    return Vector<3, Scalar>(rows.coeff(M - 3, j), rows.coeff(M - 2, j), rows.coeff(M - 1, j));
  };
  const Vector<3, Scalar> turning = cross(w, a);
  for (Eigen::Index j = 0; j < J.cols(); ++j) {
    const Scalar spin = dot(angular(J, j), a);
    for (int i = 0; i < 3; ++i) Jd.coeffRef(M - 3 + i, j) -= spin * turning.coeff(i);
  }
}

/// Alignment of an axis a of a frame with a direction d that may move: 2 rows. The rotation about the axis is free.
///
/// The error is the rotation vector of the smallest rotation from a to d. The rows are the components of the angular
/// velocity along two unit vectors b₁, b₂ of the frame at right angles to a: S = [b₁ b₂]ᵀ. The angle θ between a and d
/// obeys θ̇ + kθ = 0 at velocity level from everywhere but θ = π, and θ̈ + k₁θ̇ + k₂θ = 0 at acceleration level from
/// rest, whatever the rotation about a: see add_spin().
template <typename Scalar_ = double>
class AxisTask {
 public:
  using Scalar = Scalar_;
  using Space = Direction;
  static constexpr int kRows = 2;
  static constexpr bool kWhole = false;

  LinkFrame<Scalar> frame;
  TaskGains<Scalar> gains;

  /// axis: in the frame; its length does not matter. Throws std::invalid_argument where it is zero or not finite.
  AxisTask(const LinkFrame<Scalar>& frame_, const TaskGains<Scalar>& gains_,
           const Vector<3, Scalar>& axis = {Scalar(0), Scalar(0), Scalar(1)})
      : frame(frame_), gains(gains_), axes_(frame_) {
    validation::require_finite("axis", axis);
    if (!(norm(axis) > Scalar(0))) validation::reject("axis", " is zero: must point somewhere");
    to_axis_ = z_to(axis);
  }

  template <typename Robot>
  void bind(const Robot& robot) {
    Transform<Scalar> turned;
    turned.R = to_axis_;
    axes_ = LinkFrame<Scalar>(frame.link(), frame.offset() * turned);
    axes_.bind(robot);
  }

  template <typename Robot>
  void evaluate(const Robot& robot, const typename Robot::State& state, Vector<3, Scalar>& x,
                Matrix<3, Robot::kDof, Scalar>& J, Matrix<3, Robot::kDof, Scalar>& Jd,
                Matrix<2, 3, Scalar>& S) const noexcept {
    const Matrix<3, 3, Scalar> axes = axes_.at(robot, state).R;  // b₁, b₂ and a.
    x = column(axes, 2);
    robot.angular_jacobian(state, frame.link(), J, Jd);
    if (state.moves) add_spin(J, robot.angular_velocity(state, frame.link()), x, Jd);
    for (int i = 0; i < 2; ++i) {
      for (int j = 0; j < 3; ++j) S(i, j) = axes(j, i);
    }
  }

 private:
  Matrix<3, 3, Scalar> to_axis_;  ///< In the frame: b₁, b₂ and the axis.
  LinkFrame<Scalar> axes_;        ///< Has these axes.
};

}  // namespace fpbm
