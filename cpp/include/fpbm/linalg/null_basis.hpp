#pragma once

#include <cmath>
#include <limits>

#include "fpbm/core/types.hpp"

namespace fpbm {

/// Columns of the basis of a null space: N − M.
template <int M, int N>
inline constexpr int kNullity = N == Eigen::Dynamic ? Eigen::Dynamic : N - M;

/// Orthonormal basis Z of the null space of A (M × N, N ≥ M): AZ = 0, ZᵀZ = I, to round-off at every rank.
///
/// The last N − M columns of Q in Aᵀ = QR, by Householder reflections. Where A has lost rank they span a part of its
/// null space, which is larger then. Eigen's HouseholderQR takes 1.4 to 3.3 times as long (3 × 7 and 2 × 4).
template <int M, int N, typename Scalar>
[[nodiscard]] Matrix<N, kNullity<M, N>, Scalar> null_basis(const Matrix<M, N, Scalar>& A) noexcept {
  using std::sqrt;
  // A column with less left counts as zero: its square underflows and has no finite inverse.
  constexpr Scalar kLeast = std::numeric_limits<Scalar>::min() / std::numeric_limits<Scalar>::epsilon();
  const Eigen::Index n = A.cols();
  const Eigen::Index m = A.rows();
  Matrix<N, M, Scalar> V = A.transpose();  // Column k becomes the k-th reflection's vector, below row k − 1.
  Vector<M, Scalar> beta;
  for (Eigen::Index k = 0; k < m; ++k) {
    Scalar square = Scalar(0);
    for (Eigen::Index i = k; i < n; ++i) square += V(i, k) * V(i, k);
    const Scalar head = V(k, k);
    V(k, k) += head < Scalar(0) ? -sqrt(square) : sqrt(square);
    const Scalar length = square + sqrt(square) * (head < Scalar(0) ? -head : head);
    beta(k) = length > kLeast ? Scalar(1) / length : Scalar(0);
    for (Eigen::Index j = k + 1; j < m; ++j) {
      Scalar along = Scalar(0);
      for (Eigen::Index i = k; i < n; ++i) along += V(i, k) * V(i, j);
      for (Eigen::Index i = k; i < n; ++i) V(i, j) -= beta(k) * along * V(i, k);
    }
  }
  Matrix<N, kNullity<M, N>, Scalar> Z(n, n - m);
  Z.setZero();
  for (Eigen::Index j = 0; j < n - m; ++j) {
    Z(m + j, j) = Scalar(1);
    for (Eigen::Index k = m - 1; k >= 0; --k) {
      Scalar along = Scalar(0);
      for (Eigen::Index i = k; i < n; ++i) along += V(i, k) * Z(i, j);
      for (Eigen::Index i = k; i < n; ++i) Z(i, j) -= beta(k) * along * V(i, k);
    }
  }
  return Z;
}

}  // namespace fpbm
