#pragma once

#include <type_traits>

#include "fpbm/core/detail/unrolled.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/linalg/detail/entrywise.hpp"
#include "fpbm/linalg/detail/pair.hpp"
#include "fpbm/linalg/detail/total.hpp"

/// Products of small matrices, by loops. A loop compiles faster than an Eigen product, which instantiates about thirty
/// classes and functions for each pair of types.
namespace fpbm {

/// Whether rows are computed in pairs: two doubles fill a SIMD register. A Cortex-M has no SIMD registers for floats,
/// and needs 1.7 times the instructions with pairs of floats (make firmware, ticks with active limits).
template <typename Scalar>
inline constexpr bool kRowsInPairs = std::is_same_v<Scalar, double>;

/// Vector with the rows that f returns. f is called for one row, or for a pair of rows (kRowsInPairs). The argument of
/// f is a function rows(column), which reads the row, or the pair of rows, of a column in memory.
template <int M, typename Scalar, typename F>
[[nodiscard, gnu::always_inline]] inline Vector<M, Scalar> by_rows(const F& f) noexcept {
  Vector<M, Scalar> result;
  constexpr int kPaired = kRowsInPairs<Scalar> ? M - M % 2 : 0;
  // All pairs are computed before the first store: the compiler must assume that f reads the memory of the result.
  Pair<Scalar> pairs[kPaired / 2 + 1];
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC unroll 8
#endif
  for (int i = 0; i < kPaired; i += 2) {
    pairs[i / 2] = f([i](const Scalar* column) { return Pair<Scalar>::load(column + i); });
  }
  for (int i = kPaired; i < M; ++i) result.coeffRef(i) = f([i](const Scalar* column) { return column[i]; });
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC unroll 8
#endif
  for (int i = 0; i < kPaired; i += 2) pairs[i / 2].store(result.data() + i);
  return result;
}

/// Rows of A b, for by_rows(): `rows` selects the rows.
template <int M, int N, typename Scalar, typename Rows>
[[nodiscard, gnu::always_inline]] inline auto rows_of_product(const Rows& rows, const Matrix<M, N, Scalar>& A,
                                                              const Vector<N, Scalar>& b) noexcept {
  using Value = decltype(rows(A.data()));
  Value sum = rows(A.data()) * Value(b.coeff(0));
  if constexpr (N != Eigen::Dynamic && N <= kUnrolled) {
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC unroll 8
#endif
    for (int j = 1; j < N; ++j) sum += rows(A.data() + j * M) * Value(b.coeff(j));
  } else {
    for (Eigen::Index j = 1; j < b.size(); ++j) sum += rows(A.data() + j * M) * Value(b.coeff(j));
  }
  return sum;
}

/// A b.
template <int Rows, int Cols, typename Scalar>
[[nodiscard]] Vector<Rows, Scalar> product(const Matrix<Rows, Cols, Scalar>& A,
                                           const Vector<Cols, Scalar>& b) noexcept {
  if constexpr (Rows != Eigen::Dynamic) {
    return by_rows<Rows, Scalar>([&](const auto& rows) { return rows_of_product(rows, A, b); });
  } else {
    Vector<Rows, Scalar> result;
    result.resize(A.rows());
    for (Eigen::Index i = 0; i < A.rows(); ++i) result.coeffRef(i) = A.coeff(i, 0) * b.coeff(0);
    for (Eigen::Index j = 1; j < A.cols(); ++j) {
      for (Eigen::Index i = 0; i < A.rows(); ++i) result.coeffRef(i) += A.coeff(i, j) * b.coeff(j);
    }
    return result;
  }
}

/// Aᵀb.
template <int Rows, int Cols, typename Scalar>
[[nodiscard]] Vector<Cols, Scalar> transpose_times(const Matrix<Rows, Cols, Scalar>& A,
                                                   const Vector<Rows, Scalar>& b) noexcept {
  Vector<Cols, Scalar> result;
  result.resize(A.cols());
  for (Eigen::Index j = 0; j < A.cols(); ++j) {
    const auto term = [&](Eigen::Index i) { return A.coeff(i, j) * b.coeff(i); };
    if constexpr (Rows != Eigen::Dynamic) {
      result.coeffRef(j) = total<0, Rows>(term);
    } else {
      Scalar sum = term(0);
      for (Eigen::Index i = 1; i < A.rows(); ++i) sum += term(i);
      result.coeffRef(j) = sum;
    }
  }
  return result;
}

/// A Aᵀ.
template <int Rows, int Cols, typename Scalar>
[[nodiscard]] Matrix<Rows, Rows, Scalar> gram_of(const Matrix<Rows, Cols, Scalar>& A) noexcept {
  Matrix<Rows, Rows, Scalar> result;
  result.resize(A.rows(), A.rows());
  for (Eigen::Index i = 0; i < A.rows(); ++i) {
    for (Eigen::Index j = 0; j < A.rows(); ++j) {
      Scalar sum = A.coeff(i, 0) * A.coeff(j, 0);
      for (Eigen::Index k = 1; k < A.cols(); ++k) sum += A.coeff(i, k) * A.coeff(j, k);
      result.coeffRef(i, j) = sum;
    }
  }
  return result;
}

/// Aᵀ.
template <int Rows, int Cols, typename Scalar>
[[nodiscard]] Matrix<Cols, Rows, Scalar> transpose_of(const Matrix<Rows, Cols, Scalar>& A) noexcept {
  Matrix<Cols, Rows, Scalar> result;
  result.resize(A.cols(), A.rows());
  for (Eigen::Index i = 0; i < A.rows(); ++i) {
    for (Eigen::Index j = 0; j < A.cols(); ++j) result.coeffRef(j, i) = A.coeff(i, j);
  }
  return result;
}

/// diag(d) A.
template <int Rows, int Cols, typename Scalar>
[[nodiscard]] Matrix<Rows, Cols, Scalar> diagonal_times(const Vector<Rows, Scalar>& d,
                                                        const Matrix<Rows, Cols, Scalar>& A) noexcept {
  if constexpr (Cols == 1 && Rows != Eigen::Dynamic) {
    return by_rows<Rows, Scalar>([&](const auto& rows) { return rows(d.data()) * rows(A.data()); });
  } else if constexpr (Cols == 1) {
    return entrywise(A, [&](Eigen::Index i) { return d.coeff(i) * A.coeff(i); });
  } else {
    Matrix<Rows, Cols, Scalar> result;
    result.resize(A.rows(), A.cols());
    for (Eigen::Index j = 0; j < A.cols(); ++j) {
      for (Eigen::Index i = 0; i < A.rows(); ++i) result.coeffRef(i, j) = d.coeff(i) * A.coeff(i, j);
    }
    return result;
  }
}

/// a + b.
template <int Rows, int Cols, typename Scalar>
[[nodiscard]] Matrix<Rows, Cols, Scalar> sum_of(const Matrix<Rows, Cols, Scalar>& a,
                                                const Matrix<Rows, Cols, Scalar>& b) noexcept {
  return entrywise(a, [&](Eigen::Index i) { return a.coeff(i) + b.coeff(i); });
}

}  // namespace fpbm
