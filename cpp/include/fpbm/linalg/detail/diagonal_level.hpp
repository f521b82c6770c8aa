#pragma once

#include <algorithm>
#include <cmath>

#include "fpbm/core/types.hpp"
#include "fpbm/linalg/detail/column_sums.hpp"
#include "fpbm/linalg/detail/entrywise.hpp"

namespace fpbm {

/// Rows of a task level that is a posture of all joints: J = diag(entries), without zeros on the diagonal.
template <int N, typename Scalar>
struct DiagonalLevel {
  Vector<N, Scalar> entries;  ///< Diagonal of J, n entries.

  [[nodiscard]] Eigen::Index rows() const noexcept { return entries.size(); }
  /// Smallest magnitude of an entry: a lower bound on the singular values of J Z for any Z with orthonormal columns.
  [[nodiscard]] Scalar least() const noexcept {
    return std::abs(*std::min_element(entries.data(), entries.data() + entries.size(),
                                      [](Scalar a, Scalar b) { return std::abs(a) < std::abs(b); }));
  }
  [[nodiscard]] Matrix<N, N, Scalar> matrix() const noexcept {
    auto J = filled<Matrix<N, N, Scalar>>(entries.size());
    for (Eigen::Index i = 0; i < entries.size(); ++i) J.coeffRef(i, i) = entries.coeff(i);
    return J;
  }
};

/// J v.
template <int N, typename Scalar>
[[nodiscard]] Vector<N, Scalar> product(const DiagonalLevel<N, Scalar>& J, const Vector<N, Scalar>& v) noexcept {
  return entrywise(v, [&](Eigen::Index i) { return J.entries.coeff(i) * v.coeff(i); });
}

/// Whether A is square and diagonal, without zeros on the diagonal. The rows of A are then a posture of all joints,
/// which determines all null-space motion of the higher levels and needs no factorisation of A.
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

/// y = Z (ZᵀD²Z)⁻¹ ZᵀD r, which minimises |D y − r| over the span of the columns of Z, which are orthonormal. D y is
/// the projection of r on the columns of D Z, which the modified Gram-Schmidt method makes orthogonal.
template <int N, typename Scalar, typename Basis>
[[nodiscard]] Vector<N, Scalar> solve_diagonal(Basis Z, const Vector<N, Scalar>& D,
                                               const Vector<N, Scalar>& r) noexcept {
  const Eigen::Index n = Z.rows();
  auto squares = filled<Vector<N, Scalar>>(n);
  Vector<N, Scalar> left = r;
  for (Eigen::Index j = 0; j < Z.cols(); ++j) {
    Scalar* const column = Z.data() + j * n;
    for (Eigen::Index i = 0; i < n; ++i) column[i] *= D.coeff(i);
    const auto remove_from = [&](Scalar* v, Eigen::Index k) noexcept {
      const Scalar along = column_dot<Scalar>(Z.data() + k * n, v, n);
      if (along != Scalar(0)) subtract_multiple(v, along / squares.coeff(k), Z.data() + k * n, n);
    };
    for (Eigen::Index k = 0; k < j; ++k) remove_from(column, k);
    squares.coeffRef(j) = squared_length(column, n);
    remove_from(left.data(), j);
  }
  return entrywise(r, [&](Eigen::Index i) { return (r.coeff(i) - left.coeff(i)) / D.coeff(i); });
}

}  // namespace fpbm
