#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "fpbm/core/detail/mask.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/linalg/detail/cholesky.hpp"
#include "fpbm/model/kinematics.hpp"

namespace fpbm {

/// Manipulability w = √det(JJᵀ) of a task Jacobian (Yoshikawa 1985): the volume that the rows span, 0 at a singular
/// posture. Unit: the product of the units of the rows of J.
///
/// Computed as base times height, row by row, which is accurate near singular postures.
template <int M, int N, typename Scalar>
[[nodiscard]] Scalar manipulability(const Matrix<M, N, Scalar>& J) noexcept {
  using std::max;
  using std::sqrt;
  const Scalar tiny(std::numeric_limits<Number<Scalar>>::min());
  Matrix<M, N, Scalar> rows = J;
  Scalar volume(1);
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    const Scalar square = rows.row(i).squaredNorm();
    volume *= sqrt(square);
    const Scalar reciprocal = Scalar(1) / max(square, tiny);  // A zero row does not change the other rows.
    for (Eigen::Index j = i + 1; j < rows.rows(); ++j) {
      const Scalar along = rows.row(j).dot(rows.row(i)) * reciprocal;
      rows.row(j) -= along * rows.row(i);
    }
  }
  return volume;
}
template <typename Space, int N, typename Scalar>
[[nodiscard]] Scalar manipulability(const Kinematics<Space, N, Scalar>& kinematics) noexcept {
  return manipulability(kinematics.J);
}

/// Gradient of the manipulability of an arm in a task space: ∂w/∂q_k = w tr(J⁺ ∂J/∂q_k) (docs/equations.md, Secondary
/// objectives). ∂J/∂q_k is dJ/dt for a unit velocity of joint k, so that n + 1 calls of the kinematics are needed. Zero
/// at a singular posture, where w has no gradient.
template <typename Space, typename Arm>
[[nodiscard]] Vector<Arm::kDof, typename Arm::Scalar> manipulability_gradient(
    const Arm& arm, const Vector<Arm::kDof, typename Arm::Scalar>& q) noexcept {
  using Scalar = typename Arm::Scalar;
  constexpr int M = Space::kRows;
  constexpr int N = Arm::kDof;
  Vector<N, Scalar> gradient = Vector<N, Scalar>::Zero(q.size());
  Kinematics<Space, N, Scalar> kinematics;
  arm.kinematics(q, kinematics);
  Cholesky<M, Scalar> gram;
  if (gram.factor(kinematics.J.lazyProduct(kinematics.J.transpose())) != Status::kOk) return gradient;

  Matrix<M, N, Scalar> scaled = kinematics.J;  // w (J⁺)ᵀ
  const Scalar w = manipulability(kinematics.J);
  for (Eigen::Index j = 0; j < q.size(); ++j) scaled.col(j) = w * gram.solve(kinematics.J.col(j));
  Vector<N, Scalar> along = gradient;
  for (Eigen::Index k = 0; k < q.size(); ++k) {
    along(k) = Scalar(1);
    arm.kinematics(q, along, kinematics);
    along(k) = Scalar(0);
    gradient(k) = scaled.cwiseProduct(kinematics.Jd).sum();
  }
  return gradient;
}

}  // namespace fpbm
