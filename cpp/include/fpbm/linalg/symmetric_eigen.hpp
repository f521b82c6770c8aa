#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "fpbm/core/types.hpp"

namespace fpbm {

/// Eigenvalues and orthonormal eigenvectors (columns) of a small symmetric matrix: A = V diag(values) Vᵀ, unordered.
///
/// Cyclic Jacobi rotations: accurate to round-off in ‖A‖, quadratic at the end, at most kPasses passes over A.
/// Eigen's SelfAdjointEigenSolver takes 4.7 times as long for M = 2, as long for M = 3 and half as long for M = 6, but
/// some 5 s to compile for each M, and it is not bounded as tightly.
template <int M, typename Scalar = double>
struct SymmetricEigen {
  Vector<M, Scalar> values;
  Matrix<M, M, Scalar> vectors;

  /// A: both triangles are read. Where A is not finite, the values are not finite either.
  explicit SymmetricEigen(const Matrix<M, M, Scalar>& A) noexcept : vectors(identity<Matrix<M, M, Scalar>>()) {
    using std::abs;
    Matrix<M, M, Scalar> D = A;
    Scalar largest = abs(A(0));
    for (int i = 1; i < M * M; ++i) largest = std::max(largest, abs(A(i)));
    const Scalar negligible = std::numeric_limits<Scalar>::epsilon() * largest;
    for (int pass = 0; pass < kPasses; ++pass) {
      bool done = true;
      for (int p = 0; p < M; ++p) {
        for (int q = p + 1; q < M; ++q) {
          if (!(abs(D(p, q)) > negligible)) continue;
          rotate(D, p, q);
          done = false;
        }
      }
      if (done) break;
    }
    for (int i = 0; i < M; ++i) values(i) = D(i, i);
  }

 private:
  static constexpr int kPasses = 12;  // Six are usually enough.

  /// D ← RᵀDR and V ← VR with the rotation R that makes D(p, q) zero.
  void rotate(Matrix<M, M, Scalar>& D, int p, int q) noexcept {
    using std::abs;
    using std::sqrt;
    const Scalar theta = (D(q, q) - D(p, p)) / (Scalar(2) * D(p, q));
    const Scalar tangent =
        (theta < Scalar(0) ? Scalar(-1) : Scalar(1)) / (abs(theta) + sqrt(theta * theta + Scalar(1)));
    const Scalar c = Scalar(1) / sqrt(tangent * tangent + Scalar(1));
    const Scalar s = tangent * c;
    const auto rotate_pair = [c, s](Scalar& a, Scalar& b) noexcept {
      const Scalar old_a = a;
      a = c * old_a - s * b;
      b = s * old_a + c * b;
    };
    for (int i = 0; i < M; ++i) rotate_pair(D(i, p), D(i, q));
    for (int i = 0; i < M; ++i) rotate_pair(D(p, i), D(q, i));
    for (int i = 0; i < M; ++i) rotate_pair(vectors(i, p), vectors(i, q));
  }
};

}  // namespace fpbm
