#pragma once

#include <cmath>
#include <limits>
#include <utility>

#include "fpbm/core/types.hpp"

namespace fpbm {

/// Columns of the basis of a null space at full rank: N − M.
template <int M, int N>
inline constexpr int kNullity = N == Eigen::Dynamic ? Eigen::Dynamic : N - M;

/// Aᵀ = QR of a task Jacobian A (M × N, N ≥ M), by Householder reflections, the largest remaining row of A first. The
/// columns of Q from rank() on are an orthonormal basis of the null space of A, to round-off.
///
/// A row that is round-off once those before it are taken off does not count for the rank. Eigen's HouseholderQR, which
/// does not find the rank, takes 1.4 to 3.3 times as long (3 × 7 and 2 × 4).
template <int M, int N, typename Scalar>
class RowSpace {
 public:
  explicit RowSpace(const Matrix<M, N, Scalar>& A) noexcept : V_(A.transpose()), beta_(A.rows()) {
    using std::sqrt;
    const Eigen::Index n = V_.rows();
    const Eigen::Index m = V_.cols();
    Scalar round_off = kLeast;
    for (Eigen::Index k = 0; k < m; ++k) {
      Eigen::Index largest = k;
      Scalar square = Scalar(0);
      for (Eigen::Index j = k; j < m; ++j) {
        Scalar left = Scalar(0);
        for (Eigen::Index i = k; i < n; ++i) left += V_(i, j) * V_(i, j);
        if (!(left > square)) continue;
        square = left;
        largest = j;
      }
      if (!(square > round_off)) return;
      if (k == 0 && square * kRoundOff > round_off) round_off = square * kRoundOff;
      if (largest != k) {
        for (Eigen::Index i = k; i < n; ++i) std::swap(V_(i, k), V_(i, largest));
      }
      const Scalar head = V_(k, k);
      V_(k, k) += head < Scalar(0) ? -sqrt(square) : sqrt(square);
      beta_(k) = Scalar(1) / (square + sqrt(square) * (head < Scalar(0) ? -head : head));
      for (Eigen::Index j = k + 1; j < m; ++j) reflect(k, V_.col(j));
      rank_ = k + 1;
    }
  }

  [[nodiscard]] Eigen::Index rank() const noexcept { return rank_; }

  /// Column j of Q.
  template <typename Column>
  void column(Eigen::Index j, Column&& out) const noexcept {
    out.setZero();
    out(j) = Scalar(1);
    for (Eigen::Index k = rank_ - 1; k >= 0; --k) reflect(k, out);
  }

 private:
  // A smaller square underflows and has no finite inverse.
  static constexpr Scalar kLeast = std::numeric_limits<Scalar>::min() / std::numeric_limits<Scalar>::epsilon();
  /// Square of a row that counts as round-off, for a largest row of 1.
  static constexpr Scalar kRoundOff =
      Scalar(1024) * std::numeric_limits<Scalar>::epsilon() * std::numeric_limits<Scalar>::epsilon();

  /// Applies the k-th reflection.
  template <typename Column>
  void reflect(Eigen::Index k, Column&& x) const noexcept {
    const Eigen::Index n = V_.rows();
    Scalar along = Scalar(0);
    for (Eigen::Index i = k; i < n; ++i) along += V_(i, k) * x(i);
    along *= beta_(k);
    for (Eigen::Index i = k; i < n; ++i) x(i) -= along * V_(i, k);
  }

  Matrix<N, M, Scalar> V_;  ///< Column k becomes the k-th reflection's vector, below row k − 1.
  Vector<M, Scalar> beta_;
  Eigen::Index rank_ = 0;
};

/// Orthonormal basis Z of the null space of A (M × N, N ≥ M): AZ = 0, ZᵀZ = I, to round-off at every rank. Where A has
/// lost rank its N − M columns span a part of the null space, which is larger then.
template <int M, int N, typename Scalar>
[[nodiscard]] Matrix<N, kNullity<M, N>, Scalar> null_basis(const Matrix<M, N, Scalar>& A) noexcept {
  const RowSpace<M, N, Scalar> rows(A);
  Matrix<N, kNullity<M, N>, Scalar> Z(A.cols(), A.cols() - A.rows());
  for (Eigen::Index j = 0; j < Z.cols(); ++j) rows.column(A.rows() + j, Z.col(j));
  return Z;
}

}  // namespace fpbm
