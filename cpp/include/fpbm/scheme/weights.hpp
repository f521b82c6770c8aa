#pragma once

#include <algorithm>
#include <cmath>

#include "fpbm/core/detail/validation.hpp"
#include "fpbm/linalg/detail/entrywise.hpp"
#include "fpbm/linalg/detail/pair.hpp"
#include "fpbm/linalg/detail/product.hpp"

/// Weights W of the joint motion, symmetric and positive definite, as three types with increasing cost. The third type,
/// DenseWeights, is in dense_weights.hpp.
///
/// Only the ratios of W matter (docs/equations.md, Tests of the statements). Each type scales W so that the largest
/// diagonal entry of W⁻¹ is 1: W may have any magnitude. All types have the same functions:
///   times(a)            W a
///   root(a)             C a, where C Cᵀ = W⁻¹
///   inverse_root(a)     C⁻¹a
///   root_transpose(A)   CᵀA for a vector, or for Jᵀ
///   with_unit(J)        pairs of the entries of Jᵀ and CᵀJᵀ
///   inverse_bound()     an upper bound on the largest eigenvalue of W⁻¹
///   is_unit()           whether W = I
///   require_dof(n)      throws std::invalid_argument if W is for another number of joints
namespace fpbm {

/// W = I.
struct UnitWeights {
  void require_dof(Eigen::Index) const noexcept {}
  [[nodiscard]] static constexpr bool is_unit() noexcept { return true; }

  template <typename Scalar>
  [[nodiscard]] Scalar inverse_bound() const noexcept {
    return Scalar(1);
  }

  template <int N, typename Scalar>
  [[nodiscard]] const Vector<N, Scalar>& times(const Vector<N, Scalar>& a) const noexcept {
    return a;
  }

  template <int N, typename Scalar>
  [[nodiscard]] const Vector<N, Scalar>& root(const Vector<N, Scalar>& a) const noexcept {
    return a;
  }

  template <int N, typename Scalar>
  [[nodiscard]] const Vector<N, Scalar>& inverse_root(const Vector<N, Scalar>& a) const noexcept {
    return a;
  }

  template <int N, int M, typename Scalar>
  [[nodiscard]] const Matrix<N, M, Scalar>& root_transpose(const Matrix<N, M, Scalar>& A) const noexcept {
    return A;
  }

  template <int M, int N, typename Scalar>
  [[nodiscard]] Matrix<N, M, Pair<Scalar>> with_unit(const Matrix<M, N, Scalar>& J) const noexcept {
    const Matrix<N, M, Scalar> Jt = transpose_of(J);
    return side_by_side<N, M, Scalar>(Jt, Jt);
  }
};

/// W = diag(w).
template <int N, typename Scalar = double>
class DiagonalWeights {
 public:
  /// Throws std::invalid_argument unless all weights are positive and finite.
  explicit DiagonalWeights(const Vector<N, Scalar>& weights) {
    validation::require_dof("weights", weights.size(), 1);
    validation::require_positive("weights", weights);
    using std::min;
    using std::sqrt;
    Scalar least = weights(0);
    for (Eigen::Index i = 1; i < weights.size(); ++i) least = min(least, weights(i));
    weights_ = entrywise(weights, [&](Eigen::Index i) { return weights(i) / least; });
    root_ = entrywise(weights, [&](Eigen::Index i) { return sqrt(least / weights(i)); });
  }

  /// Weights with lanes: get(lane) returns the weights of one lane.
  template <typename Get>
  [[nodiscard]] static DiagonalWeights side_by_side(const Get& get) {
    DiagonalWeights result;
    const Eigen::Index dof = get(0).root_.size();
    result.weights_.resize(dof);
    result.root_.resize(dof);
    for (Eigen::Index i = 0; i < dof; ++i) {
      result.weights_(i) = Scalar([&](auto lane) { return get(lane).weights_(i); });
      result.root_(i) = Scalar([&](auto lane) { return get(lane).root_(i); });
    }
    return result;
  }

  void require_dof(Eigen::Index dof) const { validation::require_size("weights", root_.size(), dof); }
  [[nodiscard]] static constexpr bool is_unit() noexcept { return false; }

  template <typename>
  [[nodiscard]] Scalar inverse_bound() const noexcept {
    return Scalar(1);
  }

  [[nodiscard]] Vector<N, Scalar> times(const Vector<N, Scalar>& a) const noexcept {
    return diagonal_times<N, 1, Scalar>(weights_, a);
  }

  [[nodiscard]] Vector<N, Scalar> root(const Vector<N, Scalar>& a) const noexcept {
    return diagonal_times<N, 1, Scalar>(root_, a);
  }

  [[nodiscard]] Vector<N, Scalar> inverse_root(const Vector<N, Scalar>& a) const noexcept {
    return entrywise(a, [&](Eigen::Index i) { return a.coeff(i) / root_.coeff(i); });
  }

  template <int M>
  [[nodiscard]] Matrix<N, M, Scalar> root_transpose(const Matrix<N, M, Scalar>& A) const noexcept {
    return diagonal_times<N, M, Scalar>(root_, A);
  }

  template <int M>
  [[nodiscard]] Matrix<N, M, Pair<Scalar>> with_unit(const Matrix<M, N, Scalar>& J) const noexcept {
    Matrix<N, M, Pair<Scalar>> result;
    result.resize(J.cols(), J.rows());
    for (Eigen::Index i = 0; i < J.cols(); ++i) {
      const Pair<Scalar> root(Scalar(1), root_(i));
      for (Eigen::Index j = 0; j < J.rows(); ++j) result(i, j) = Pair<Scalar>(J(j, i)) * root;
    }
    return result;
  }

 private:
  template <int, typename>
  friend class DiagonalWeights;

  DiagonalWeights() = default;

  Vector<N, Scalar> weights_;
  Vector<N, Scalar> root_;
};

}  // namespace fpbm
