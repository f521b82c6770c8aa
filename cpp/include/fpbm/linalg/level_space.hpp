#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "fpbm/core/types.hpp"
#include "fpbm/linalg/diagonal_level.hpp"
#include "fpbm/linalg/paired.hpp"
#include "fpbm/linalg/product.hpp"
#include "fpbm/linalg/solve_trapezoidal.hpp"

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
  explicit LevelSpace(Eigen::Index n) noexcept {
    V_.resize(n, n);
    for (Eigen::Index i = 0; i < V_.size(); ++i) V_.coeffRef(i) = Scalar(0);
    beta_.resize(n);
  }

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
                      solve_trapezoidal(T, first, count, result);
                    });
  }

  /// Adds the level A. With A Z = L Qᵀ, L lower triangular (trapezoidal if rows are dependent) and QᵀQ = I, calls
  /// solver(L, r, rank of A Z). If the solver replaces r by some w and returns true, returns y = Z Q w; otherwise the y
  /// of add(A, r). The solver gets the rows of L and r in the order of their pivots. Columns of L beyond the rank of A
  /// Z are zero. If A is diagonal, solver.loses(σ) returns whether the solver damps a singular value σ [unit of A].
  template <int M, typename Solver>
  [[nodiscard]] Column add(const Matrix<M, N, Scalar>& A, const Vector<M, Scalar>& r, Solver& solver) noexcept {
    if constexpr (M == N || M == Eigen::Dynamic) {
      if (is_diagonal(A)) {
        Scalar least = std::abs(A.coeff(0, 0));
        for (Eigen::Index i = 1; i < A.rows(); ++i) least = std::min(least, std::abs(A.coeff(i, i)));
        if (!solver.loses(least)) return add_diagonal(A, r);
      }
    }
    return add_with(A, r,
                    [&](const auto& T, Eigen::Index first, Eigen::Index count, Vector<M, Scalar>& result) noexcept {
                      const Eigen::Index m = T.cols();
                      auto L = filled<Matrix<M, M, Scalar>>(m);
                      for (Eigen::Index i = 0; i < count; ++i) {
                        for (Eigen::Index j = i; j < m; ++j) L(j, i) = T(first + i, j);
                      }
                      if (!solver(L, result, count)) solve_trapezoidal(T, first, count, result);
                    });
  }

  /// Adds the level A, without a solution.
  template <int M>
  void add(const Matrix<M, N, Scalar>& A) noexcept {
    if constexpr (M == N || M == Eigen::Dynamic) {
      if (is_diagonal(A)) return set_full();
    }
    auto r = filled<Vector<M, Scalar>>(A.rows());
    (void)triangular(A, r);
  }

  /// Z Zᵀ v, the part of v in the null space.
  [[nodiscard]] Column project(const Column& v) const noexcept {
    Column x = v;
    for (Eigen::Index k = 0; k < rank_; ++k) reflect(k, x.data());
    for (Eigen::Index i = 0; i < rank_; ++i) x.coeffRef(i) = Scalar(0);
    for (Eigen::Index k = rank_; k-- > 0;) reflect(k, x.data());
    return x;
  }

  /// Z, n × (n − rank).
  [[nodiscard]] Basis basis() const noexcept {
    Basis Z;
    Z.resize(size(), size() - rank_);
    for (Eigen::Index j = 0; j < Z.cols(); ++j) {
      Scalar* const z = Z.data() + j * size();
      for (Eigen::Index i = 0; i < size(); ++i) z[i] = Scalar(i == rank_ + j ? 1 : 0);
      for (Eigen::Index k = rank_; k-- > 0;) reflect(k, z);
    }
    return Z;
  }

 private:
  /// A = D, of which no direction is lost: the singular values of D Z are at least the least entry of D.
  ///
  ///   y = Z (ZᵀD²Z)⁻¹ ZᵀD r,   and Z Zᵀ r/c where D = c I.
  template <int M>
  [[nodiscard]] Column add_diagonal(const Matrix<M, N, Scalar>& A, const Vector<M, Scalar>& r) noexcept {
    const Eigen::Index n = size();
    const auto entry = [&](Eigen::Index i) -> const Scalar& { return A.coeffRef(i, i); };
    Column y = filled<Column>(n);
    bool uniform = true;
    for (Eigen::Index i = 0; i < n; ++i) {
      uniform = uniform && entry(i) == entry(0);
      y.coeffRef(i) = r.coeff(i) / entry(i);
    }
    if (uniform) {
      y = project(y);
    } else {
      y = solve_diagonal<N, Scalar>(basis(), A, r);
    }
    set_full();
    return y;
  }
  void set_full() noexcept {
    for (; rank_ < size(); ++rank_) beta_.coeffRef(rank_) = Scalar(0);  // No reflection.
  }

  /// Adds the level A and returns y = Q w, where solved(T, first, count, r) replaces the first entries of r by w.
  template <int M, typename Solved>
  [[nodiscard]] Column add_with(const Matrix<M, N, Scalar>& A, Vector<M, Scalar> r, const Solved& solved) noexcept {
    const Eigen::Index first = rank_;
    const Matrix<N, M, Scalar> T = triangular(A, r);
    const Eigen::Index count = rank_ - first;
    solved(T, first, count, r);
    Column y = filled<Column>(size());
    for (Eigen::Index i = 0; i < count; ++i) y.coeffRef(first + i) = r.coeff(i);
    for (Eigen::Index k = rank_; k-- > 0;) reflect(k, y.data());
    return y;
  }

  /// Adds the level A and returns QᵀAᵀ: one column for each row of A, in the order of the pivots, as r afterwards.
  template <int M>
  [[nodiscard]] Matrix<N, M, Scalar> triangular(const Matrix<M, N, Scalar>& A, Vector<M, Scalar>& r) noexcept {
    using std::swap;
    const Eigen::Index n = size();
    const Eigen::Index m = A.rows();
    const Eigen::Index first = rank_;
    Matrix<N, M, Scalar> T = transpose_of(A);
    const auto row = [&](Eigen::Index j) noexcept { return T.data() + j * n; };
    Vector<M, Scalar> least;
    least.resize(m);
    for (Eigen::Index j = 0; j < m; ++j) {
      least.coeffRef(j) = kDependent * length_of(row(j), n);
      for (Eigen::Index k = 0; k < first; ++k) reflect(k, row(j));
    }
    while (rank_ < n && rank_ - first < m) {
      const Eigen::Index k = rank_ - first;
      Eigen::Index next = -1;
      Scalar most(1);  // Largest length of a row's remainder, in units of the least that counts.
      for (Eigen::Index j = k; j < m; ++j) {
        const Scalar part = length_of(row(j) + rank_, n - rank_);
        if (part > most * least.coeff(j)) {
          most = part / least.coeff(j);
          next = j;
        }
      }
      if (next < 0) break;
      for (Eigen::Index i = 0; next != k && i < n; ++i) swap(row(k)[i], row(next)[i]);
      swap(least.coeffRef(k), least.coeffRef(next));
      swap(r.coeffRef(k), r.coeffRef(next));
      add_reflection(row(k) + rank_);
      for (Eigen::Index j = k; j < m; ++j) reflect(rank_, row(j));
      ++rank_;
    }
    return T;
  }

  /// Adds the reflection that makes all but the first of some entries zero: those of a column from row rank() on.
  void add_reflection(const Scalar* entries) noexcept {
    const Eigen::Index remaining = size() - rank_;
    Scalar* const v = V_.data() + rank_ * size() + rank_;
    const Scalar length = length_of(entries, remaining);
    for (Eigen::Index i = 0; i < remaining; ++i) v[i] = entries[i] / length;
    beta_.coeffRef(rank_) = Scalar(1) / (Scalar(1) + std::abs(v[0]));
    v[0] += v[0] < Scalar(0) ? Scalar(-1) : Scalar(1);
  }

  /// Applies reflection k to n entries.
  void reflect(Eigen::Index k, Scalar* x) const noexcept {
    const Scalar* const v = V_.data() + k * size();
    // Of a fixed size, all entries: the zeros above row k cost less than a loop of run-time length.
    const Eigen::Index begin = N == Eigen::Dynamic ? k : 0;
    const Eigen::Index end = N == Eigen::Dynamic ? size() : N;
    const Scalar along = beta_.coeff(k) * paired_dot(v + begin, x + begin, end - begin);
    subtract_multiple(x + begin, along, v + begin, end - begin);
  }

  /// Threshold of dependence. The remainder of a dependent row is round-off error, 1e-16 times the condition number of
  /// the higher levels; a motion along a remainder of 1e-9 already amplifies that error to 1e-7.
  static constexpr Scalar kDependent = std::numeric_limits<Scalar>::digits > 24 ? Scalar(1e-9) : Scalar(1e-4);

  Matrix<N, N, Scalar> V_;  ///< Column k is the vector of reflection k, below row k − 1.
  Column beta_;
  Eigen::Index rank_ = 0;
};

}  // namespace fpbm
