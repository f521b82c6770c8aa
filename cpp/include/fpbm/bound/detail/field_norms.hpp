#pragma once

#include "fpbm/core/types.hpp"
#include "fpbm/linalg/detail/sums.hpp"

namespace fpbm {

/// Norms S_i = max s_k, k ≥ i, of the derivatives of all mass points x with respect to the joints, which decrease, and
/// sums of products with S (docs/torques_proof.md, "Between two evaluations").
template <typename AllJoints>
struct FieldNorms {
  using Scalar = typename AllJoints::Scalar;

  AllJoints S;
  AllJoints steps;  ///< S_i − S_{i+1}

  /// For each joint i: Σ S_m x_j y_k … over all tuples of joints j, k, …, of which m is the last joint, or i if i is
  /// beyond: a bound on the norm of Σ ∂…∂x/∂q_i∂q_j∂q_k… x_j y_k …. x, y, …: cumulative sums over the joints.
  template <typename... Sums>
  [[nodiscard]] AllJoints with(const Sums&... x) const noexcept {
    AllJoints result = S;
    Scalar sum(0);
    for (Eigen::Index i = S.size() - 1; i >= 0; --i) result.coeffRef(i) = sum += steps.coeff(i) * (x.coeff(i) * ...);
    return result;
  }

  /// The same sum over all tuples, without a joint i.
  template <typename... Sums>
  [[nodiscard]] Scalar of(const Sums&... x) const noexcept {
    return sum_over(S, [&](Eigen::Index i) { return steps.coeff(i) * (x.coeff(i) * ...); });
  }
};

}  // namespace fpbm
