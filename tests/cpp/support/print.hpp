#pragma once

#include <Eigen/Core>
#include <ostream>

/// Prints matrices of failing tests. The default of GoogleTest, as containers, takes seconds to compile for each type.
namespace Eigen {

template <typename Scalar, int Rows, int Cols, int Options, int MaxRows, int MaxCols>
void PrintTo(const Matrix<Scalar, Rows, Cols, Options, MaxRows, MaxCols>& matrix, std::ostream* out) {
  for (Index i = 0; i < matrix.rows(); ++i) {
    for (Index j = 0; j < matrix.cols(); ++j) *out << (j > 0 ? ", " : i > 0 ? "; " : "") << matrix(i, j);
  }
}

}  // namespace Eigen
