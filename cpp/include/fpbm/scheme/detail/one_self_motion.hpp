#pragma once

#include <cmath>
#include <type_traits>

#include "fpbm/core/detail/unrolled.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/linalg/detail/product.hpp"
#include "fpbm/linalg/detail/self_motion.hpp"
#include "fpbm/linalg/detail/sums.hpp"
#include "fpbm/linalg/detail/total.hpp"
#include "fpbm/objective/null_space.hpp"
#include "fpbm/singular/detail/damped_gram.hpp"

/// Laws for degree of redundancy 1 (docs/equations.md): an arm with n = m + 1 has one self-motion v, J v = 0. Every law
/// is then u = p + γ v, where p is any solution of J p = b. p is computed from J and not from JJᵀ, so that the
/// condition number of JJᵀ has no effect.
namespace fpbm {

/// Sets u to the law for degree of redundancy 1. p, r and s are any solutions of J p = b, J r = xd and J s = Jd v:
///
///   u = p + γ v,   γ = [α sᵀg + vᵀW(z − α p)] / vᵀWv − (1−α) vᵀp / vᵀv,
///   g = W(r − ρ v) = W J_W⁺xd,   ρ = vᵀWr / vᵀWv,   sᵀg = vᵀJdᵀμ, since Jᵀμ = g.
///
/// docs/equations.md (Degree of redundancy 1) has the proof. rhs has pairs (b, xd). If rhs is b alone, the law has no
/// drift W⁻¹Jdᵀμ, and α only balances J⁺b and J_W⁺b.
template <Level kLevel, int M, int N, typename Scalar, typename Weights, typename Value>
[[gnu::always_inline]] inline void with_one_self_motion(const SelfMotion<M, N, Scalar>& motion, const Weights& weights,
                                                        const Scalar& alpha, const Vector<M, Value>& rhs,
                                                        [[maybe_unused]] const Matrix<M, N, Scalar>& Jd,
                                                        const NullSpace<N, Scalar>& null_space,
                                                        const State<N, Scalar>& state, Vector<N, Scalar>& u) noexcept {
  const Vector<N, Scalar> v = motion.null();
  const Vector<N, Scalar> Wv = weights.times(v);
  const Vector<N, Value> y = motion.solve(rhs);
  const auto both = [&](Eigen::Index i) { return Pair<Scalar>(v.coeff(i), Wv.coeff(i)); };
  const auto squares =
      total<0, N>([&](Eigen::Index i) { return both(i) * Pair<Scalar>(v.coeff(i)); });  // vᵀv and vᵀWv.
  const auto along =
      total<0, N>([&](Eigen::Index i) { return both(i) * Pair<Scalar>(first(y.coeff(i))); });  // vᵀp and vᵀWp.
  const Pair<Scalar> over = Pair<Scalar>(Scalar(1)) / squares;
  Scalar numerator = -alpha * along.second();
  if (null_space.template active<kLevel>()) {
    const Vector<N, Scalar> z = null_space.template at<kLevel>(state);
    numerator += total<0, N>([&](Eigen::Index i) { return Wv.coeff(i) * z.coeff(i); });
  }
  if constexpr (!std::is_same_v<Value, Scalar>) {
    const Scalar rho = over.second() * total<0, N>([&](Eigen::Index i) { return Wv.coeff(i) * y.coeff(i).second(); });
    Vector<N, Scalar> rate;  // J_W⁺xd
    each(Constant<0>{}, Constant<N>{},
         [&](Eigen::Index i) { rate.coeffRef(i) = y.coeff(i).second() - rho * v.coeff(i); });
    numerator += alpha * motion.along(product(Jd, v), weights.times(rate));
  }
  const Scalar gamma = numerator * over.second() - (Scalar(1) - alpha) * along.first() * over.first();
  each(Constant<0>{}, Constant<N>{}, [&](Eigen::Index i) { u.coeffRef(i) = first(y.coeff(i)) + gamma * v.coeff(i); });
}

/// Replaces UndampedResult if the degree of redundancy is not 1: no result is known before the rows are factorised.
struct NoUndampedResult {
  template <typename Gram, typename Result>
  [[nodiscard]] static constexpr bool take_if_undamped(const Gram&, Result&) noexcept {
    return false;
  }
  template <typename Result>
  static void set_undamped_lanes(Result&) noexcept {}
};

/// Result of the law for degree of redundancy 1 without damping. The result is computed before it is known whether
/// damping acts. If damping does not act, the undamped result is returned in all cases, so that a scheme with damping
/// returns the same bits as a scheme without damping.
template <int N, typename Scalar>
struct UndampedResult {
  Mask<Scalar> answered{false};  ///< u is the result without damping.
  Mask<Scalar> regular{false};   ///< In addition, a bound on σ_min proves that damping does not act.
  Vector<N, Scalar> u;

  /// Whether u is the result, after `gram` has determined whether damping acts. If true, sets result to u.
  template <typename Gram>
  [[nodiscard]] bool take_if_undamped([[maybe_unused]] const Gram& gram,
                                      [[maybe_unused]] Vector<N, Scalar>& result) const noexcept {
    if constexpr (kInLanes<Scalar>) {
      return false;
    } else {
      if (!answered || gram.damps()) return false;
      result = u;
      return true;
    }
  }

  /// take_if_undamped() for each lane. result: solution with the Gram matrix, NaN in each lane in which damping may
  /// act.
  void set_undamped_lanes([[maybe_unused]] Vector<N, Scalar>& result) const noexcept {
    if constexpr (kInLanes<Scalar>) {
      const Mask<Scalar> holds = regular || (answered && !isnan(result(0)));
      for (int i = 0; i < N; ++i) where(holds, result(i)) = u(i);
    }
  }
};

/// Evaluates law(motion, u) with the first factorisation of J that is accurate, and determines by a bound on σ_min(J)
/// whether damping certainly does not act. The last kTurns rows of J are angular. length: characteristic length of the
/// arm [m]. sigma, unless null, is set to the lower bound 1/√tr((JJᵀ)⁻¹) on σ_min(J) if there is a result.
template <int kTurns, int M, int N, typename Scalar, typename Law>
[[nodiscard, gnu::always_inline]] inline UndampedResult<N, Scalar> undamped_result(
    const SingularDamping<Scalar>& damping, const Matrix<M, N, Scalar>& J, const Scalar& length, const Law& law,
    [[maybe_unused]] Scalar* sigma) noexcept {
  UndampedResult<N, Scalar> result;
  SelfMotion<M, N, Scalar> motion;
  const Mask<Scalar> undamped = damping.radius() == Scalar(0);
  for (int kind = 0; kind < motion.kKinds && !all_of(result.answered); ++kind) {
    Mask<Scalar> found = motion.factor(J, kind);
    if (none_of(found)) continue;
    Mask<Scalar> regular = undamped;
    if (!all_of(undamped)) {
      const Scalar threshold = damping.radius() * damping.radius() * squared_norm_in_metres<kTurns>(J, length);  // ε²
      regular = regular || threshold * motion.rough_inverse_square(length) <= Scalar(1);
      if (!all_of(regular)) regular = regular || threshold * motion.inverse_square(length) <= Scalar(1);
    }
    Vector<N, Scalar> lanes;
    Vector<N, Scalar>& u = kInLanes<Scalar> ? lanes : result.u;
    law(motion, u);
    if constexpr (kInLanes<Scalar>) {
      found = found && !result.answered;
      for (int i = 0; i < N; ++i) where(found, result.u(i)) = u(i);
      result.answered = result.answered || found;
      result.regular = result.regular || (found && regular);
    } else {
      if (!is_finite(u)) break;
      if (sigma != nullptr) *sigma = Scalar(1) / std::sqrt(motion.inverse_trace());
      result.answered = true;
      result.regular = regular;
    }
  }
  return result;
}

}  // namespace fpbm
