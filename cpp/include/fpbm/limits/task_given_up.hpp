#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "fpbm/limits/rows.hpp"
#include "fpbm/linalg/cholesky.hpp"
#include "fpbm/linalg/entrywise.hpp"
#include "fpbm/linalg/product.hpp"
#include "fpbm/linalg/sums.hpp"

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
  auto change = filled<Vector<M, Scalar>>(J.rows());
  Matrix<M, M, Scalar> gram = gram_of(J);
  for (Eigen::Index i = 0; i < J.rows(); ++i) gram(i, i) += mu;
  Cholesky<M, Scalar> cholesky;
  if (cholesky.factor(gram) != Status::kOk) return {change, Scalar(0)};
  std::array<Vector<M, Scalar>, P> normals;  // Of the rows, in the task's space.
  Vector<P, Scalar> squares;
  Vector<P, Scalar> excess;  // Of u over the rows.
  Vector<P, Scalar> multipliers;
  for (Eigen::Index k = 0; k < rows.count; ++k) {
    Vector<M, Scalar>& normal = normals[static_cast<std::size_t>(k)];
    normal = cholesky.solve(product(J, column(rows.g, k)));
    squares(k) = squared_norm(normal);
    excess(k) = rows.excess(k, u);
    multipliers(k) = Scalar(0);
  }
  for (int round = 0; round < kRounds; ++round) {
    for (Eigen::Index k = 0; k < rows.count; ++k) {
      if (!(squares(k) > Scalar(0))) continue;
      const Vector<M, Scalar>& normal = normals[static_cast<std::size_t>(k)];
      const Scalar beyond = excess(k) + dot(normal, change);
      const Scalar multiplier = std::max(multipliers(k) + beyond / squares(k), Scalar(0));
      const Scalar added = multiplier - multipliers(k);
      change = entrywise(change, [&](Eigen::Index i) { return change.coeff(i) - added * normal.coeff(i); });
      multipliers(k) = multiplier;
    }
  }
  auto asked = filled<Vector<N, Scalar>>(J.cols());
  for (Eigen::Index k = 0; k < rows.count; ++k) {
    asked = entrywise(asked, [&](Eigen::Index i) { return asked.coeff(i) + multipliers(k) * rows.g.coeff(i, k); });
  }
  const Scalar square = squared_norm(asked);
  if (!(square > Scalar(0))) return {change, Scalar(0)};
  asked = sum_of(asked, transpose_times(J, change));  // N v, as change is −(JJᵀ + μI)⁻¹ J v.
  return {change, squared_norm(asked) / square};
}

}  // namespace fpbm
