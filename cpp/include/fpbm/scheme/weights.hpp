#pragma once

#include "fpbm/core/validation.hpp"
#include "fpbm/linalg/pair.hpp"

/// W, the symmetric positive definite weight of each joint's motion, in three kinds of rising cost; dense_weights.hpp
/// has the third.
///
/// Only the ratios of W matter, so each kind keeps W scaled so that W⁻¹ has a largest diagonal entry of 1: no W is too
/// large or too small. Each has the same functions:
///   times(a)            W a
///   root(a)             C a, where C Cᵀ = W⁻¹
///   unroot(a)           C⁻¹a
///   root_transpose(A)   CᵀA of a vector, or of Jᵀ
///   with_unit(J)        Jᵀ and CᵀJᵀ side by side
///   inverse_bound()     a bound on the largest eigenvalue of W⁻¹
///   is_unit()           whether W = I
///   require_dof(n)      throws std::invalid_argument where W is for another number of joints
namespace fpbm {

/// W = I.
struct UnitWeights {
  void require_dof(Eigen::Index) const noexcept {}
  [[nodiscard]] static constexpr bool is_unit() noexcept { return true; }

  template <typename Scalar>
  [[nodiscard]] Scalar inverse_bound() const noexcept {
    return Scalar(1);
  }

  template <typename Derived>
  [[nodiscard]] const Derived& times(const Eigen::MatrixBase<Derived>& a) const noexcept {
    return a.derived();
  }

  template <typename Derived>
  [[nodiscard]] const Derived& root(const Eigen::MatrixBase<Derived>& a) const noexcept {
    return a.derived();
  }

  template <typename Derived>
  [[nodiscard]] const Derived& unroot(const Eigen::MatrixBase<Derived>& a) const noexcept {
    return a.derived();
  }

  template <typename Derived>
  [[nodiscard]] const Derived& root_transpose(const Eigen::MatrixBase<Derived>& A) const noexcept {
    return A.derived();
  }

  template <int M, int N, typename Scalar>
  [[nodiscard]] Matrix<N, M, Pair<Scalar>> with_unit(const Matrix<M, N, Scalar>& J) const noexcept {
    const Matrix<N, M, Scalar> Jt = J.transpose();
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
    const Scalar least = weights.minCoeff();
    weights_ = weights / least;
    root_ = (least * weights.cwiseInverse()).cwiseSqrt();
  }

  /// In lanes: get(lane) is the weights of one lane.
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

  template <typename Derived>
  [[nodiscard]] auto times(const Eigen::MatrixBase<Derived>& a) const noexcept {
    return weights_.asDiagonal() * a.derived();
  }

  template <typename Derived>
  [[nodiscard]] auto root(const Eigen::MatrixBase<Derived>& a) const noexcept {
    return root_.asDiagonal() * a.derived();
  }

  template <typename Derived>
  [[nodiscard]] auto unroot(const Eigen::MatrixBase<Derived>& a) const noexcept {
    return a.cwiseQuotient(root_);
  }

  template <typename Derived>
  [[nodiscard]] auto root_transpose(const Eigen::MatrixBase<Derived>& A) const noexcept {
    return root_.asDiagonal() * A.derived();
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
