#pragma once

#include <algorithm>
#include <cmath>

#include "fpbm/core/detail/unrolled.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/inverse/detail/search_error.hpp"
#include "fpbm/linalg/detail/cholesky.hpp"
#include "fpbm/linalg/detail/entrywise.hpp"
#include "fpbm/linalg/detail/total.hpp"
#include "fpbm/model/kinematics.hpp"

namespace fpbm {

/// Search of postures that bring the tip of an arm to a target: errors, and steps of Levenberg and Marquardt
/// (docs/inverse.md, The search). Scalar: one posture, or one posture for each lane.
template <typename Arm, typename Space_>
class TipSearch {
 public:
  using Scalar = typename Arm::Scalar;
  using Space = Space_;
  static constexpr int N = Arm::kDof;
  static constexpr int kRows = Space::kRows;
  static constexpr bool kHasRest = false;
  using JointVector = Vector<N, Scalar>;
  using Point = typename Space::template Point<Scalar>;

  /// A posture with its rows and its error. The angular rows are multiplied by kAngle characteristic lengths.
  struct Trial {
    JointVector q;
    Matrix<kRows, N, Scalar> J;
    Vector<kRows, Scalar> e;
    Scalar cost;  ///< |e|² [m²].
  };

  /// length: characteristic length [m]. tolerance: largest distance [m] and angle [rad] from the target.
  TipSearch(const Arm& arm, const Scalar& length, const JointVector& lower, const JointVector& upper,
            const Point& target, const Scalar& tolerance) noexcept
      : arm_(arm), lower_(lower), upper_(upper), target_(target), length_(length), unit_(Scalar(kAngle) * length) {
    using std::min;
    const Scalar least = min(Scalar(1), unit_);
    enough_ = tolerance * tolerance * least * least;
  }

  /// Characteristic length [m].
  [[nodiscard]] const Scalar& length() const noexcept { return length_; }

  /// Sets the rows and the error of trial.q.
  void evaluate(Trial& trial) const noexcept {
    Kinematics<Space, N, Scalar> kinematics;
    arm_.kinematics(trial.q, kinematics);
    trial.e = error(kinematics);
    trial.cost = squared(trial.e);
    trial.J = kinematics.J;
    each(kFirst, columns(),
         [&](Eigen::Index j) { each(kLinear, kLast, [&](auto i) { trial.J.coeffRef(i, j) *= unit_; }); });
  }

  /// |e|² of a posture.
  [[nodiscard]] Scalar cost(const JointVector& q) const noexcept {
    Kinematics<Space, N, Scalar> kinematics;
    points_of(arm_, q, kinematics, 0);
    return squared(error(kinematics));
  }

  /// Where the tip is at the target.
  [[nodiscard]] Mask<Scalar> reached(const Trial& trial) const noexcept { return trial.cost <= enough_; }
  /// Largest distance [m] or angle [rad] from the target.
  [[nodiscard]] static Scalar largest_error(const Kinematics<Space, N, Scalar>& kinematics,
                                            const Point& target) noexcept {
    return larger_part<Space, Scalar>(Space::template difference<Scalar>(target, kinematics.tip));
  }

  /// Where the trial is better than `now`.
  [[nodiscard]] static Mask<Scalar> better(const Trial& trial, const Trial& now) noexcept {
    return trial.cost < now.cost;
  }

  /// now = trial in the lanes of the mask.
  static void take(const Mask<Scalar>& lanes, const Trial& trial, Trial& now) noexcept {
    const auto chosen = [&](const auto& from, const auto& to) noexcept {
      return entrywise(from, [&](Eigen::Index i) { return select(lanes, from.coeff(i), to.coeff(i)); });
    };
    now.q = chosen(trial.q, now.q);
    now.J = chosen(trial.J, now.J);
    now.e = chosen(trial.e, now.e);
    now.cost = select(lanes, trial.cost, now.cost);
  }

  /// Posture after a step from `now`:
  ///
  ///   Δq = Gᵀ(G Gᵀ + λ |e|² I)⁻¹ e,
  ///
  /// shortened to kLongest, within the ranges. G is J without the columns of joints on an end of their range that the
  /// gradient Jᵀe moves outward.
  [[nodiscard]] JointVector step(const Trial& now, const Scalar& lambda) const noexcept {
    using std::abs;
    using std::max;
    using std::min;
    Matrix<kRows, N, Scalar> G = now.J;
    each(kFirst, columns(), [&](Eigen::Index j) {
      const Scalar outward = column_times(G, j, now.e);
      const Mask<Scalar> held = (now.q.coeff(j) >= upper_.coeff(j) && outward > Scalar(0)) ||
                                (now.q.coeff(j) <= lower_.coeff(j) && outward < Scalar(0));
      const Scalar free = select(held, Scalar(0), Scalar(1));
      each(kFirst, kLast, [&](auto i) { G.coeffRef(i, j) *= free; });
    });
    const Scalar damping = lambda * now.cost + Scalar(kRegular) * unit_ * unit_;
    Matrix<kRows, kRows, Scalar> A;
    each(kFirst, kLast, [&](auto i) {
      each(kFirst, next(i), [&](Eigen::Index k) {
        Scalar sum(0);
        each(kFirst, columns(), [&](Eigen::Index j) { sum += G.coeff(i, j) * G.coeff(k, j); });
        A.coeffRef(i, k) = sum;
      });
      A.coeffRef(i, i) += damping;
    });
    Cholesky<kRows, Scalar> factor;
    (void)factor.factor(A);
    const Vector<kRows, Scalar> y = factor.solve(now.e);
    constexpr auto kMost = static_cast<Number<Scalar>>(kLongest);
    Scalar longest(kMost);
    const JointVector step = entrywise(now.q, [&](Eigen::Index j) {
      const Scalar entry = column_times(G, j, y);
      longest = max(longest, Scalar(abs(entry)));
      return entry;
    });
    const Scalar fraction = Scalar(kMost) / longest;
    return entrywise(step, [&](Eigen::Index j) {
      return min(max(Scalar(now.q.coeff(j) + fraction * step.coeff(j)), lower_.coeff(j)), upper_.coeff(j));
    });
  }

 private:
  static constexpr Constant<0> kFirst{};
  static constexpr Constant<kRows - Space::kTurns> kLinear{};  ///< First angular row.
  static constexpr Constant<kRows> kLast{};

  static constexpr double kAngle = 0.2;      ///< Range: 0.15 to 0.4, as for the values of Attempts.
  static constexpr double kLongest = 1.3;    ///< Longest step of a joint [rad or m]. Range: 0.8 to 2.
  static constexpr double kRegular = 1e-12;  ///< Least μ, so that the factorisation exists at every posture.

  [[nodiscard]] auto columns() const noexcept { return extent<N>(lower_.size()); }

  [[nodiscard]] Vector<kRows, Scalar> error(const Kinematics<Space, N, Scalar>& kinematics) const noexcept {
    Vector<kRows, Scalar> e = search_error<Space, Scalar>(target_, kinematics.tip);
    each(kLinear, kLast, [&](auto i) { e.coeffRef(i) *= unit_; });
    return e;
  }
  [[nodiscard]] static Scalar squared(const Vector<kRows, Scalar>& e) noexcept {
    return total<0, kRows>([&](Eigen::Index i) { return e.coeff(i) * e.coeff(i); });
  }
  [[nodiscard, gnu::always_inline]] static Scalar column_times(const Matrix<kRows, N, Scalar>& G, Eigen::Index j,
                                                               const Vector<kRows, Scalar>& y) noexcept {
    return total<0, kRows>([&](Eigen::Index i) { return G.coeff(i, j) * y.coeff(i); });
  }

  const Arm& arm_;
  JointVector lower_;
  JointVector upper_;
  Point target_;
  Scalar length_;
  Scalar unit_;    ///< Length by which angles are multiplied [m].
  Scalar enough_;  ///< Largest cost at the target [m²].
};

}  // namespace fpbm
