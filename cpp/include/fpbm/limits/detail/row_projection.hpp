#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include "fpbm/limits/detail/rows.hpp"
#include "fpbm/linalg/detail/cholesky.hpp"
#include "fpbm/linalg/detail/entrywise.hpp"
#include "fpbm/linalg/detail/product.hpp"
#include "fpbm/linalg/detail/sums.hpp"

namespace fpbm {

/// Nearest motion to a desired motion u₀ that satisfies the rows g_k·u ≤ b_k (docs/clearance_proof.md, Rows):
///
///   min (u − u₀)ᵀ H (u − u₀)   where g_k·u ≤ b_k,   H = JᵀB⁻¹J + I.
///
/// With B = μI, null-space motion has the cost μ relative to a change of the task. In the directions of larger
/// eigenvalues of B, a change of the task has a lower cost.
///
/// The dual active-set method (D. Goldfarb, A. Idnani 1983) solves the problem: violated rows become active one by one,
/// and an active row whose multiplier decreases to zero is released. The result is a continuous function of all inputs.
template <int M, int N, int P, typename Scalar>
class RowProjection {
 public:
  using JointVector = Vector<N, Scalar>;

  RowProjection(const Matrix<M, N, Scalar>& J, const Matrix<M, M, Scalar>& B, const Rows<N, P, Scalar>& rows) noexcept
      : rows_(rows) {
    const Matrix<M, M, Scalar> gram = sum_of(B, gram_of(J));
    Cholesky<M, Scalar> cholesky;
    const bool regular = cholesky.factor(gram) == Status::kOk;
    inverse_columns_.resize(J.cols(), P);
    u_.resize(J.cols());
    for (Eigen::Index k = 0; k < rows.count; ++k) {
      JointVector direction = column(rows.g, k);  // H⁻¹g = g − Jᵀ(B + JJᵀ)⁻¹J g.
      if (regular) {
        const JointVector removed = transpose_times(J, cholesky.solve(product(J, direction)));
        direction = entrywise(direction, [&](Eigen::Index i) { return direction.coeff(i) - removed.coeff(i); });
      }
      set_column(inverse_columns_, k, direction);
      sizes_(k) = gain(k, k);
    }
  }

  /// The nearest motion. If `solved` is set, the result is exact up to round-off. Otherwise, the rows are infeasible or
  /// nearly infeasible.
  [[nodiscard]] JointVector operator()(const JointVector& desired) noexcept {
    u_ = desired;
    count_ = 0;
    solved = false;
    bool is_partial = false;
    for (int change = 0; change < kChanges * P; ++change) {
      if (!is_partial && !find_violated()) {
        solved = true;
        break;
      }
      if (!step(is_partial)) break;
    }
    return u_;
  }

  /// Bit k is set if row k is active.
  [[nodiscard]] std::uint64_t active() const noexcept {
    std::uint64_t bits = 0;
    for (Eigen::Index j = 0; j < count_; ++j) bits |= std::uint64_t(1) << active_[j];
    return bits;
  }

  bool solved = false;

 private:
  /// Largest number of changes of the active set for each row. RowProjection.is_optimal passes with 2, and fails
  /// with 1.
  static constexpr int kChanges = 3;
  static constexpr int kMost = P < kCapacity<N> ? P : kCapacity<N>;
  /// As in Rows::admitted_fraction().
  static constexpr Scalar kRoundOff = Scalar(64) * std::numeric_limits<Scalar>::epsilon();
  /// If the independent part of gᵀH⁻¹g is below this fraction of gᵀH⁻¹g, the row g to be added is treated as linearly
  /// dependent on the active rows. In double, RowProjection.is_optimal passes with 1e-12 to 1e-5. In 500 random
  /// problems of 18 rows, 1e-15 to 1e-7 give the same results; with 1e-5, 21 instead of 2 problems are not solved.
  static constexpr Scalar kIndependent = std::numeric_limits<Scalar>::digits > 24 ? Scalar(1e-9) : Scalar(1e-5);
  using Rates = Vector<Eigen::Dynamic, Scalar>;

  /// Sets violated_ to the row whose violation is largest in the norm of H. Returns false if no row is violated beyond
  /// round-off.
  [[nodiscard]] bool find_violated() noexcept {
    Scalar worst(0);
    for (Eigen::Index k = 0; k < rows_.count; ++k) {
      const Scalar beyond = rows_.excess(k, u_);
      const Scalar size = sizes_(k);
      if (!(beyond > Scalar(0))) continue;
      const Scalar round_off = kRoundOff * (std::abs(rows_.b(k)) + rows_.magnitude(k, u_));
      if (!(size > Scalar(0)) || !(beyond > round_off) || !(beyond * beyond > worst * size) || is_active(k)) continue;
      worst = beyond * beyond / size;
      violated_ = k;
    }
    multiplier_ = Scalar(0);
    return worst > Scalar(0);
  }

  /// Moves u toward row violated_ until u satisfies the row, or until the multiplier of an active row decreases to
  /// zero. In the first case, row violated_ becomes active. In the second case, the active row is released, and
  /// `is_partial` is set, since row violated_ is still violated. Returns false if no motion satisfies the row.
  [[nodiscard]] bool step(bool& is_partial) noexcept {
    Rates rates(count_);  // Decrease of each active row's multiplier per increase of the multiplier of row violated_.
    if (!find_rates(rates)) return false;
    JointVector direction = column(inverse_columns_, violated_);
    for (Eigen::Index j = 0; j < count_; ++j) {
      direction = entrywise(direction, [&](Eigen::Index i) {
        return direction.coeff(i) - rates(j) * inverse_columns_.coeff(i, active_[j]);
      });
    }
    Scalar length = std::numeric_limits<Scalar>::infinity();
    Eigen::Index leaving = -1;
    for (Eigen::Index j = 0; j < count_; ++j) {
      if (!(rates(j) > Scalar(0)) || !(multipliers_[j] < length * rates(j))) continue;
      length = multipliers_[j] / rates(j);
      leaving = j;
    }
    const Scalar slope = rows_.along(violated_, direction);
    const bool independent = slope > kIndependent * sizes_(violated_) && count_ < kMost;
    const Scalar beyond = rows_.excess(violated_, u_);
    if (independent && beyond <= length * slope) {
      length = beyond / slope;
      leaving = -1;
    } else if (leaving < 0) {
      return false;
    }
    if (independent) u_ = entrywise(u_, [&](Eigen::Index i) { return u_.coeff(i) - length * direction.coeff(i); });
    multiplier_ += length;
    for (Eigen::Index j = 0; j < count_; ++j) multipliers_[j] -= length * rates(j);
    is_partial = leaving >= 0;
    is_partial ? release(leaving) : activate();
    return true;
  }

  void activate() noexcept {
    for (Eigen::Index j = 0; j < count_; ++j) gains_(count_, j) = by_violated_(j);
    gains_(count_, count_) = sizes_(violated_);
    active_[count_] = violated_;
    multipliers_[count_++] = multiplier_;
  }

  void release(Eigen::Index leaving) noexcept {
    --count_;
    for (Eigen::Index j = leaving; j < count_; ++j) {
      active_[j] = active_[j + 1];
      multipliers_[j] = multipliers_[j + 1];
      for (Eigen::Index i = 0; i <= j; ++i) gains_(j, i) = gains_(j + 1, i < leaving ? i : i + 1);
    }
  }

  /// r in (GᵀH⁻¹G) r = GᵀH⁻¹g, where the columns of G are the active rows and g is row violated_. Returns false if the
  /// active rows are dependent.
  [[nodiscard]] bool find_rates(Rates& rates) noexcept {
    if (count_ == 0) return true;
    Matrix<Eigen::Dynamic, Eigen::Dynamic, Scalar> gram(count_, count_);
    for (Eigen::Index j = 0; j < count_; ++j) {
      rates(j) = by_violated_(j) = gain(active_[j], violated_);
      for (Eigen::Index i = j; i < count_; ++i) gram(i, j) = gains_(i, j);
    }
    Cholesky<Eigen::Dynamic, Scalar> cholesky;
    if (cholesky.factor(gram) != Status::kOk) return false;
    rates = cholesky.solve(rates);
    return true;
  }

  /// gᵢᵀ H⁻¹ gⱼ
  [[nodiscard]] Scalar gain(Eigen::Index i, Eigen::Index j) const noexcept {
    return sum_over(u_, [&](Eigen::Index k) { return rows_.g.coeff(k, i) * inverse_columns_.coeff(k, j); });
  }

  [[nodiscard]] bool is_active(Eigen::Index k) const noexcept {
    return std::find(active_, active_ + count_, k) != active_ + count_;
  }

  Rows<N, P, Scalar> rows_;
  Matrix<N, P, Scalar> inverse_columns_;  ///< Column k is H⁻¹g_k.
  JointVector u_;
  Eigen::Index violated_ = 0;      ///< Violated row that becomes active next.
  Scalar multiplier_ = Scalar(0);  ///< Multiplier of row violated_.
  Eigen::Index count_ = 0;
  Eigen::Index active_[kMost];
  Vector<P, Scalar> sizes_;             ///< gain(k, k)
  Vector<kMost, Scalar> by_violated_;   ///< gain() of the active rows with row violated_.
  Matrix<kMost, kMost, Scalar> gains_;  ///< gain() of the active rows, lower triangle.
  Scalar multipliers_[kMost];
};

}  // namespace fpbm
