#pragma once

#include <algorithm>

#include "fpbm/limits/detail/rows.hpp"
#include "fpbm/limits/detail/smallest_task_change.hpp"
#include "fpbm/linalg/detail/sums.hpp"

namespace fpbm {

/// The matrix B of RowProjection for the nearest motion that satisfies rows (docs/clearance_proof.md, Rows):
///
///   min ‖J(u − u₀)‖²_A + μ‖u − u₀‖²   where g_k·u ≤ b_k,   ‖x‖²_A = xᵀAx,   B = μA⁻¹.
///
/// Null-space motion has the small cost μ. Therefore the arm first avoids a shape by null-space motion. If null-space
/// motion is not sufficient, the tip slides along the shape. A is the identity, except in the direction of δ, the
/// smallest change of the task that satisfies the rows (smallest_task_change()). In the direction of δ, the eigenvalue
/// of A is
///
///   1/(1 + l²/kTaskChangeWeight),   l = max(1 − ν/kSufficientNullSpace, 0),
///
/// where ν is the fraction of null-space motion in the motion that the rows require. If ν is almost zero, null-space
/// motion contributes almost nothing. With A = I, all joints would then move fast, only to reduce the tip error by a
/// millimetre. desired: u₀.
template <int M, int N, int P, typename Scalar>
[[nodiscard]] Matrix<M, M, Scalar> inverse_task_metric(const Matrix<M, N, Scalar>& J, const Rows<N, P, Scalar>& rows,
                                                       const Vector<N, Scalar>& desired) noexcept {
  /// μ as a fraction of ‖J‖²_F. The error of a tip that slides along a wall is proportional to μ: at most 0.2 mm with
  /// 1e-4, and 1.8 mm with 1e-3 (`fpbm_tests --gtest_filter='Bounds.slides*'`).
  constexpr Scalar kNullSpaceCost = Scalar(1e-4);
  /// Eigenvalue of A along δ if null-space motion contributes nothing (ν = 0). With 1e-5 to 1e-2,
  /// Bounds.is_the_same_for_joints_counted_at_run_time passes. With 0.1, the motion is so sensitive to round-off that
  /// the test fails.
  constexpr Scalar kTaskChangeWeight = Scalar(1e-3);
  /// Smallest ν with A = I. The test of kTaskChangeWeight passes with 0.01, and fails with 0.
  constexpr Scalar kSufficientNullSpace = Scalar(0.1);
  const Scalar mu = kNullSpaceCost * squared_norm(J);
  const auto [delta, null_space_fraction] = smallest_task_change(J, mu, rows, desired);
  const Scalar square = squared_norm(delta);
  const Scalar shortfall = std::max(Scalar(1) - null_space_fraction / kSufficientNullSpace, Scalar(0));  // l
  const Scalar weight = square > Scalar(0) ? shortfall * shortfall * mu / kTaskChangeWeight / square : Scalar(0);
  Matrix<M, M, Scalar> B;
  B.resize(J.rows(), J.rows());
  for (Eigen::Index j = 0; j < J.rows(); ++j) {
    for (Eigen::Index i = 0; i < J.rows(); ++i) {
      B.coeffRef(i, j) = weight * delta.coeff(i) * delta.coeff(j) + (i == j ? mu : Scalar(0));
    }
  }
  return B;
}

}  // namespace fpbm
