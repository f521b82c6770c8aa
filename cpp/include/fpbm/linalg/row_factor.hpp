#pragma once

#include <limits>
#include <type_traits>

#include "fpbm/core/status.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/core/unrolled.hpp"
#include "fpbm/linalg/inverse_trace.hpp"
#include "fpbm/linalg/pair.hpp"
#include "fpbm/linalg/paired.hpp"
#include "fpbm/linalg/total.hpp"

namespace fpbm {

/// Factor A = L Qᵀ of a matrix of M rows, M ≤ N, by Gram and Schmidt's method, modified: L has ones on its diagonal,
/// the columns of Q are at right angles, and AAᵀ = L D Lᵀ with the squares D of their lengths.
///
/// L and Q are those of a matrix that is A to round-off, but for the condition of A times round-off in Q (Björck,
/// "Solving linear least squares problems by Gram-Schmidt orthogonalization", 1967). So that condition enters the
/// solutions once, and not squared as with a factor of AAᵀ. No root; M divisions. Value = Pair<Scalar> factorises two
/// matrices at once.
template <int M, int N, typename Value>
class RowFactor {
 public:
  using Scalar = typename ScalarOf<Value>::type;

  /// Factorises A, given Aᵀ. Returns kSingular where a row is lost in round-off, kNotFinite where A is not finite. In
  /// lanes it returns kOk, and the solutions of a lane without a factor are NaN.
  [[nodiscard]] Status factor(const Matrix<N, M, Value>& At) noexcept {
    Q_ = At;
    const auto n = extent<N>(At.rows());
    const auto m = rows();
    Value whole(Scalar(0));  // Σ|a_j|², by Pythagoras.
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
        const Value share = dot(n, row, column) * reciprocal_[j];
        L_[i][j] = share;
        subtract(n, row, share, column);
      });
    });
    const Value smallest = Value(Scalar(kPivotTolerance / static_cast<Number<Scalar>>(Eigen::Index(m)))) * whole;
    Mask<Scalar> regular(true);
    each(kFirst, m, [&](Eigen::Index j) { regular = regular && squares[j] > smallest; });
    if constexpr (kInLanes<Scalar>) {
      set_nan_unless(regular);
      return Status::kOk;
    } else {
      return regular ? Status::kOk : lost(At);
    }
  }

  /// Sets all solutions of a lane to NaN where its mask is false.
  void set_nan_unless(const Mask<Scalar>& truth) noexcept {
    fpbm::set_nan_unless(truth, reciprocal_[0]);
    fpbm::set_nan_unless(truth, reciprocal_[rows() - 1]);
  }

  /// D⁻¹L⁻¹b: what A⁺b takes of each column of Q.
  [[nodiscard]] Vector<M, Value> shares(const Vector<M, Value>& b) const noexcept {
    Vector<M, Value> s = b;
    const auto m = rows();
    each(kFirst, m, [&](auto i) { each(kFirst, i, [&](Eigen::Index j) { s.coeffRef(i) -= L_[i][j] * s.coeff(j); }); });
    each(kFirst, m, [&](Eigen::Index i) { s.coeffRef(i) *= reciprocal_[i]; });
    return s;
  }

  /// a without its part in the span of A's rows: without the share of each column of Q in turn, of what those before
  /// it have left.
  [[nodiscard]] Vector<N, Value> without(const Vector<N, Value>& a) const noexcept {
    const auto n = extent<N>(Q_.rows());
    Vector<N, Value> left = a;
    each(kFirst, rows(), [&](Eigen::Index i) {
      const Value* const column = Q_.data() + i * n;
      subtract(n, left.data(), dot(n, column, left.data()) * reciprocal_[i], column);
    });
    return left;
  }

  /// Q s.
  [[nodiscard]] Vector<N, Value> sum(const Vector<M, Value>& s) const noexcept {
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

  /// (AAᵀ)⁻¹b = L⁻ᵀs, given these shares of b.
  [[nodiscard]] Vector<M, Value> back(const Vector<M, Value>& s) const noexcept {
    Vector<M, Value> x = s;
    for (Eigen::Index i = x.size() - 2; i >= 0; --i) {
      for (Eigen::Index j = x.size() - 1; j > i; --j) x(i) -= L_[j][i] * x(j);  // Backwards: x(i + 1) is known last.
    }
    return x;
  }

  /// Trace of (AAᵀ)⁻¹. Its reciprocal is a lower bound on the square of the least singular value of A, tight within a
  /// factor M.
  [[nodiscard]] Value inverse_trace() const noexcept { return fpbm::inverse_trace(L_, reciprocal_, rows()); }

 private:
  /// Σ a_k b_k over the columns of A.
  template <typename Count>
  [[nodiscard, gnu::always_inline]] static Value dot([[maybe_unused]] Count n, const Value* a,
                                                     const Value* b) noexcept {
    if constexpr (kLong) {
      return paired_dot(a, b, N);
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
      if (s != Value(Scalar(0))) subtract_multiple(a, s, b, N);  // Rows of different arms have no joints in common.
    } else {
      each(kFirst, n, [&](Eigen::Index k) { a[k] -= s * b[k]; });
    }
  }

  [[nodiscard, gnu::noinline]] static Status lost(const Matrix<N, M, Value>& At) noexcept {
    for (Eigen::Index i = 0; i < At.cols(); ++i) {
      Value square(Scalar(0));
      for (Eigen::Index k = 0; k < At.rows(); ++k) square += At(k, i) * At(k, i);
      if (!is_finite(square)) return Status::kNotFinite;
    }
    return Status::kSingular;
  }

  /// Least square of a column of Q, relative to the mean of those of the rows of A, that is taken for more than
  /// round-off.
  static constexpr auto kPivotTolerance = 64 * std::numeric_limits<Number<Scalar>>::epsilon();
  static constexpr Constant<0> kFirst{};
  /// Whether the columns of Q are long enough for loops over pairs of entries.
  static constexpr bool kLong = std::is_same_v<Value, double> && N > kUnrolled;

  /// Number of rows of A.
  [[nodiscard]] auto rows() const noexcept { return extent<M>(Q_.cols()); }

  Matrix<N, M, Value> Q_;
  Value L_[kCapacity<M>][kCapacity<M>];  ///< Below the diagonal.
  Value reciprocal_[kCapacity<M>];       ///< 1 / D.
};

}  // namespace fpbm
