#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <utility>

#include "fpbm/core/types.hpp"
#include "fpbm/linalg/detail/column_sums.hpp"
#include "fpbm/linalg/detail/diagonal_level.hpp"
#include "fpbm/linalg/detail/entrywise.hpp"
#include "fpbm/linalg/detail/product.hpp"
#include "fpbm/linalg/detail/reflections.hpp"
#include "fpbm/linalg/detail/remainders.hpp"
#include "fpbm/linalg/detail/solve_trapezoidal.hpp"

namespace fpbm {

/// Null space of task levels. Each level is a matrix of rows. Levels are added in the order of their priority.
///
/// QR factorisation Aᵀ = QR of the rows A of all levels so far, where Q is a product of reflections, one block for each
/// level. The columns of Q from rank() on are an orthonormal basis Z of the null space of A.
template <int N, typename Scalar = double>
class LevelSpace {
 public:
  using Column = Vector<N, Scalar>;
  using Basis =
      Eigen::Matrix<Scalar, N, Eigen::Dynamic, Eigen::ColMajor | Eigen::DontAlign, kCapacity<N>, kCapacity<N>>;

  /// Starts without levels: the null space is ℝⁿ.
  explicit LevelSpace(Eigen::Index n) noexcept : Q_(n) {}

  [[nodiscard]] Eigen::Index size() const noexcept { return Q_.size(); }
  [[nodiscard]] Eigen::Index rank() const noexcept { return Q_.count(); }

  /// Adds the level A. Returns y = Z (A Z)⁺ r with the null-space basis Z of the higher levels. y minimises |A y − r|
  /// without a change of the higher levels, and has the least norm of all minimisers.
  ///
  /// A row counts as linearly dependent if its projection on this null space is nearly zero (Remainders).
  template <int M>
  [[nodiscard]] Column add(const Matrix<M, N, Scalar>& A, const Vector<M, Scalar>& r) noexcept {
    return add_with(A, r,
                    [](const auto& T, Eigen::Index first, Eigen::Index count, Vector<M, Scalar>& result) noexcept {
                      solve_trapezoidal(T, first, count, result);
                    });
  }

  /// Adds the level A. With A Z = L Qᵀ, where L is lower triangular (trapezoidal if rows are dependent) and QᵀQ = I,
  /// calls solver(L, r, rank of A Z). If the solver replaces r by w and returns true, the result is y = Z Q w.
  /// Otherwise, the result is the y of add(A, r). The rows of L and r are in the order of their pivots. Columns of L
  /// beyond the rank of A Z are zero. If A is diagonal, solver.loses(σ) returns whether the solver damps a singular
  /// value σ [unit of A].
  template <int M, typename Solver>
  [[nodiscard]] Column add(const Matrix<M, N, Scalar>& A, const Vector<M, Scalar>& r, Solver& solver) noexcept {
    if constexpr (M == N || M == Eigen::Dynamic) {
      if (is_diagonal(A)) {
        const DiagonalLevel<N, Scalar> diagonal{entrywise(r, [&](Eigen::Index i) { return A.coeff(i, i); })};
        if (!solver.loses(diagonal.least())) return add_diagonal(diagonal, r);
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

  template <typename Solver>
  [[nodiscard]] Column add(const DiagonalLevel<N, Scalar>& A, const Column& r, Solver& solver) noexcept {
    return solver.loses(A.least()) ? add(A.matrix(), r, solver) : add_diagonal(A, r);
  }

  /// Adds the level I. Returns y = Z Zᵀ r.
  [[nodiscard]] Column add_unit(const Column& r) noexcept {
    const Column y = project(r);
    Q_.fill();
    return y;
  }

  /// Adds the level A without computing a solution.
  template <int M>
  void add(const Matrix<M, N, Scalar>& A) noexcept {
    if constexpr (M == N || M == Eigen::Dynamic) {
      if (is_diagonal(A)) return Q_.fill();
    }
    auto r = filled<Vector<M, Scalar>>(A.rows());
    (void)triangular(A, r);
  }

  void add(const DiagonalLevel<N, Scalar>&) noexcept { Q_.fill(); }

  /// Z Zᵀ v, the part of v in the null space.
  [[nodiscard]] Column project(const Column& v) const noexcept {
    Column x = v;
    Q_.apply_transposed(x.data());
    for (Eigen::Index i = 0; i < rank(); ++i) x.coeffRef(i) = Scalar(0);
    Q_.apply(x.data());
    return x;
  }

  /// Z, n × (n − rank), computed once for each rank.
  [[nodiscard]] const Basis& basis() noexcept {
    if (Z_.rows() == size() && Z_.cols() == size() - rank()) return Z_;
    Z_.resize(size(), size() - rank());
    for (Eigen::Index j = 0; j < Z_.cols(); ++j) Q_.column(rank() + j, Z_.data() + j * size());
    return Z_;
  }

 private:
  /// Adds the level A = D. No direction of D is lost: the singular values of D Z are at least the smallest magnitude of
  /// an entry of D.
  ///
  ///   y = Z (ZᵀD²Z)⁻¹ ZᵀD r,   which is Z Zᵀ r/c if D = c I.
  [[nodiscard]] Column add_diagonal(const DiagonalLevel<N, Scalar>& A, const Column& r) noexcept {
    const Column& entries = A.entries;
    Column y = entrywise(r, [&](Eigen::Index i) { return r.coeff(i) / entries.coeff(i); });
    bool uniform = true;
    for (Eigen::Index i = 1; i < size(); ++i) uniform = uniform && entries.coeff(i) == entries.coeff(0);
    if (uniform) {
      y = project(y);
    } else {
      y = solve_diagonal<N, Scalar>(basis(), entries, r);
    }
    Q_.fill();
    return y;
  }
  /// Adds the level A and returns y = Q (0, w, 0), where solved(T, first, count, r) replaces the first `count` entries
  /// of r by w.
  template <int M, typename Solved>
  [[nodiscard]] Column add_with(const Matrix<M, N, Scalar>& A, Vector<M, Scalar> r, const Solved& solved) noexcept {
    const Eigen::Index first = rank();
    const Matrix<N, M, Scalar> T = triangular(A, r);
    const Eigen::Index count = rank() - first;
    solved(T, first, count, r);
    Column y = filled<Column>(size());
    for (Eigen::Index i = 0; i < count; ++i) y.coeffRef(first + i) = r.coeff(i);
    Q_.apply(y.data());
    return y;
  }

  /// Adds the level A and returns QᵀAᵀ: one column for each row of A, in the order of the pivots. Permutes r into the
  /// order of the pivots.
  template <int M>
  [[nodiscard]] Matrix<N, M, Scalar> triangular(const Matrix<M, N, Scalar>& A, Vector<M, Scalar>& r) noexcept {
    const Eigen::Index n = size();
    const Eigen::Index m = A.rows();
    const Eigen::Index first = rank();
    Matrix<N, M, Scalar> T = transpose_of(A);
    const auto row = [&](Eigen::Index j) noexcept { return T.data() + j * n; };
    const auto left = [&](Eigen::Index j) noexcept { return squared_length(row(j) + rank(), n - rank()); };
    Remainders<M, Scalar> remainders(m);
    for (Eigen::Index j = 0; j < m; ++j) {
      const Scalar whole = squared_length(row(j), n);
      Q_.apply_transposed(row(j));
      remainders.set(j, whole, first > 0 ? left(j) : whole);
    }
    for (Eigen::Index k = 0; k < m && rank() < n; ++k) {
      const Eigen::Index pivot = remainders.largest(k);
      if (pivot < 0) break;
      if (pivot != k) {
        for (Eigen::Index i = 0; i < n; ++i) std::swap(row(k)[i], row(pivot)[i]);
        std::swap(r.coeffRef(k), r.coeffRef(pivot));
        remainders.swap(k, pivot);
      }
      Q_.add(row(k));
      for (Eigen::Index j = k + 1; j < m; ++j) {
        Q_.reflect(first + k, row(j));
        remainders.remove(j, row(j)[first + k], [&] { return left(j); });
      }
    }
    return T;
  }

  Reflections<N, Scalar> Q_;
  Basis Z_;  ///< Set by basis().
};

}  // namespace fpbm
