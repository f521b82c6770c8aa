#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "fpbm/core/detail/unrolled.hpp"
#include "fpbm/core/status.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/linalg/detail/cholesky.hpp"
#include "fpbm/linalg/detail/entrywise.hpp"
#include "fpbm/linalg/detail/lower_gram.hpp"
#include "fpbm/linalg/detail/product.hpp"
#include "fpbm/linalg/detail/row_factor.hpp"
#include "fpbm/linalg/detail/sums.hpp"
#include "fpbm/singular/damping.hpp"
#include "fpbm/singular/detail/lost_directions.hpp"

namespace fpbm {

/// Lower bound on σ_min(J), tight within a factor √M: 1/√tr((JJᵀ)⁻¹). At a singular posture, the bound is 0 or
/// round-off error of the order of √epsilon ‖J‖_F.
template <int M, int N, typename Scalar>
[[nodiscard]] Scalar least_singular_value_bound(const Matrix<M, N, Scalar>& J) noexcept {
  using std::sqrt;
  Cholesky<M, Scalar> cholesky;
  if (cholesky.factor(lower_gram(J)) != Status::kOk) return Scalar(0);
  return Scalar(1) / sqrt(cholesky.inverse_trace());
}

/// ‖DJ‖²_F, where D multiplies the last kTurns rows, which are angular, by length [m].
template <int kTurns, int M, int N, typename Scalar>
[[nodiscard]] Scalar squared_norm_in_metres(const Matrix<M, N, Scalar>& J, const Scalar& length) noexcept {
  if constexpr (M == Eigen::Dynamic) {
    return squared_norm(J);
  } else {
    auto squares = filled<Vector<M, Scalar>>(M);  // One sum for each row: the compiler adds the rows in parallel.
    for (Eigen::Index j = 0; j < extent<N>(J.cols()); ++j) {
      for (int i = 0; i < M; ++i) squares.coeffRef(i) += J.coeff(i, j) * J.coeff(i, j);
    }
    Scalar sum = squares.coeff(0);
    for (int i = 1; i < M; ++i) sum += i < M - kTurns ? squares.coeff(i) : length * length * squares.coeff(i);
    return sum;
  }
}

/// Solves systems with J C, where C Cᵀ = W⁻¹, and with the Gram matrix JW⁻¹Jᵀ. If J is nearly singular, damping Δ is
/// added to the Gram matrix (SingularDamping). With Value = Pair<Scalar>, solves for two different W in parallel. All
/// rows of J are in metres.
template <int M, int N, typename Value>
class DampedGram {
 public:
  using Scalar = typename ScalarOf<Value>::type;

  /// J and rows = (JC)ᵀ must outlive the DampedGram.
  DampedGram(const SingularDamping<Scalar>& damping, const Matrix<M, N, Scalar>& J,
             const Matrix<N, M, Value>& rows) noexcept
      : damping_(damping), J_(J), rows_(rows) {}
  DampedGram(const SingularDamping<Scalar>&, const Matrix<M, N, Scalar>&&, const Matrix<N, M, Value>&) = delete;
  DampedGram(const SingularDamping<Scalar>&, const Matrix<M, N, Scalar>&, const Matrix<N, M, Value>&&) = delete;

  /// Factorises JC, given an upper bound on the largest eigenvalue of W⁻¹ (for a pair: of the first W). Returns kDamped
  /// if Δ is not zero, or the reason for a missing factorisation.
  [[nodiscard]] Status factor(Scalar inverse_bound) noexcept {
    const Status status = factor_.factor(rows_);
    if (all_of(damping_.radius() == Scalar(0)) || status == Status::kNotFinite) return status;

    // Most postures are far from singular, which the factorisation shows: λ_min(JJᵀ) ≥ λ_min(JW⁻¹Jᵀ) / ‖W⁻¹‖.
    const Scalar threshold = damping_.radius() * damping_.radius() * squared_norm_in_metres<0>(J_, Scalar(1));
    const Scalar bound = threshold * inverse_bound;
    const Scalar trace = first(factor_.inverse_trace());
    const Mask<Scalar> regular = bound * trace <= Scalar(1);
    if constexpr (kInLanes<Scalar>) {
      factor_.set_nan_unless(regular);
      return status;
    } else {
      return status == Status::kOk && regular ? status : damped(threshold, bound, status);
    }
  }

  /// Solutions after factor().
  template <bool kDamped>
  struct Solutions {
    using Entry = Value;
    static constexpr bool kIsDamped = kDamped;
    const DampedGram& of;

    /// (JC)ᵀ(JW⁻¹Jᵀ + Δ)⁻¹b, which is (JC)⁺b if Δ = 0.
    [[nodiscard]] Vector<N, Value> motion(const Vector<M, Value>& b) const noexcept {
      if constexpr (kDamped) return product(of.rows_, of.damped_.solve(b));
      return of.factor_.combine(of.factor_.coefficients(b));
    }
    /// (JW⁻¹Jᵀ + Δ)⁻¹b.
    [[nodiscard]] Vector<M, Value> force(const Vector<M, Value>& b) const noexcept {
      if constexpr (kDamped) return of.damped_.solve(b);
      return of.factor_.back_substitute(of.factor_.coefficients(b));
    }
    /// a − motion(J C a), which for Δ = 0 is the projection of a on the null space of JC.
    [[nodiscard]] Vector<N, Value> project(const Vector<N, Value>& a) const noexcept {
      if constexpr (kDamped) {
        const Vector<N, Value> taken = motion(transpose_times(of.rows_, a));
        return entrywise(a, [&](Eigen::Index i) { return a.coeff(i) - taken.coeff(i); });
      }
      return of.factor_.project(a);
    }
    /// Secondary motion a without task motion, for a commanded motion b: the projection of a on the null space of JC,
    /// times LostDirections::fade, which is zero in a singular posture. The product is continuous, although the
    /// projection is not continuous in a singular posture (docs/singularities.md, Secondary motion). The second
    /// projection removes the round-off error of the first (kUnknown). If the command is beyond the lost directions
    /// (beyond()), project(a) replaces this motion.
    [[nodiscard]] Vector<N, Value> secondary(const Vector<N, Value>& a, const Vector<M, Scalar>& b) const noexcept {
      const Scalar beyond = of.beyond(a, b);
      const Scalar fade = (Scalar(1) - beyond) * of.fade_;
      Vector<N, Value> result = filled<Vector<N, Value>>(a.size());
      if (fade > Scalar(0)) {
        const Vector<N, Value> projected = of.factor_.project(of.factor_.project(a));
        result = entrywise(a, [&](Eigen::Index i) { return Value(fade) * projected.coeff(i); });
      }
      if (!(beyond > Scalar(0))) return result;
      const Vector<N, Value> damped = project(a);
      return entrywise(a, [&](Eigen::Index i) { return result.coeff(i) + Value(beyond) * damped.coeff(i); });
    }
  };

  /// Calls f(solutions), which is compiled for solutions with and without damping, so that the usual case without
  /// damping has no branches.
  template <typename F>
  [[nodiscard, gnu::always_inline]] auto solved(const F& f) const noexcept {
    if constexpr (!kInLanes<Scalar>) {
      if (damps()) return f(Solutions<true>{*this});
    }
    return f(Solutions<false>{*this});
  }

  /// Whether Δ is not zero. False with lanes, whose solutions are NaN in each lane in which damping may act.
  [[nodiscard]] bool damps() const noexcept { return damps_; }

  /// Additional null-space damping [1/s].
  [[nodiscard]] Scalar brake() const noexcept { return damping_.brake() * lost_; }

 private:
  /// Whether the command is beyond the lost directions, from 0 to 1 (docs/singularities.md, Secondary motion): with
  /// t = |Δ b|/(ε³ (|a| + kUsual)), the result is (t² − 1)/3 within [0, 1].
  [[nodiscard]] Scalar beyond(const Vector<N, Value>& a, const Vector<M, Scalar>& b) const noexcept {
    const Scalar command = squared_norm(product(delta_, b));
    const Scalar size =
        std::sqrt(first(entrywise(a, [&](Eigen::Index i) { return a.coeff(i) * a.coeff(i); }).sum())) + Scalar(kUsual);
    const Scalar most = threshold_ * threshold_ * threshold_ * size * size;
    return command > most ? std::min((command - most) / (Scalar(3) * most), Scalar(1)) : Scalar(0);
  }

  [[nodiscard, gnu::noinline]] Status damped(Scalar threshold, Scalar bound, Status undamped) noexcept {
    LostDirections<M, Scalar> lost(gram_of(J_), J_, threshold);
    lost_ = lost.count;
    delta_ = std::move(lost.delta);
    threshold_ = threshold;
    const Scalar round_off = kUnknown / damping_.radius();
    const bool known = Value(Scalar(1)) > Value(round_off * round_off * bound) * factor_.inverse_trace();
    fade_ = known ? lost.fade : Scalar(0);
    damps_ = lost_ > Scalar(0);
    if (!damps_) return undamped;
    Matrix<M, M, Value> gram = filled<Matrix<M, M, Value>>(J_.rows());  // Lower triangle.
    for (Eigen::Index i = 0; i < J_.rows(); ++i) {
      const Vector<N, Value> row = column(rows_, i);
      for (Eigen::Index j = 0; j <= i; ++j) {
        gram(i, j) = entrywise(row, [&](Eigen::Index k) { return row.coeff(k) * rows_.coeff(k, j); }).sum() +
                     Value(delta_(i, j));
      }
    }
    const Status status = damped_.factor(gram);
    return status == Status::kOk ? Status::kDamped : status;
  }

  /// Smallest σ_min(JC)/‖JC‖, up to a factor √M, with which the null space of JC is known. With x = ε_machine
  /// ‖JC‖/σ_min, the task motion of one projection is about x of |z|, and of two projections x³, because each
  /// projection leaves x of the motion along the lost direction. With 4 and 32, `fpbm_tests
  /// --gtest_filter='Spectra*secondary*'` prints the same errors. If z is omitted, LostDirections::fade is below 300 M
  /// ε_machine for each radius from 32 √ε_machine.
  static constexpr auto kUnknown = 32 * std::numeric_limits<Number<Scalar>>::epsilon();

  SingularDamping<Scalar> damping_;
  const Matrix<M, N, Scalar>& J_;
  const Matrix<N, M, Value>& rows_;
  RowFactor<M, N, Value> factor_;  ///< Factorisation of JC.
  Cholesky<M, Value> damped_;      ///< Factorisation of JW⁻¹Jᵀ + Δ. Set only if Δ ≠ 0.
  /// Usual size of a secondary motion [rad/s] or [rad/s²], with which a command is compared if z is small. Not tuned:
  /// Tracker.stops_at_the_workspace_boundary_and_returns has |z| from 1 to 8.
  static constexpr Number<Scalar> kUsual = 1;

  Matrix<M, M, Scalar> delta_;  ///< Δ. Set only if the rows are nearly singular.
  Scalar threshold_{0};         ///< ε². Set only if the rows are nearly singular.
  Scalar lost_{0};              ///< tr Δ/ε², about the number of lost directions.
  bool damps_ = false;          ///< Whether lost_ > 0.
  Scalar fade_{1};              ///< LostDirections::fade, or 0 if the null space of JC is not known.
};

}  // namespace fpbm
