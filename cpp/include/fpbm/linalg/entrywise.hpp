#pragma once

#include "fpbm/core/types.hpp"

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

}  // namespace fpbm
