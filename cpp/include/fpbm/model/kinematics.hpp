#pragma once

#include "fpbm/core/types.hpp"

namespace fpbm {

/// Kinematics of an arm in one state. A scheme has no other data about the robot.
///
/// Filled by an arm of model/, or by any other library that computes tip, J and Jd.
template <typename Space, int N, typename Scalar = double>
struct Kinematics {
  static constexpr int kRows = Space::kRows;

  typename Space::template Point<Scalar> tip;  ///< f(q), in the base frame [m, rad].
  Matrix<kRows, N, Scalar> J;                  ///< Task Jacobian: tip velocity is J qd.
  Matrix<kRows, N, Scalar> Jd;                 ///< dJ/dt along qd: tip acceleration is J qdd + Jd qd.
  /// Characteristic length of the arm [m], which converts radians to metres. Thresholds then do not depend on the size
  /// of the arm.
  Scalar length = Scalar(1);
  Scalar lead = Scalar(0);  ///< h' [s] if J is J + h'J̇, the rows of continue_tick().
};

/// Number of rows of J as template argument of the limits. If N is Eigen::Dynamic, this number is Eigen::Dynamic too,
/// so that one instantiation of the limits serves all task spaces.
template <typename Space, int N>
inline constexpr int kLimitedRows = N == Eigen::Dynamic ? Eigen::Dynamic : Space::kRows;

/// Number of rows at the end of J that the schemes multiply by a length [m]: the angular rows. If N is Eigen::Dynamic,
/// positions in space and poses in the plane share one instantiation, and the last row of a position is multiplied by
/// 1.
template <typename Space, int N>
inline constexpr int kScaledRows = (N == Eigen::Dynamic && Space::kRows == 3) ? 1 : Space::kTurns;
/// Length [m] by which the schemes multiply the last kScaledRows rows of J.
template <typename Space, int N, typename Scalar>
[[nodiscard]] Scalar scale_of_rows(const Kinematics<Space, N, Scalar>& kinematics) noexcept {
  return kScaledRows<Space, N> == Space::kTurns ? kinematics.length : Scalar(1);
}

/// J of the first task level.
template <typename Space, int N, typename Scalar>
[[nodiscard]] const Matrix<Space::kRows, N, Scalar>& first_rows(
    const Kinematics<Space, N, Scalar>& kinematics) noexcept {
  return kinematics.J;
}

/// Whether there are task levels below the first.
template <typename Space, int N, typename Scalar>
[[nodiscard]] constexpr bool has_lower_levels(const Kinematics<Space, N, Scalar>&) noexcept {
  return false;
}

/// Sets kinematics.tip and kinematics.length at q: by arm.points(q, kinematics), if the arm has this function,
/// otherwise by arm.kinematics(q, kinematics).
template <typename Arm, typename Vector, typename Kinematics>
auto points_of(const Arm& arm, const Vector& q, Kinematics& kinematics, int) noexcept
    -> decltype(arm.points(q, kinematics)) {
  arm.points(q, kinematics);
}
template <typename Arm, typename Vector, typename Kinematics>
void points_of(const Arm& arm, const Vector& q, Kinematics& kinematics, long) noexcept {
  arm.kinematics(q, kinematics);
}

/// J ← J + lead J̇.
template <typename Rows, typename Scalar, typename Rates>
void add_lead(Rows& J, const Scalar& lead, const Rates& Jd) noexcept {
  for (Eigen::Index j = 0; j < J.cols(); ++j) {
    for (Eigen::Index i = 0; i < J.rows(); ++i) J.coeffRef(i, j) += lead * Jd.coeff(i, j);
  }
}

/// x ⊖ f(q), the error of the task [m, rad] for the target x.
template <typename Space, int N, typename Scalar>
[[nodiscard]] Vector<Space::kRows, Scalar> task_error(const Kinematics<Space, N, Scalar>& kinematics,
                                                      const typename Space::template Point<Scalar>& x) noexcept {
  return Space::template difference<Scalar>(x, kinematics.tip);
}

/// J at the state of the kinematics with all rows in metres: the angular rows are multiplied by the characteristic
/// length. The rows have no lead: null-space motion must not change the rows of the bounds on the tip, which are
/// evaluated at this state too. With a lead, the saturation would use the difference of 1e-3 between the rows for
/// null-space motion at the bounds of the joints (TaskBounds.stop_gently_before_a_wall).
template <typename Space, int N, typename Scalar>
[[nodiscard]] Matrix<kLimitedRows<Space, N>, N, Scalar> jacobian_in_metres(
    const Kinematics<Space, N, Scalar>& kinematics) noexcept {
  Matrix<kLimitedRows<Space, N>, N, Scalar> J = kinematics.J;
  if (kinematics.lead > Scalar(0)) add_lead(J, -kinematics.lead, kinematics.Jd);
  for (Eigen::Index j = 0; Space::kTurns > 0 && j < J.cols(); ++j) {
    for (int i = Space::kRows - Space::kTurns; i < Space::kRows; ++i) J.coeffRef(i, j) *= kinematics.length;
  }
  return J;
}

}  // namespace fpbm
