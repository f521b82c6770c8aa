#pragma once

#include <cmath>
#include <limits>
#include <utility>

#include "fpbm/core/detail/unrolled.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/linalg/detail/column_sums.hpp"

namespace fpbm {

/// Number of columns of a null-space basis at full rank: N − M.
template <int M, int N>
inline constexpr int kNullity = N == Eigen::Dynamic ? Eigen::Dynamic : N - M;

/// Aᵀ = QR of a task Jacobian A (M × N, N ≥ M), by Householder reflections with row pivoting: each step eliminates the
/// row of A with the largest remainder. The columns of Q from rank() on are an orthonormal basis of the null space of
/// A, up to round-off.
///
/// The remainder of a row is the row minus its projection on the rows that are already eliminated. A row whose
/// remainder is round-off error does not count for the rank. Eigen's HouseholderQR, which does not determine the rank,
/// takes 1.4 to 3.3 times as long (3 × 7 and 2 × 4). With LevelSpace instead, remainders below 1e-9 count as zero
/// (Remainders), and `make count` prints 7,808 instead of 7,633 instructions for loop/panda/position/limited.
template <int M, int N, typename Scalar>
class RowSpace {
 public:
  explicit RowSpace(const Matrix<M, N, Scalar>& A) noexcept : V_(A.cols(), A.rows()), beta_(A.rows()) {
    const auto n = extent<kN>(V_.rows());
    const auto m = extent<kM>(V_.cols());
    // V_ = Aᵀ, entry by entry: if the whole matrix is assigned, g++ warns that V_ is used before it is initialised.
    each(Constant<0>{}, m,
         [&](auto j) { each(Constant<0>{}, n, [&](Eigen::Index i) { V_.coeffRef(i, j) = A.coeff(j, i); }); });
    // Squared length up to which a remainder counts as zero.
    Scalar round_off = kLeast;
    each(Constant<0>{}, m, [&](auto k) {
      // Step k: the row with the largest remainder, in entries k to n − 1, becomes row k of the factorisation.
      using std::sqrt;
      if (rank_ != k) return;
      Eigen::Index largest = k;
      Scalar square = Scalar(0);
      each(k, m, [&](auto j) {
        Scalar left = Scalar(0);
        each(k, n, [&](Eigen::Index i) { left += V_.coeff(i, j) * V_.coeff(i, j); });
        if (!(left > square)) return;
        square = left;
        largest = j;
      });
      if (!(square > round_off)) return;
      if (k == 0 && square * kRoundOff > round_off) round_off = square * kRoundOff;
      if (largest != k) {
        for (Eigen::Index i = 0; i < V_.rows(); ++i) std::swap(V_.coeffRef(i, k), V_.coeffRef(i, largest));
      }
      const Scalar head = V_.coeff(k, k);
      V_.coeffRef(k, k) += head < Scalar(0) ? -sqrt(square) : sqrt(square);
      beta_.coeffRef(k) = Scalar(1) / (square + sqrt(square) * (head < Scalar(0) ? -head : head));
      each(next(k), m, [&](auto j) { reflect(k, V_.data() + j * n); });
      rank_ = k + 1;
    });
  }

  [[nodiscard]] Eigen::Index rank() const noexcept { return rank_; }

  /// Sets the entries from `out` on to column j of Q.
  void column(Eigen::Index j, Scalar* out) const noexcept {
    for (Eigen::Index i = 0; i < V_.rows(); ++i) out[i] = Scalar(i == j ? 1 : 0);
    Eigen::Index count = rank_;  // The last reflections do not change e_j if entry j of their v is zero.
    while (count > 0 && V_.coeff(j, count - 1) == Scalar(0)) --count;
    const auto m = extent<kM>(V_.cols());
    each(Constant<0>{}, m, [&](auto from_last) {
      const Eigen::Index k = m - 1 - from_last;
      if (k < count) reflect(k, out);
    });
  }

 private:
  // Unrolled for up to three rows of seven entries. Six rows would be unrolled into about two hundred loops.
  static constexpr bool kUnrolls = M * N <= 21;
  static constexpr int kM = kUnrolls ? M : Eigen::Dynamic;
  static constexpr int kN = kUnrolls ? N : Eigen::Dynamic;

  // Remainders with a smaller square count as zero, since the square may underflow and have no finite inverse.
  static constexpr Scalar kLeast = std::numeric_limits<Scalar>::min() / std::numeric_limits<Scalar>::epsilon();
  /// Squared length of a remainder that counts as round-off error, if the longest row has the length 1. Remainders of
  /// dependent rows of 32 random entries have lengths of up to 8 ε. With 64 ε instead of 32 ε, small rows are ignored,
  /// and the residual exceeds the bound of 45 ε of NullBasisOf.is_orthonormal_while_a_row_fades.
  static constexpr Scalar kRoundOff =
      Scalar(1024) * std::numeric_limits<Scalar>::epsilon() * std::numeric_limits<Scalar>::epsilon();

  /// x becomes H_k x, where H_k = I − β_k v vᵀ is the k-th reflection.
  template <typename Index>
  void reflect(Index k, Scalar* x) const noexcept {
    const auto n = extent<kN>(V_.rows());
    if constexpr (kUnrolls) {
      Scalar along = Scalar(0);
      each(k, n, [&](Eigen::Index i) { along += V_.coeff(i, k) * x[i]; });
      along *= beta_.coeff(k);
      each(k, n, [&](Eigen::Index i) { x[i] -= along * V_.coeff(i, k); });
    } else {
      const Scalar* const v = V_.data() + k * n + k;
      const Scalar along = beta_.coeff(k) * column_dot<Scalar>(v, x + k, n - k);
      subtract_multiple<Scalar>(x + k, along, v, n - k);
    }
  }

  Matrix<N, M, Scalar> V_;  ///< Column k becomes the vector v of the k-th reflection, from row k on.
  Vector<M, Scalar> beta_;
  Eigen::Index rank_ = 0;
};

/// Orthonormal basis Z of the null space of A (M × N, N ≥ M): AZ = 0 and ZᵀZ = I, up to round-off, for any rank of A.
/// If A is rank-deficient, its null space has more than N − M dimensions, and the N − M columns of Z span a part of the
/// null space.
template <int M, int N, typename Scalar>
[[nodiscard]] Matrix<N, kNullity<M, N>, Scalar> null_basis(const Matrix<M, N, Scalar>& A) noexcept {
  const RowSpace<M, N, Scalar> rows(A);
  Matrix<N, kNullity<M, N>, Scalar> Z(A.cols(), A.cols() - A.rows());
  for (Eigen::Index j = 0; j < Z.cols(); ++j) rows.column(A.rows() + j, Z.data() + j * Z.rows());
  return Z;
}

/// Z Zᵀ v, the projection of v on the null space of J, where Z = null_basis(J).
template <int M, int N, typename Scalar>
[[nodiscard]] Vector<N, Scalar> null_space_motion(const Matrix<M, N, Scalar>& J, const Vector<N, Scalar>& v) noexcept {
  const auto Z = null_basis<M, N, Scalar>(J);
  return Z.lazyProduct(Z.transpose().lazyProduct(v).eval());
}

}  // namespace fpbm
