#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "fpbm/core/types.hpp"

namespace fpbm {

/// The null space of levels of rows, taken one level after another.
///
/// Keeps Aᵀ = QR of the rows of all levels so far, by Householder reflections, one block of reflections for each level.
/// The columns of Q from rank() on are an orthonormal basis Z of the null space of all of them.
template <int N, typename Scalar = double>
class LevelSpace {
 public:
  using Column = Vector<N, Scalar>;
  using Basis =
      Eigen::Matrix<Scalar, N, Eigen::Dynamic, Eigen::ColMajor | Eigen::DontAlign, kCapacity<N>, kCapacity<N>>;

  /// Of vectors of n entries, without rows.
  explicit LevelSpace(Eigen::Index n) noexcept : V_(n, n), beta_(n) {}

  [[nodiscard]] Eigen::Index size() const noexcept { return V_.rows(); }
  [[nodiscard]] Eigen::Index rank() const noexcept { return rank_; }

  /// Takes the rows of a level A and returns the least y in the null space of the levels before with A y = r, or with
  /// the least |A y − r| where there is none.
  ///
  /// A row counts as far as it lies in that null space: one of which less than kDependent is left does not count.
  template <int M>
  [[nodiscard]] Column take(const Matrix<M, N, Scalar>& A, const Vector<M, Scalar>& r) noexcept {
    const Eigen::Index n = size();
    const Eigen::Index m = A.rows();
    const Eigen::Index first = rank_;
    using Rows = Eigen::Matrix<Scalar, N, M, Eigen::ColMajor | Eigen::DontAlign, kCapacity<N>, kCapacity<M>>;
    Rows T = A.transpose();  // Qᵀ Aᵀ: a column for each row of A.
    Vector<M, Scalar> least(m);
    for (Eigen::Index j = 0; j < m; ++j) {
      least(j) = kDependent * T.col(j).stableNorm();
      for (Eigen::Index k = 0; k < first; ++k) reflect(k, T.col(j));
    }
    Vector<M, Scalar> result = r;
    while (rank_ < n && rank_ - first < m) {
      const Eigen::Index k = rank_ - first;
      const Eigen::Index left = n - rank_;
      Eigen::Index next = -1;
      Scalar most(1);  // Of the share of a row that is left, over the least that counts.
      for (Eigen::Index j = k; j < m; ++j) {
        const Scalar part = T.col(j).tail(left).stableNorm();
        if (part > most * least(j)) {
          most = part / least(j);
          next = j;
        }
      }
      if (next < 0) break;
      T.col(k).swap(T.col(next));
      std::swap(least(k), least(next));
      std::swap(result(k), result(next));
      add_reflection(T.col(k));
      for (Eigen::Index j = k; j < m; ++j) reflect(rank_, T.col(j));
      ++rank_;
    }
    const Eigen::Index count = rank_ - first;
    Column y = Column::Zero(n);
    solve(T, first, count, result);
    y.segment(first, count) = result.head(count);
    for (Eigen::Index k = rank_; k-- > 0;) reflect(k, y);
    return y;
  }

  /// Z, n × (n − rank).
  [[nodiscard]] Basis basis() const noexcept {
    Basis Z = Basis::Zero(size(), size() - rank_);
    for (Eigen::Index j = 0; j < Z.cols(); ++j) {
      Z(rank_ + j, j) = Scalar(1);
      for (Eigen::Index k = rank_; k-- > 0;) reflect(k, Z.col(j));
    }
    return Z;
  }

 private:
  /// The reflection that leaves of a column only its entry rank(), below those before it.
  template <typename Entries>
  void add_reflection(const Entries& column) noexcept {
    const Eigen::Index left = size() - rank_;
    auto v = V_.col(rank_).tail(left);
    const Scalar length = column.tail(left).stableNorm();
    v = column.tail(left) / length;
    const Scalar head = v(0);
    v(0) += head < Scalar(0) ? Scalar(-1) : Scalar(1);
    beta_(rank_) = Scalar(1) / (Scalar(1) + std::abs(head));
  }

  /// Applies reflection k.
  template <typename Entries>
  void reflect(Eigen::Index k, Entries&& x) const noexcept {
    const Eigen::Index left = size() - k;
    const auto v = V_.col(k).tail(left);
    const Scalar along = beta_(k) * v.dot(x.tail(left));
    x.tail(left) -= along * v;
  }

  /// w in L w = r, in place of the first entries of r, by least squares where L has more rows than columns. Row j of L
  /// is in column j of T, from its entry `first` on: L is lower triangular down to the last of its columns.
  template <typename Rows, typename Values>
  static void solve(const Rows& T, Eigen::Index first, Eigen::Index count, Values& r) noexcept {
    const Eigen::Index m = T.cols();
    if (m == count) {
      for (Eigen::Index i = 0; i < count; ++i) {
        for (Eigen::Index j = 0; j < i; ++j) r(i) -= T(first + j, i) * r(j);
        r(i) /= T(first + i, i);
      }
      return;
    }
    // L = Q₂ R₂ by Gram and Schmidt, each column twice, so that Q₂ is orthogonal; r is projected along the way.
    using Square =
        Eigen::Matrix<Scalar, Rows::ColsAtCompileTime, Rows::ColsAtCompileTime, Eigen::ColMajor | Eigen::DontAlign,
                      Rows::MaxColsAtCompileTime, Rows::MaxColsAtCompileTime>;
    Square Q(m, m);
    Square R = Square::Zero(m, m);
    Values w = Values::Zero(m);
    for (Eigen::Index k = 0; k < count; ++k) {
      auto q = Q.col(k);
      q = T.row(first + k).transpose();
      for (int round = 0; round < 2; ++round) {
        for (Eigen::Index i = 0; i < k; ++i) {
          const Scalar along = Q.col(i).dot(q);
          R(i, k) += along;
          q -= along * Q.col(i);
        }
      }
      R(k, k) = q.norm();
      q /= R(k, k);
      w(k) = q.dot(r);
      r -= w(k) * q;
    }
    for (Eigen::Index k = count; k-- > 0;) {
      for (Eigen::Index i = k + 1; i < count; ++i) w(k) -= R(k, i) * w(i);
      w(k) /= R(k, k);
    }
    r = w;
  }

  /// Share of a row that counts: what is left of a dependent row is round-off, 1e-16 times the condition of the levels
  /// before it, and motions along less than this share of it amplify that beyond any use.
  static constexpr Scalar kDependent = std::numeric_limits<Scalar>::digits > 24 ? Scalar(1e-9) : Scalar(1e-4);

  Matrix<N, N, Scalar> V_;  ///< Column k is the vector of reflection k, below row k − 1.
  Column beta_;
  Eigen::Index rank_ = 0;
};

}  // namespace fpbm
