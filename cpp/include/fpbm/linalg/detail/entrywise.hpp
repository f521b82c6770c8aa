#pragma once

#include "fpbm/core/types.hpp"

namespace fpbm {

/// Matrix with the entries f(i), of the same size as `size`. i counts the entries along the columns.
///
/// For entrywise sums and products. For the type of an equal Eigen expression, a compiler would instantiate about
/// thirty classes and functions.
/// Result: type of an entry.
template <typename Result, int Rows, int Cols, typename Scalar, typename F>
[[nodiscard, gnu::always_inline]] inline Matrix<Rows, Cols, Result> entrywise_as(const Matrix<Rows, Cols, Scalar>& size,
                                                                                 const F& f) noexcept {
  Matrix<Rows, Cols, Result> result;
  // Largest unrolled size. 7 to 32 give the same time for a step of a position task of a Panda; with 4, the step takes
  // 23 % longer (g++ 12, -O2).
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

template <int Rows, int Cols, typename Scalar, typename F>
[[nodiscard]] Matrix<Rows, Cols, Scalar> entrywise(const Matrix<Rows, Cols, Scalar>& size, const F& f) noexcept {
  return entrywise_as<Scalar>(size, f);
}

/// Column j of a matrix.
template <int Rows, int Cols, typename Scalar>
[[nodiscard]] Vector<Rows, Scalar> column(const Matrix<Rows, Cols, Scalar>& A, Eigen::Index j) noexcept {
  Vector<Rows, Scalar> result;
  result.resize(A.rows());
  const Scalar* const from = A.data() + j * A.rows();
  for (Eigen::Index i = 0; i < A.rows(); ++i) result.coeffRef(i) = from[i];
  return result;
}
template <int Rows, int Cols, typename Scalar>
void set_column(Matrix<Rows, Cols, Scalar>& A, Eigen::Index j, const Vector<Rows, Scalar>& values) noexcept {
  Scalar* const to = A.data() + j * A.rows();
  for (Eigen::Index i = 0; i < A.rows(); ++i) to[i] = values.coeff(i);
}

}  // namespace fpbm
