#pragma once

#include <limits>

#include "fpbm/core/lanes.hpp"
#include "fpbm/core/status.hpp"
#include "fpbm/core/types.hpp"

namespace fpbm {

/// Square-root-free Cholesky factorisation A = L D Lᵀ of a small symmetric positive definite matrix.
///
/// Loops run over compile-time bounds where M is fixed, so that the compiler unrolls them; no square root and
/// M divisions in all. Value = Lanes<Scalar, K> factorises K matrices at once.
template <int M, typename Value = double>
class Cholesky {
 public:
  using Scalar = typename ScalarOf<Value>::type;

  /// Factorises A, of which only the lower triangle is read.
  /// Returns kSingular where a pivot is lost in round-off, that is, where A is singular or indefinite, and kNotFinite
  /// where A is not finite.
  [[nodiscard]] Status factor(const Matrix<M, M, Value>& A) noexcept {
    const Eigen::Index m = A.rows();
    L_.resize(m, m);
    reciprocal_.resize(m);
    Value largest = A(0, 0);
    for (Eigen::Index i = 0; i < m; ++i) {
      largest = larger(largest, A(i, i));
      for (Eigen::Index j = 0; j <= i; ++j) L_(i, j) = A(i, j);
    }
    const Value smallest = kPivotTolerance * largest;
    for (Eigen::Index j = 0; j < m; ++j) {
      const Value pivot = L_(j, j);
      if (!(pivot > smallest)) return lost(A, j);
      reciprocal_(j) = Scalar(1) / pivot;
      for (Eigen::Index i = j + 1; i < m; ++i) {
        const Value l = L_(i, j) * reciprocal_(j);
        for (Eigen::Index k = j + 1; k <= i; ++k) L_(i, k) -= l * L_(k, j);
      }
      for (Eigen::Index i = j + 1; i < m; ++i) L_(i, j) *= reciprocal_(j);
    }
    return Status::kOk;
  }

  /// Row in which factor() lost its pivot, the leading rows before it being positive definite.
  [[nodiscard]] Eigen::Index lost_pivot() const noexcept { return lost_pivot_; }

  /// Solution x of A x = b.
  [[nodiscard]] Vector<M, Value> solve(const Vector<M, Value>& b) const noexcept {
    const Eigen::Index m = L_.rows();
    Vector<M, Value> x = b;
    for (Eigen::Index i = 1; i < m; ++i) {
      for (Eigen::Index j = 0; j < i; ++j) x(i) -= L_(i, j) * x(j);
    }
    for (Eigen::Index i = m - 1; i >= 0; --i) {
      x(i) *= reciprocal_(i);
      for (Eigen::Index j = m - 1; j > i; --j) x(i) -= L_(j, i) * x(j);  // What is known last comes last.
    }
    return x;
  }

  /// Trace of A⁻¹. Its reciprocal is a lower bound on the least eigenvalue of A, and by M times at most too low.
  [[nodiscard]] Value inverse_trace() const noexcept {
    const Eigen::Index m = L_.rows();
    Matrix<M, M, Value> inverse;  // Of L, its sign changed, below the diagonal.
    inverse.resize(m, m);
    Value trace = reciprocal_(0);
    for (Eigen::Index i = 1; i < m; ++i) {
      Value row = reciprocal_(i);
      for (Eigen::Index j = 0; j < i; ++j) {
        Value entry = L_(i, j);
        for (Eigen::Index k = j + 1; k < i; ++k) entry -= L_(i, k) * inverse(k, j);
        inverse(i, j) = entry;
        row += entry * entry * reciprocal_(i);
      }
      trace += row;
    }
    return trace;
  }

 private:
  [[nodiscard]] Status lost(const Matrix<M, M, Value>& A, Eigen::Index pivot) noexcept {
    lost_pivot_ = pivot;
    for (Eigen::Index i = 0; i < A.rows(); ++i) {
      for (Eigen::Index j = 0; j <= i; ++j) {
        if (!is_finite(A(i, j))) return Status::kNotFinite;
      }
    }
    return Status::kSingular;
  }

  /// Least pivot, relative to the largest diagonal entry, that still carries a digit or two.
  static constexpr Scalar kPivotTolerance = Scalar(64) * std::numeric_limits<Scalar>::epsilon();

  Matrix<M, M, Value> L_;        ///< Unit lower triangle, below the diagonal.
  Vector<M, Value> reciprocal_;  ///< 1 / D.
  Eigen::Index lost_pivot_ = 0;
};

}  // namespace fpbm
