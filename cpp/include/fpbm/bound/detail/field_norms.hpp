#pragma once

#include <array>
#include <cmath>

#include "fpbm/core/types.hpp"
#include "fpbm/linalg/detail/sums.hpp"

namespace fpbm {

/// Parent of each joint in a robot, or −1 on the base. kTree: for any tree; otherwise, for chains.
template <bool kTree, int Joints>
struct JointParents {
  const std::array<int, static_cast<std::size_t>(kCapacity<Joints>)>& of;

  [[nodiscard]] Eigen::Index operator()(Eigen::Index i) const noexcept {
    if constexpr (kTree) {
      return of[static_cast<std::size_t>(i)];
    } else {
      return i - 1;
    }
  }

  /// Sums of magnitudes from the base to each joint.
  template <typename AllJoints>
  [[nodiscard]] AllJoints outward(AllJoints x) const noexcept {
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      const Eigen::Index parent = (*this)(i);
      x.coeffRef(i) = std::abs(x.coeff(i)) + (parent < 0 ? typename AllJoints::Scalar(0) : x.coeff(parent));
    }
    return x;
  }
  /// Sums over each joint and all joints beyond.
  template <typename AllJoints>
  [[nodiscard]] AllJoints inward(AllJoints x) const noexcept {
    for (Eigen::Index i = x.size() - 1; i >= 0; --i) {
      if (const Eigen::Index parent = (*this)(i); parent >= 0) x.coeffRef(parent) += x.coeff(i);
    }
    return x;
  }
};

/// Bounds S on the norms s of the derivatives of all mass points with respect to the joints, and sums of products with
/// S (docs/torques_proof.md, "Between two evaluations").
template <bool kTree, int Joints, typename Scalar>
struct FieldNorms {
  using AllJoints = Vector<Joints, Scalar>;

  JointParents<kTree, Joints> parents;
  AllJoints S;
  AllJoints steps;  ///< S_i minus S of all children.

  FieldNorms(const JointParents<kTree, Joints>& tree, const AllJoints& sizes) noexcept
      : parents(tree), S(sizes), steps(sizes) {
    for (Eigen::Index i = 0; i < S.size(); ++i) {
      if (const Eigen::Index parent = parents(i); parent >= 0) steps.coeffRef(parent) -= S.coeff(i);
    }
  }

  /// For each joint i: Σ S_m |x_j y_k …| over all tuples of joints j, k, … that are, with joint i, on a chain from the
  /// base, of which m is the last joint: a bound on the norm of Σ ∂…∂x/∂q_i∂q_j∂q_k… x_j y_k …. x, y, …: outward sums.
  template <typename... Sums>
  [[nodiscard]] AllJoints with(const Sums&... x) const noexcept {
    return parents.inward(AllJoints(entrywise(S, [&](Eigen::Index i) { return steps.coeff(i) * (x.coeff(i) * ...); })));
  }
  /// The same sum over all tuples, without a joint i.
  template <typename... Sums>
  [[nodiscard]] Scalar of(const Sums&... x) const noexcept {
    return sum_over(S, [&](Eigen::Index i) { return steps.coeff(i) * (x.coeff(i) * ...); });
  }
};

}  // namespace fpbm
