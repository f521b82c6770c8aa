#pragma once

#include "fpbm/core/types.hpp"
#include "fpbm/linalg/cholesky.hpp"
#include "fpbm/linalg/sums.hpp"

namespace fpbm {

/// Whether A is square and diagonal, without zeros there: a posture of all joints determines all motion that the higher
/// levels leave, without a factorisation of A.
template <typename Matrix>
[[nodiscard]] bool is_diagonal(const Matrix& A) noexcept {
  if (A.rows() != A.cols()) return false;
  for (Eigen::Index j = 0; j < A.cols(); ++j) {
    for (Eigen::Index i = 0; i < A.rows(); ++i) {
      if ((A.coeff(i, j) != 0) != (i == j)) return false;
    }
  }
  return true;
}

/// y = Z (ZᵀD²Z)⁻¹ ZᵀD r, which minimises |D y − r| over the columns of Z: orthonormal, and at most n of them.
template <int N, typename Scalar, typename Basis, typename Diagonal, typename Rows>
[[nodiscard]] Vector<N, Scalar> solve_diagonal(const Basis& Z, const Diagonal& D, const Rows& r) noexcept {
  const Eigen::Index n = Z.rows();
  auto gram = filled<Matrix<N, N, Scalar>>(n);
  auto b = filled<Vector<N, Scalar>>(n);
  for (Eigen::Index j = 0; j < n; ++j) gram.coeffRef(j, j) = Scalar(1);  // Of columns that Z does not have.
  for (Eigen::Index j = 0; j < Z.cols(); ++j) {
    b.coeffRef(j) = sum_over(r, [&](Eigen::Index i) { return Z.coeff(i, j) * D.coeff(i, i) * r.coeff(i); });
    for (Eigen::Index k = 0; k <= j; ++k) {
      gram.coeffRef(j, k) =
          sum_over(r, [&](Eigen::Index i) { return Z.coeff(i, j) * Z.coeff(i, k) * (D.coeff(i, i) * D.coeff(i, i)); });
    }
  }
  Cholesky<N, Scalar> cholesky;
  (void)cholesky.factor(gram);  // Regular, as D and Z are.
  b = cholesky.solve(b);
  auto y = filled<Vector<N, Scalar>>(n);
  for (Eigen::Index j = 0; j < Z.cols(); ++j) {
    for (Eigen::Index i = 0; i < n; ++i) y.coeffRef(i) += Z.coeff(i, j) * b.coeff(j);
  }
  return y;
}

}  // namespace fpbm
