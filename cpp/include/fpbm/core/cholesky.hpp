#pragma once

#include <limits>

#include "fpbm/core/status.hpp"
#include "fpbm/core/types.hpp"

namespace fpbm {

/// Square-root-free Cholesky factorisation A = L D Lᵀ of a small symmetric positive definite matrix.
///
/// Loops run over compile-time bounds where M is fixed, so that the compiler unrolls them; no square root and
/// M divisions in all.
template <int M, typename Scalar = double>
class Cholesky {
 public:
  /// Factorises A, of which only the lower triangle is read.
  /// Returns kSingular where a pivot is lost in round-off, that is, where A is singular or indefinite, and kNotFinite
  /// where A is not finite.
  [[nodiscard]] Status factor(const Matrix<M, M, Scalar>& A) noexcept {
    const Eigen::Index m = A.rows();
    const Scalar smallest = kPivotTolerance * A.diagonal().maxCoeff();
    L_ = A;
    reciprocal_.resize(m);
    for (Eigen::Index j = 0; j < m; ++j) {
      const Scalar pivot = L_(j, j);
      if (!(pivot > smallest)) return lost(A, j);
      reciprocal_(j) = Scalar(1) / pivot;
      for (Eigen::Index i = j + 1; i < m; ++i) {
        const Scalar l = L_(i, j) * reciprocal_(j);
        for (Eigen::Index k = j + 1; k <= i; ++k) L_(i, k) -= l * L_(k, j);
      }
      for (Eigen::Index i = j + 1; i < m; ++i) L_(i, j) *= reciprocal_(j);
    }
    return Status::kOk;
  }

  /// Row in which factor() lost its pivot, the leading rows before it being positive definite.
  [[nodiscard]] Eigen::Index lost_pivot() const noexcept { return lost_pivot_; }

  /// Solution x of A x = b.
  [[nodiscard]] Vector<M, Scalar> solve(const Vector<M, Scalar>& b) const noexcept {
    const Eigen::Index m = L_.rows();
    Vector<M, Scalar> x = b;
    for (Eigen::Index i = 1; i < m; ++i) {
      for (Eigen::Index j = 0; j < i; ++j) x(i) -= L_(i, j) * x(j);
    }
    for (Eigen::Index i = m - 1; i >= 0; --i) {
      x(i) *= reciprocal_(i);
      for (Eigen::Index j = i + 1; j < m; ++j) x(i) -= L_(j, i) * x(j);
    }
    return x;
  }

  /// Trace of A⁻¹. Its reciprocal is a lower bound on the least eigenvalue of A, and by M times at most too low.
  [[nodiscard]] Scalar inverse_trace() const noexcept {
    const Eigen::Index m = L_.rows();
    Matrix<M, M, Scalar> inverse = L_;  // Of L, below the diagonal.
    Scalar trace = Scalar(0);
    for (Eigen::Index i = 0; i < m; ++i) {
      Scalar row = Scalar(1);
      for (Eigen::Index j = 0; j < i; ++j) {
        Scalar entry = L_(i, j);
        for (Eigen::Index k = j + 1; k < i; ++k) entry += L_(i, k) * inverse(k, j);
        inverse(i, j) = -entry;
        row += entry * entry;
      }
      trace += row * reciprocal_(i);
    }
    return trace;
  }

 private:
  [[nodiscard]] Status lost(const Matrix<M, M, Scalar>& A, Eigen::Index pivot) noexcept {
    lost_pivot_ = pivot;
    return A.allFinite() ? Status::kSingular : Status::kNotFinite;
  }

  /// Least pivot, relative to the largest diagonal entry, that still carries a digit or two.
  static constexpr Scalar kPivotTolerance = Scalar(64) * std::numeric_limits<Scalar>::epsilon();

  Matrix<M, M, Scalar> L_;        ///< Unit lower triangle, below the diagonal.
  Vector<M, Scalar> reciprocal_;  ///< 1 / D.
  Eigen::Index lost_pivot_ = 0;
};

}  // namespace fpbm
