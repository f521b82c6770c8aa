#pragma once

#include <Eigen/Core>
#include <cmath>

#include "fpbm/core/types.hpp"

namespace fpbm {

/// Euclidean norm of `count` entries in memory.
template <typename Scalar>
[[nodiscard]] Scalar length_of(const Scalar* entries, Eigen::Index count) noexcept {
  Scalar square(0);
  for (Eigen::Index i = 0; i < count; ++i) square += entries[i] * entries[i];
  return std::sqrt(square);
}

/// Solves L w = r, by least squares if L has more rows than columns. w replaces the first `count` entries of r. Row j
/// of L starts at entry `first` of column j of T and has `count` entries. The upper square block of L is lower
/// triangular.
template <int M, int N, typename Scalar>
void solve_trapezoidal(const Matrix<N, M, Scalar>& T, Eigen::Index first, Eigen::Index count,
                       Vector<M, Scalar>& r) noexcept {
  if constexpr (M == 1) {
    if (count == 1) r.coeffRef(0) /= T.coeff(first, 0);
    return;
  }
  const Eigen::Index m = T.cols();
  if (m == count) {
    for (Eigen::Index i = 0; i < count; ++i) {
      for (Eigen::Index j = 0; j < i; ++j) r.coeffRef(i) -= T.coeff(first + j, i) * r.coeff(j);
      r.coeffRef(i) /= T.coeff(first + i, i);
    }
    return;
  }
  // L = Q R by the modified Gram-Schmidt method. Each column is orthogonalised twice to reduce the round-off error.
  Matrix<M, M, Scalar> Q;
  Matrix<M, M, Scalar> R;
  Q.resize(m, m);
  R.resize(m, m);
  Vector<M, Scalar> w = filled<Vector<M, Scalar>>(m);
  const auto along_column = [&](Eigen::Index i, const auto& x) noexcept {
    Scalar sum(0);
    for (Eigen::Index j = 0; j < m; ++j) sum += Q.coeff(j, i) * x(j);
    return sum;
  };
  for (Eigen::Index k = 0; k < count; ++k) {
    for (Eigen::Index j = 0; j < m; ++j) Q.coeffRef(j, k) = T.coeff(first + k, j);
    for (Eigen::Index i = 0; i < k; ++i) R.coeffRef(i, k) = Scalar(0);
    const auto q = [&](Eigen::Index j) noexcept -> Scalar& { return Q.coeffRef(j, k); };
    for (int round = 0; round < 2; ++round) {
      for (Eigen::Index i = 0; i < k; ++i) {
        const Scalar along = along_column(i, q);
        R.coeffRef(i, k) += along;
        for (Eigen::Index j = 0; j < m; ++j) q(j) -= along * Q.coeff(j, i);
      }
    }
    const Scalar length = length_of(&Q.coeffRef(0, k), m);
    R.coeffRef(k, k) = length;
    for (Eigen::Index j = 0; j < m; ++j) q(j) /= length;
    w.coeffRef(k) = along_column(k, [&](Eigen::Index j) noexcept { return r.coeff(j); });
    for (Eigen::Index j = 0; j < m; ++j) r.coeffRef(j) -= w.coeff(k) * q(j);
  }
  for (Eigen::Index k = count; k-- > 0;) {
    for (Eigen::Index i = k + 1; i < count; ++i) w.coeffRef(k) -= R.coeff(k, i) * w.coeff(i);
    w.coeffRef(k) /= R.coeff(k, k);
  }
  r = w;
}

}  // namespace fpbm
