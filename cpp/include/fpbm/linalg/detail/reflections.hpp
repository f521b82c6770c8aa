#pragma once

#include <Eigen/Core>
#include <cmath>

#include "fpbm/core/types.hpp"
#include "fpbm/linalg/detail/column_sums.hpp"

namespace fpbm {

/// Product Q = H₀ H₁ … of Householder reflections of size N,
///
///   H_k = I − β v vᵀ,   β = 1/|v_k|,   v = x/|x| ± e_k,   where x is zero above entry k.
template <int N, typename Scalar>
class Reflections {
 public:
  /// Starts without reflections: Q = I.
  explicit Reflections(Eigen::Index n) noexcept {
    V_.resize(n, n);
    for (Eigen::Index i = 0; i < V_.size(); ++i) V_.coeffRef(i) = Scalar(0);
    beta_.resize(n);
  }

  [[nodiscard]] Eigen::Index size() const noexcept { return V_.rows(); }
  [[nodiscard]] Eigen::Index count() const noexcept { return count_; }

  /// Adds the reflection H_k, k = count(), that makes the entries of a column below entry k zero, and applies H_k to
  /// the column. The entries from entry k on must not all be zero.
  void add(Scalar* column) noexcept {
    Scalar* const x = column + count_;
    Scalar* const v = V_.data() + count_ * size() + count_;
    const Eigen::Index below = size() - count_;
    const Scalar length = std::sqrt(squared_length(x, below));
    const Scalar inverse = Scalar(1) / length;
    for (Eigen::Index i = 0; i < below; ++i) {
      v[i] = x[i] * inverse;
      x[i] = Scalar(0);
    }
    const Scalar sign = v[0] < Scalar(0) ? Scalar(-1) : Scalar(1);
    x[0] = -sign * length;
    v[0] += sign;
    beta_.coeffRef(count_) = Scalar(1) / std::abs(v[0]);
    ++count_;
  }

  /// Adds identities until count() is N.
  void fill() noexcept {
    for (; count_ < size(); ++count_) beta_.coeffRef(count_) = Scalar(0);
  }

  /// x becomes H_k x.
  void reflect(Eigen::Index k, Scalar* x) const noexcept {
    const Scalar* const v = V_.data() + k * size();
    // With fixed N, loops over all entries: the zeros above row k cost less than a loop of run-time length.
    const Eigen::Index begin = N == Eigen::Dynamic ? k : 0;
    const Eigen::Index end = N == Eigen::Dynamic ? size() : N;
    const Scalar along = beta_.coeff(k) * column_dot(v + begin, x + begin, end - begin);
    subtract_multiple(x + begin, along, v + begin, end - begin);
  }

  /// x becomes Q x.
  void apply(Scalar* x) const noexcept {
    for (Eigen::Index k = count_; k-- > 0;) reflect(k, x);
  }
  /// x becomes column j of Q. The last reflections do not change e_j if entry j of their v is zero, for example because
  /// no row depends on joint j.
  void column(Eigen::Index j, Scalar* x) const noexcept {
    for (Eigen::Index i = 0; i < size(); ++i) x[i] = Scalar(i == j ? 1 : 0);
    Eigen::Index k = count_;
    while (k > 0 && V_.coeff(j, k - 1) == Scalar(0)) --k;
    while (k-- > 0) reflect(k, x);
  }
  /// x becomes Qᵀx.
  void apply_transposed(Scalar* x) const noexcept {
    for (Eigen::Index k = 0; k < count_; ++k) reflect(k, x);
  }

 private:
  Matrix<N, N, Scalar> V_;  ///< Column k is v of H_k.
  Vector<N, Scalar> beta_;
  Eigen::Index count_ = 0;
};

}  // namespace fpbm
