#pragma once

#include <algorithm>

#include "fpbm/limits/rows.hpp"
#include "fpbm/linalg/cholesky.hpp"

namespace fpbm {

/// What a task gives up for rows.
template <int M, typename Scalar>
struct GivenUp {
  Vector<M, Scalar> change;  ///< δ, of the task.
  Scalar self_motion;        ///< ‖N v‖² / ‖v‖²: how much of what the rows ask for, self-motion could do.
};

/// The least change of a task by which a motion u comes within rows, with the joints that the task itself would use:
///
///   min ‖δ‖² over δ with g_k · (u + J⁺δ) ≤ b_k, where J⁺ = Jᵀ (JJᵀ + μI)⁻¹.
///
/// By Hildreth's method (C. Hildreth 1957), some rounds of it: a continuous function of all inputs. Of a surface ahead
/// of the tip, δ is along the normal. v = Gᵀλ with the rows' multipliers λ, and N = I − J⁺J.
template <int M, int N, int P, typename Scalar>
[[nodiscard]] GivenUp<M, Scalar> task_given_up(const Matrix<M, N, Scalar>& J, Scalar mu, const Rows<N, P, Scalar>& rows,
                                               const Vector<N, Scalar>& u) noexcept {
  constexpr int kRounds = 8;
  Vector<M, Scalar> change = Vector<M, Scalar>::Zero(J.rows());
  Matrix<M, M, Scalar> gram = J.lazyProduct(J.transpose());
  gram.diagonal().array() += mu;
  Cholesky<M, Scalar> cholesky;
  if (cholesky.factor(gram) != Status::kOk) return {change, Scalar(0)};
  Matrix<M, P, Scalar> normals(J.rows(), P);  // Of the rows, in the task's space.
  Vector<P, Scalar> squares;
  Vector<P, Scalar> multipliers;
  for (Eigen::Index k = 0; k < rows.count; ++k) {
    normals.col(k) = cholesky.solve(Vector<M, Scalar>(J.lazyProduct(rows.g.col(k))));
    squares(k) = normals.col(k).squaredNorm();
    multipliers(k) = Scalar(0);
  }
  for (int round = 0; round < kRounds; ++round) {
    for (Eigen::Index k = 0; k < rows.count; ++k) {
      if (!(squares(k) > Scalar(0))) continue;
      const Scalar beyond = rows.excess(k, u) + normals.col(k).dot(change);
      const Scalar multiplier = std::max(multipliers(k) + beyond / squares(k), Scalar(0));
      change -= (multiplier - multipliers(k)) * normals.col(k);
      multipliers(k) = multiplier;
    }
  }
  Vector<N, Scalar> asked = Vector<N, Scalar>::Zero(J.cols());
  for (Eigen::Index k = 0; k < rows.count; ++k) asked += multipliers(k) * rows.g.col(k);
  const Scalar square = asked.squaredNorm();
  if (!(square > Scalar(0))) return {change, Scalar(0)};
  asked += J.transpose().lazyProduct(change);  // N v, as change is −(JJᵀ + μI)⁻¹ J v.
  return {change, asked.squaredNorm() / square};
}

}  // namespace fpbm
