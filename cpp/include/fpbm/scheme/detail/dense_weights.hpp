#pragma once

#include <cmath>
#include <limits>

#include "fpbm/core/detail/validation.hpp"
#include "fpbm/linalg/detail/cholesky.hpp"
#include "fpbm/linalg/detail/entrywise.hpp"
#include "fpbm/linalg/detail/pair.hpp"
#include "fpbm/linalg/detail/product.hpp"
#include "fpbm/linalg/detail/sums.hpp"

namespace fpbm {

/// Dense W.
template <int N, typename Scalar = double>
class DenseWeights {
 public:
  /// Throws std::invalid_argument unless W is finite, symmetric (to round-off) and positive definite.
  explicit DenseWeights(const Matrix<N, N, Scalar>& W) {
    validation::require_dof("weights", W.rows(), 1);
    require_symmetric(W);
    Cholesky<N, Scalar> cholesky;
    if (cholesky.factor(W) != Status::kOk) {
      const Eigen::Index i = cholesky.lost_pivot();
      validation::fail(validation::element("weights", i, i), W(i, i), "larger: W is not positive definite");
    }
    set(W, [&](const Vector<N, Scalar>& axis) { return cholesky.inverse_root(axis); });
  }

  /// W = M, for a mass matrix M with its factorisation.
  [[nodiscard]] static DenseWeights of(const Matrix<N, N, Scalar>& M, const Cholesky<N, Scalar>& cholesky) noexcept {
    DenseWeights result;
    result.set(M, [&](const Vector<N, Scalar>& axis) { return cholesky.inverse_root(axis); });
    return result;
  }
  /// W = M². C = M⁻¹ is computed from M, so that the condition number of M² has no effect.
  [[nodiscard]] static DenseWeights of_square(const Matrix<N, N, Scalar>& M,
                                              const Cholesky<N, Scalar>& cholesky) noexcept {
    DenseWeights result;
    result.set(gram_of(M), [&](const Vector<N, Scalar>& axis) { return cholesky.solve(axis); });
    return result;
  }

  void require_dof(Eigen::Index dof) const { validation::require_size("weights", root_.rows(), dof); }
  [[nodiscard]] static constexpr bool is_unit() noexcept { return false; }

  template <typename>
  [[nodiscard]] Scalar inverse_bound() const noexcept {
    return squared_norm(root_);
  }

  [[nodiscard]] Vector<N, Scalar> times(const Vector<N, Scalar>& a) const noexcept { return product(weights_, a); }

  [[nodiscard]] Vector<N, Scalar> root(const Vector<N, Scalar>& a) const noexcept { return product(root_, a); }

  [[nodiscard]] Vector<N, Scalar> inverse_root(const Vector<N, Scalar>& a) const noexcept {
    return transpose_times(root_, times(a));
  }

  template <int M>
  [[nodiscard]] Matrix<N, M, Scalar> root_transpose(const Matrix<N, M, Scalar>& A) const noexcept {
    if constexpr (M == 1) {
      return transpose_times(root_, A);
    } else {
      Matrix<N, M, Scalar> result = A;
      for (Eigen::Index j = 0; j < A.cols(); ++j) set_column(result, j, transpose_times(root_, column(A, j)));
      return result;
    }
  }

  template <int M>
  [[nodiscard]] Matrix<N, M, Pair<Scalar>> with_unit(const Matrix<M, N, Scalar>& J) const noexcept {
    const Matrix<N, M, Scalar> Jt = transpose_of(J);
    return side_by_side<N, M, Scalar>(Jt, root_transpose<M>(Jt));
  }

 private:
  DenseWeights() = default;

  /// root(a): C a, for any C with C Cᵀ = W⁻¹.
  template <typename Root>
  void set(const Matrix<N, N, Scalar>& W, const Root& root) noexcept {
    root_.resize(W.rows(), W.cols());
    auto diagonal = filled<Vector<N, Scalar>>(W.rows());  // Diagonal of W⁻¹.
    for (Eigen::Index j = 0; j < W.cols(); ++j) {
      auto axis = filled<Vector<N, Scalar>>(W.rows());
      axis(j) = Scalar(1);
      const Vector<N, Scalar> column = root(axis);
      set_column(root_, j, column);
      for (Eigen::Index i = 0; i < W.rows(); ++i) diagonal(i) += column(i) * column(i);
    }
    const Scalar largest = largest_magnitude(diagonal);
    const Scalar scale = std::sqrt(largest);
    root_ = entrywise(root_, [&](Eigen::Index i) { return root_.coeff(i) / scale; });
    weights_ = entrywise(W, [&](Eigen::Index i) { return largest * W.coeff(i); });
  }

  static void require_symmetric(const Matrix<N, N, Scalar>& W) {
    validation::require_size("weights (columns)", W.cols(), W.rows());
    for (Eigen::Index j = 0; j < W.cols(); ++j) {
      for (Eigen::Index i = 0; i < W.rows(); ++i) {
        validation::require_finite(validation::element("weights", i, j), W(i, j));
      }
    }
    using std::abs;
    // Tolerance of half of the digits: W may be a product of matrices with a round-off error, or an input with few
    // decimals.
    const Scalar tolerance = std::sqrt(std::numeric_limits<Scalar>::epsilon()) * largest_magnitude(W);
    for (Eigen::Index j = 0; j < W.cols(); ++j) {
      for (Eigen::Index i = j + 1; i < W.rows(); ++i) {
        if (abs(W(i, j) - W(j, i)) > tolerance) {
          validation::fail(validation::element("weights", i, j), W(i, j),
                           "equal to the transposed entry: W must be symmetric");
        }
      }
    }
  }

  Matrix<N, N, Scalar> weights_;
  Matrix<N, N, Scalar> root_;
};

}  // namespace fpbm
