#pragma once

#include <cmath>
#include <limits>

#include "fpbm/core/validation.hpp"
#include "fpbm/linalg/cholesky.hpp"
#include "fpbm/linalg/pair.hpp"

namespace fpbm {

/// W dense.
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
    root_ = Matrix<N, N, Scalar>::Identity(W.rows(), W.cols());
    for (Eigen::Index j = 0; j < W.cols(); ++j) root_.col(j) = cholesky.inverse_root(root_.col(j));
    const Scalar largest = root_.rowwise().squaredNorm().maxCoeff();
    root_ /= std::sqrt(largest);
    weights_ = largest * W;
  }

  void require_dof(Eigen::Index dof) const { validation::require_size("weights", root_.rows(), dof); }
  [[nodiscard]] static constexpr bool is_unit() noexcept { return false; }

  template <typename>
  [[nodiscard]] Scalar inverse_bound() const noexcept {
    return root_.squaredNorm();
  }

  template <typename Derived>
  [[nodiscard]] auto times(const Eigen::MatrixBase<Derived>& a) const noexcept {
    return weights_.lazyProduct(a.derived());
  }

  template <typename Derived>
  [[nodiscard]] auto root(const Eigen::MatrixBase<Derived>& a) const noexcept {
    return root_.lazyProduct(a.derived());
  }

  template <typename Derived>
  [[nodiscard]] Vector<N, Scalar> unroot(const Eigen::MatrixBase<Derived>& a) const noexcept {
    const Vector<N, Scalar> Wa = times(a);
    return root_transpose(Wa);
  }

  template <typename Derived>
  [[nodiscard]] auto root_transpose(const Eigen::MatrixBase<Derived>& A) const noexcept {
    return root_.transpose().lazyProduct(A.derived());
  }

  template <int M>
  [[nodiscard]] Matrix<N, M, Pair<Scalar>> with_unit(const Matrix<M, N, Scalar>& J) const noexcept {
    return side_by_side<N, M, Scalar>(J.transpose(), root_transpose(J.transpose()));
  }

 private:
  static void require_symmetric(const Matrix<N, N, Scalar>& W) {
    validation::require_size("weights (columns)", W.cols(), W.rows());
    for (Eigen::Index j = 0; j < W.cols(); ++j) {
      for (Eigen::Index i = 0; i < W.rows(); ++i) {
        validation::require_finite(validation::element("weights", i, j), W(i, j));
      }
    }
    using std::abs;
    const Scalar tolerance = std::sqrt(std::numeric_limits<Scalar>::epsilon()) * W.cwiseAbs().maxCoeff();
    for (Eigen::Index j = 0; j < W.cols(); ++j) {
      for (Eigen::Index i = j + 1; i < W.rows(); ++i) {
        if (abs(W(i, j) - W(j, i)) > tolerance) {
          validation::fail(validation::element("weights", i, j), W(i, j),
                           "equal to its mirror image, since W is symmetric");
        }
      }
    }
  }

  Matrix<N, N, Scalar> weights_;
  Matrix<N, N, Scalar> root_;
};

}  // namespace fpbm
