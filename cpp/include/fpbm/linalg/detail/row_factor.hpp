#pragma once

#include <limits>
#include <type_traits>

#include "fpbm/core/detail/unrolled.hpp"
#include "fpbm/core/status.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/linalg/detail/column_sums.hpp"
#include "fpbm/linalg/detail/inverse_trace.hpp"
#include "fpbm/linalg/detail/pair.hpp"
#include "fpbm/linalg/detail/total.hpp"

namespace fpbm {

/// Factorisation A = L Qᵀ of a matrix of M rows, M ≤ N, by the modified Gram-Schmidt method (docs/equations.md, Other
/// degrees of redundancy). L is lower triangular with ones on its diagonal. The columns q_i of Q are orthogonal, with
/// the squared lengths D: AAᵀ = L D Lᵀ.
///
/// L is the exact factor of a matrix that equals A up to round-off. The error of Q is the round-off times the condition
/// number of A (Björck, "Solving linear least squares problems by Gram-Schmidt orthogonalization", 1967). The condition
/// number of A therefore enters the solutions once, and not squared as with a factorisation of AAᵀ
/// (`bench_accuracy` prints an error of 2e-12 for the position of a Panda at a condition number of 10⁵, see
/// bench/README.md). Needs M divisions and no square root. With Value = Pair<Scalar>, factorises two matrices in
/// parallel.
template <int M, int N, typename Value>
class RowFactor {
 public:
  using Scalar = typename ScalarOf<Value>::type;

  /// Factorises A, given Aᵀ. Returns kSingular if a row is dependent up to round-off, and kNotFinite if A is not
  /// finite. With lanes, returns kOk, and the solutions of a lane without a factorisation are NaN.
  [[nodiscard]] Status factor(const Matrix<N, M, Value>& At) noexcept {
    Q_ = At;
    const auto n = extent<N>(At.rows());
    const auto m = rows();
    Value whole(Scalar(0));  // Σ_j |a_j|² over the rows of A, where |a_j|² = |q_j|² + Σ_{k<j} L_jk² |q_k|².
    Value squares[kCapacity<M>];
    each(kFirst, m, [&](auto j) {
      Value* const column = Q_.data() + j * n;
      const Value square = dot(n, column, column);
      squares[j] = square;
      reciprocal_[j] = Value(Scalar(1)) / square;
      whole += square;
      each(kFirst, j, [&](Eigen::Index k) { whole += L_[j][k] * L_[j][k] * squares[k]; });
      each(next(j), m, [&](auto i) {
        Value* const row = Q_.data() + i * n;
        const Value coefficient = dot(n, row, column) * reciprocal_[j];
        L_[i][j] = coefficient;
        subtract(n, row, coefficient, column);
      });
    });
    const Value smallest = Value(Scalar(kPivotTolerance / static_cast<Number<Scalar>>(Eigen::Index(m)))) * whole;
    Mask<Scalar> regular(true);
    each(kFirst, m, [&](Eigen::Index j) { regular = regular && squares[j] > smallest; });
    if constexpr (kInLanes<Scalar>) {
      set_nan_unless(regular);
      return Status::kOk;
    } else {
      return regular ? Status::kOk : failure(At);
    }
  }

  /// Sets all solutions of a lane to NaN if the mask of the lane is false.
  void set_nan_unless(const Mask<Scalar>& truth) noexcept {
    // NaN in the first entry makes combine() and project() NaN, NaN in the last entry makes back_substitute() NaN.
    fpbm::set_nan_unless(truth, reciprocal_[0]);
    fpbm::set_nan_unless(truth, reciprocal_[rows() - 1]);
  }

  /// Coefficients s = D⁻¹L⁻¹b of A⁺b in the columns of Q: A⁺b = Q s.
  [[nodiscard]] Vector<M, Value> coefficients(const Vector<M, Value>& b) const noexcept {
    Vector<M, Value> s = b;
    const auto m = rows();
    each(kFirst, m, [&](auto i) { each(kFirst, i, [&](Eigen::Index j) { s.coeffRef(i) -= L_[i][j] * s.coeff(j); }); });
    each(kFirst, m, [&](Eigen::Index i) { s.coeffRef(i) *= reciprocal_[i]; });
    return s;
  }

  /// P a, the projection of a on the null space of A: P = Π_i (I − q_i q_iᵀ/q_iᵀq_i).
  ///
  /// Each factor is applied to the result of the previous factor, which is slightly more accurate than I − Q D⁻¹ Qᵀ,
  /// because the computed columns of Q are not exactly orthogonal.
  [[nodiscard]] Vector<N, Value> project(const Vector<N, Value>& a) const noexcept {
    const auto n = extent<N>(Q_.rows());
    Vector<N, Value> result = a;
    each(kFirst, rows(), [&](Eigen::Index i) {
      const Value* const column = Q_.data() + i * n;
      subtract(n, result.data(), dot(n, column, result.data()) * reciprocal_[i], column);
    });
    return result;
  }

  /// Q s, which is A⁺b for s = coefficients(b).
  [[nodiscard]] Vector<N, Value> combine(const Vector<M, Value>& s) const noexcept {
    Vector<N, Value> y;
    y.resize(Q_.rows());
    if constexpr (kLong) {
      y = filled<Vector<N, Value>>(N);
      each(kFirst, rows(), [&](Eigen::Index i) { subtract_multiple(y.data(), -s.coeff(i), Q_.data() + i * N, N); });
      return y;
    }
    each(kFirst, extent<N>(Q_.rows()), [&](Eigen::Index k) {
      Value at = s.coeff(0) * Q_.coeff(k, 0);
      each(next(kFirst), rows(), [&](Eigen::Index i) { at += s.coeff(i) * Q_.coeff(k, i); });
      y.coeffRef(k) = at;
    });
    return y;
  }

  /// (AAᵀ)⁻¹b = L⁻ᵀs, for s = coefficients(b).
  [[nodiscard]] Vector<M, Value> back_substitute(const Vector<M, Value>& s) const noexcept {
    Vector<M, Value> x = s;
    for (Eigen::Index i = x.size() - 2; i >= 0; --i) {
      // x(i + 1) is computed last, and therefore used last: the earlier products do not wait for x(i + 1).
      for (Eigen::Index j = x.size() - 1; j > i; --j) x(i) -= L_[j][i] * x(j);
    }
    return x;
  }

  /// Trace of (AAᵀ)⁻¹, whose reciprocal is a lower bound on the square of the smallest singular value of A, tight
  /// within a factor M.
  [[nodiscard]] Value inverse_trace() const noexcept { return fpbm::inverse_trace(L_, reciprocal_, rows()); }

 private:
  /// Σ a_k b_k over the columns of A.
  template <typename Count>
  [[nodiscard, gnu::always_inline]] static Value dot([[maybe_unused]] Count n, const Value* a,
                                                     const Value* b) noexcept {
    if constexpr (kLong) {
      return column_dot(a, b, N);
    } else if constexpr (std::is_same_v<Count, Constant<N>>) {
      return total<0, N>([&](Eigen::Index k) { return a[k] * b[k]; });
    } else {
      Value sum(Scalar(0));
      for (Eigen::Index k = 0; k < n; ++k) sum += a[k] * b[k];
      return sum;
    }
  }
  /// a −= s b, over the columns of A.
  template <typename Count>
  [[gnu::always_inline]] static void subtract(Count n, Value* a, const Value& s, const Value* b) noexcept {
    if constexpr (kLong) {
      if (s != Value(Scalar(0))) subtract_multiple(a, s, b, N);  // s is zero for rows of different arms.
    } else {
      each(kFirst, n, [&](Eigen::Index k) { a[k] -= s * b[k]; });
    }
  }

  [[nodiscard, gnu::noinline]] static Status failure(const Matrix<N, M, Value>& At) noexcept {
    for (Eigen::Index i = 0; i < At.cols(); ++i) {
      Value square(Scalar(0));
      for (Eigen::Index k = 0; k < At.rows(); ++k) square += At(k, i) * At(k, i);
      if (!is_finite(square)) return Status::kNotFinite;
    }
    return Status::kSingular;
  }

  /// Smallest squared length of a column of Q, relative to the mean squared length of the rows of A. Shorter columns
  /// count as round-off error, as in the Cholesky factorisation of AAᵀ. 6e-4 ε to 64 ε pass `RowFactors*`; with 640 ε,
  /// regular rows in float are rejected.
  static constexpr auto kPivotTolerance = 64 * std::numeric_limits<Number<Scalar>>::epsilon();
  static constexpr Constant<0> kFirst{};
  /// Whether the columns of Q are long enough for loops over pairs of entries.
  static constexpr bool kLong = std::is_same_v<Value, double> && N > kUnrolled;

  /// Number of rows of A.
  [[nodiscard]] auto rows() const noexcept { return extent<M>(Q_.cols()); }

  Matrix<N, M, Value> Q_;
  Value L_[kCapacity<M>][kCapacity<M>];  ///< L below its diagonal.
  Value reciprocal_[kCapacity<M>];       ///< 1 / D.
};

}  // namespace fpbm
