#pragma once

#include <cmath>
#include <limits>

#include "fpbm/core/detail/unrolled.hpp"
#include "fpbm/core/status.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/linalg/detail/inverse_trace.hpp"
#include "fpbm/linalg/detail/pair.hpp"

namespace fpbm {

/// Square-root-free Cholesky factorisation A = L D Lᵀ of a small symmetric positive definite matrix.
///
/// Unrolled if M is fixed and small. Needs M divisions and no square root. With Value = Pair<Scalar>, factorises two
/// matrices in parallel.
template <int M, typename Value = double>
class Cholesky {
 public:
  using Scalar = typename ScalarOf<Value>::type;

  /// Factorises A. Reads only the lower triangle.
  /// Returns kSingular if a pivot is not larger than round-off error (A is singular or indefinite), and kNotFinite if A
  /// is not finite. With lanes, returns kOk, and the solutions of a lane without a factorisation are NaN.
  [[nodiscard]] Status factor(const Matrix<M, M, Value>& A) noexcept {
    size_ = A.rows();
    const auto m = extent<M>(size_);
    using std::max;
    Value largest = A(0, 0);
    each(kFirst, m, [&](auto i) {
      largest = max(largest, A.coeff(i, i));
      each(kFirst, next(i), [&](Eigen::Index j) { L_[i][j] = A.coeff(i, j); });
    });
    const Value smallest = Value(Scalar(kPivotTolerance)) * largest;
    Mask<Scalar> regular(true);
    each(kFirst, m, [&](auto j) {
      const Value pivot = L_[j][j];
      regular = regular && pivot > smallest;
      reciprocal_[j] = Value(Scalar(1)) / pivot;
      each(next(j), m, [&](auto i) {
        const Value l = L_[i][j] * reciprocal_[j];
        each(next(j), next(i), [&](Eigen::Index k) { L_[i][k] -= l * L_[k][j]; });
      });
      each(next(j), m, [&](Eigen::Index i) { L_[i][j] *= reciprocal_[j]; });
    });
    if constexpr (kInLanes<Scalar>) {
      set_nan_unless(regular);
      return Status::kOk;
    } else {
      return regular ? Status::kOk : lost(A, smallest);
    }
  }

  /// Sets all solutions of a lane to NaN if the mask of the lane is false.
  void set_nan_unless(const Mask<Scalar>& truth) noexcept { fpbm::set_nan_unless(truth, reciprocal_[0]); }

  /// Row whose pivot factor() rejected. The leading block of A above the rejected row is positive definite.
  [[nodiscard]] Eigen::Index lost_pivot() const noexcept { return lost_pivot_; }

  /// Solution x of A x = b.
  [[nodiscard]] Vector<M, Value> solve(const Vector<M, Value>& b) const noexcept {
    const auto m = extent<M>(size_);
    Vector<M, Value> x = b;
    each(kFirst, m, [&](auto i) { each(kFirst, i, [&](Eigen::Index j) { x.coeffRef(i) -= L_[i][j] * x.coeff(j); }); });
    for (Eigen::Index i = m - 1; i >= 0; --i) {
      x(i) *= reciprocal_[i];
      for (Eigen::Index j = m - 1; j > i; --j) x(i) -= L_[j][i] * x(j);  // Descending: x(i + 1) is computed last.
    }
    return x;
  }

  /// R a, where R = L⁻ᵀD^(−1/2) is a square root of A⁻¹: R Rᵀ = A⁻¹.
  [[nodiscard]] Vector<M, Value> inverse_root(const Vector<M, Value>& a) const noexcept {
    using std::sqrt;
    Vector<M, Value> x = a;
    for (Eigen::Index i = size_ - 1; i >= 0; --i) {
      x(i) *= sqrt(reciprocal_[i]);
      for (Eigen::Index j = size_ - 1; j > i; --j) x(i) -= L_[j][i] * x(j);
    }
    return x;
  }

  /// B and b become D^(−1/2)L⁻¹B and D^(−1/2)L⁻¹b. If A = B Bᵀ, the new rows of B are orthonormal.
  template <int N>
  void orthonormalize(Matrix<M, N, Value>& B, Vector<M, Value>& b) const noexcept {
    using std::sqrt;
    const auto m = extent<M>(size_);
    Vector<M, Value> root = b;
    each(kFirst, m, [&](Eigen::Index i) { root.coeffRef(i) = sqrt(reciprocal_[i]); });
    const auto apply = [&](Value* x) {
      each(kFirst, m, [&](auto i) { each(kFirst, i, [&](Eigen::Index j) { x[i] -= L_[i][j] * x[j]; }); });
      each(kFirst, m, [&](Eigen::Index i) { x[i] *= root.coeff(i); });
    };
    for (Eigen::Index j = 0; j < B.cols(); ++j) apply(B.data() + j * size_);
    apply(b.data());
  }

  /// Trace of A⁻¹, whose reciprocal is a lower bound on the smallest eigenvalue of A, tight within a factor M.
  [[nodiscard]] Value inverse_trace() const noexcept { return fpbm::inverse_trace(L_, reciprocal_, extent<M>(size_)); }

 private:
  [[nodiscard]] Status lost(const Matrix<M, M, Value>& A, const Value& smallest) noexcept {
    const Value one = Value(Scalar(1));
    for (lost_pivot_ = 0; lost_pivot_ + 1 < size_; ++lost_pivot_) {
      const Value& reciprocal = reciprocal_[lost_pivot_];
      if (!(reciprocal > Value(Scalar(0)) && one > smallest * reciprocal)) break;
    }
    for (Eigen::Index i = 0; i < A.rows(); ++i) {
      for (Eigen::Index j = 0; j <= i; ++j) {
        if (!is_finite(A(i, j))) return Status::kNotFinite;
      }
    }
    return Status::kSingular;
  }

  /// Smallest pivot, relative to the largest diagonal entry. The round-off error is at most (M + 1) ε/2 (N. J. Higham,
  /// Accuracy and Stability of Numerical Algorithms, 2002, theorem 10.3), half of kPivotTolerance for M = kMaxDof. With
  /// 6 ε, singular matrices are accepted, and `*CholeskyOf*` fails for 32 rows; up to 6e5 ε pass.
  static constexpr auto kPivotTolerance = 64 * std::numeric_limits<Number<Scalar>>::epsilon();
  static constexpr Constant<0> kFirst{};

  Value L_[kCapacity<M>][kCapacity<M>];  ///< Unit lower triangle, below the diagonal.
  Value reciprocal_[kCapacity<M>];       ///< 1 / D.
  Eigen::Index size_ = 0;
  Eigen::Index lost_pivot_ = 0;
};

}  // namespace fpbm
