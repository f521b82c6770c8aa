#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "fpbm/core/types.hpp"

namespace fpbm {

/// Null space of task levels, each a matrix of rows, added in the order of their priority.
///
/// Stores Aᵀ = QR of the rows A of all levels so far as Householder reflections, one block for each level. The columns
/// of Q from rank() on are an orthonormal basis Z of the null space of A.
template <int N, typename Scalar = double>
class LevelSpace {
 public:
  using Column = Vector<N, Scalar>;
  using Basis =
      Eigen::Matrix<Scalar, N, Eigen::Dynamic, Eigen::ColMajor | Eigen::DontAlign, kCapacity<N>, kCapacity<N>>;

  /// No levels: the null space is ℝⁿ.
  explicit LevelSpace(Eigen::Index n) noexcept : V_(n, n), beta_(n) {}

  [[nodiscard]] Eigen::Index size() const noexcept { return V_.rows(); }
  [[nodiscard]] Eigen::Index rank() const noexcept { return rank_; }

  /// Adds the level A. Returns y = Z (A Z)⁺ r with the basis Z of the higher levels: the y of least norm that changes
  /// no higher level and minimises |A y − r|.
  ///
  /// A row whose projection on that null space is shorter than kDependent times the row counts as dependent.
  template <int M>
  [[nodiscard]] Column add(const Matrix<M, N, Scalar>& A, const Vector<M, Scalar>& r) noexcept {
    return add_with(A, r,
                    [](const auto& T, Eigen::Index first, Eigen::Index count, Vector<M, Scalar>& result) noexcept {
                      solve(T, first, count, result);
                    });
  }

  /// Adds the level A. With A Z = L Qᵀ, L lower triangular (trapezoidal if rows are dependent) and QᵀQ = I, calls
  /// solver(L, r). If the solver replaces r by some w and returns true, returns y = Z Q w; otherwise the y of add(A,
  /// r). The solver gets the rows of L and r in the order of their pivots. Columns of L beyond the rank of A Z are
  /// zero.
  template <int M, typename Solver>
  [[nodiscard]] Column add(const Matrix<M, N, Scalar>& A, const Vector<M, Scalar>& r, Solver& solver) noexcept {
    return add_with(A, r,
                    [&](const auto& T, Eigen::Index first, Eigen::Index count, Vector<M, Scalar>& result) noexcept {
                      auto L = filled<Matrix<M, M, Scalar>>(M);
                      for (Eigen::Index i = 0; i < count; ++i) {
                        for (Eigen::Index j = i; j < M; ++j) L(j, i) = T(first + i, j);
                      }
                      if (!solver(L, result)) solve(T, first, count, result);
                    });
  }

  /// Z Zᵀ v, the part of v in the null space.
  [[nodiscard]] Column project(const Column& v) const noexcept {
    Column x = v;
    for (Eigen::Index k = 0; k < rank_; ++k) reflect(k, x);
    x.head(rank_).setZero();
    for (Eigen::Index k = rank_; k-- > 0;) reflect(k, x);
    return x;
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
  /// Adds the level A and returns y = Q w, where solved(T, first, count, r) replaces the first entries of r by w.
  template <int M, typename Solved>
  [[nodiscard]] Column add_with(const Matrix<M, N, Scalar>& A, const Vector<M, Scalar>& r,
                                const Solved& solved) noexcept {
    const Eigen::Index n = size();
    const Eigen::Index m = A.rows();
    const Eigen::Index first = rank_;
    using Rows = Eigen::Matrix<Scalar, N, M, Eigen::ColMajor | Eigen::DontAlign, kCapacity<N>, kCapacity<M>>;
    Rows T = A.transpose();  // Becomes QᵀAᵀ: one column for each row of A.
    Vector<M, Scalar> least(m);
    for (Eigen::Index j = 0; j < m; ++j) {
      least(j) = kDependent * T.col(j).norm();
      for (Eigen::Index k = 0; k < first; ++k) reflect(k, T.col(j));
    }
    Vector<M, Scalar> result = r;
    while (rank_ < n && rank_ - first < m) {
      const Eigen::Index k = rank_ - first;
      const Eigen::Index remaining = n - rank_;
      Eigen::Index next = -1;
      Scalar most(1);  // Largest length of a row's remainder, in units of the least that counts.
      for (Eigen::Index j = k; j < m; ++j) {
        const Scalar part = T.col(j).tail(remaining).norm();
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
    solved(T, first, count, result);
    y.segment(first, count) = result.head(count);
    for (Eigen::Index k = rank_; k-- > 0;) reflect(k, y);
    return y;
  }

  /// Adds the reflection that makes the entries of a column below rank() zero.
  template <typename Entries>
  void add_reflection(const Entries& column) noexcept {
    const Eigen::Index remaining = size() - rank_;
    auto v = V_.col(rank_).tail(remaining);
    const Scalar length = column.tail(remaining).norm();
    v = column.tail(remaining) / length;
    const Scalar head = v(0);
    v(0) += head < Scalar(0) ? Scalar(-1) : Scalar(1);
    beta_(rank_) = Scalar(1) / (Scalar(1) + std::abs(head));
  }

  /// Applies reflection k.
  template <typename Entries>
  void reflect(Eigen::Index k, Entries&& x) const noexcept {
    const Eigen::Index remaining = size() - k;
    const auto v = V_.col(k).tail(remaining);
    const Scalar along = beta_(k) * v.dot(x.tail(remaining));
    x.tail(remaining) -= along * v;
  }

  /// Solves L w = r, by least squares if L has more rows than columns; w replaces the first entries of r. Row j of L
  /// starts at entry `first` of column j of T. The upper square block of L is lower triangular.
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
    // L = Q₂ R₂ by the modified Gram-Schmidt method, with each column orthogonalised twice for round-off.
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

  /// Threshold of dependence. The remainder of a dependent row is round-off error, 1e-16 times the condition number of
  /// the higher levels; a motion along a remainder of 1e-9 already amplifies that error to 1e-7.
  static constexpr Scalar kDependent = std::numeric_limits<Scalar>::digits > 24 ? Scalar(1e-9) : Scalar(1e-4);

  Matrix<N, N, Scalar> V_;  ///< Column k is the vector of reflection k, below row k − 1.
  Column beta_;
  Eigen::Index rank_ = 0;
};

}  // namespace fpbm
