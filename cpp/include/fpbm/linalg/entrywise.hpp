#pragma once

#include <type_traits>

#include "fpbm/core/types.hpp"
#include "fpbm/linalg/total.hpp"

namespace fpbm {

/// The matrix, of the size of another one, whose entry i is f(i), counted along the columns.
///
/// For sums and products entry by entry. An expression of Eigen's has the same entries, but a type of its own, of which
/// a compiler makes some thirty classes and functions.
template <int Rows, int Cols, typename Scalar, typename F>
[[nodiscard]] Matrix<Rows, Cols, Scalar> entrywise(const Matrix<Rows, Cols, Scalar>& size, const F& f) noexcept {
  Matrix<Rows, Cols, Scalar> result;
  constexpr Eigen::Index kMost = 16;
  if constexpr (Rows != Eigen::Dynamic && Cols != Eigen::Dynamic && Eigen::Index{Rows} * Cols <= kMost) {
    constexpr Eigen::Index kSize = Eigen::Index{Rows} * Cols;
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC unroll 16
#endif
    for (Eigen::Index i = 0; i < kSize; ++i) result.coeffRef(i) = f(i);
  } else {
    result.resize(size.rows(), size.cols());
    const Eigen::Index n = size.size();
    for (Eigen::Index i = 0; i < n; ++i) result.coeffRef(i) = f(i);
  }
  return result;
}

/// Column j of a matrix.
template <int Rows, int Cols, typename Scalar>
[[nodiscard]] Vector<Rows, Scalar> column(const Matrix<Rows, Cols, Scalar>& A, Eigen::Index j) noexcept {
  Vector<Rows, Scalar> result;
  result.resize(A.rows());
  const Scalar* const from = A.data() + j * A.rows();
  return entrywise(result, [&](Eigen::Index i) { return from[i]; });
}
template <int Rows, int Cols, typename Scalar>
void set_column(Matrix<Rows, Cols, Scalar>& A, Eigen::Index j, const Vector<Rows, Scalar>& values) noexcept {
  Scalar* const to = A.data() + j * A.rows();
  for (Eigen::Index i = 0; i < A.rows(); ++i) to[i] = values.coeff(i);
}

/// Aᵀ.
template <int Rows, int Cols, typename Scalar>
[[nodiscard]] Matrix<Cols, Rows, Scalar> transpose_of(const Matrix<Rows, Cols, Scalar>& A) noexcept {
  if constexpr (Rows != Eigen::Dynamic && Cols != Eigen::Dynamic && Rows * Cols > 21) {
    Matrix<Cols, Rows, Scalar> result;
    for (Eigen::Index i = 0; i < Rows; ++i) {
      for (Eigen::Index j = 0; j < Cols; ++j) result.coeffRef(j, i) = A.coeff(i, j);
    }
    return result;
  } else {
    return A.transpose();
  }
}

/// A b, and A Aᵀ, with the round-off of Eigen's lazyProduct(), whose pairs of rows are summed from the first term on.
template <int Rows, int Cols, typename Scalar>
[[nodiscard]] Vector<Rows, Scalar> product(const Matrix<Rows, Cols, Scalar>& A,
                                           const Vector<Cols, Scalar>& b) noexcept {
  if constexpr (std::is_same_v<Scalar, double> && Rows == 7 && Cols == 6) {
    Vector<Rows, Scalar> result;
    for (Eigen::Index i = 0; i < Rows; ++i) {
      const auto term = [&](Eigen::Index j) { return A.coeff(i, j) * b.coeff(j); };
      Scalar sum = term(0);
      for (Eigen::Index j = 1; j < Cols; ++j) sum += term(j);
      result.coeffRef(i) = i + 1 < Rows ? sum : total<0, Cols>(term);
    }
    return result;
  } else {
    return A.lazyProduct(b);
  }
}
template <int Rows, int Cols, typename Scalar>
[[nodiscard]] Matrix<Rows, Rows, Scalar> gram_of(const Matrix<Rows, Cols, Scalar>& A) noexcept {
  if constexpr (std::is_same_v<Scalar, double> && Rows == 6 && Cols != Eigen::Dynamic) {
    Matrix<Rows, Rows, Scalar> result;
    for (Eigen::Index i = 0; i < Rows; ++i) {
      for (Eigen::Index j = 0; j < Rows; ++j) {
        Scalar sum = A.coeff(i, 0) * A.coeff(j, 0);
        for (Eigen::Index k = 1; k < Cols; ++k) sum += A.coeff(i, k) * A.coeff(j, k);
        result.coeffRef(i, j) = sum;
      }
    }
    return result;
  } else {
    return A.lazyProduct(A.transpose());
  }
}

/// Aᵀb.
template <int Rows, int Cols, typename Scalar>
[[nodiscard]] Vector<Cols, Scalar> transpose_times(const Matrix<Rows, Cols, Scalar>& A,
                                                   const Vector<Rows, Scalar>& b) noexcept {
  // Small ones by Eigen, which leaves no loop; larger ones by columns, of which a compiler makes fewer types.
  if constexpr (Rows != Eigen::Dynamic && Cols != Eigen::Dynamic && Rows * Cols <= 21) {
    return A.transpose().lazyProduct(b);
  }
  Vector<Cols, Scalar> result;
  result.resize(A.cols());
  for (Eigen::Index j = 0; j < A.cols(); ++j) {
    const Scalar* const from = A.data() + j * A.rows();
    result.coeffRef(j) = entrywise(b, [&](Eigen::Index i) { return from[i] * b.coeff(i); }).sum();
  }
  return result;
}

}  // namespace fpbm
