#pragma once

#include <type_traits>

#include "fpbm/core/detail/unrolled.hpp"
#include "fpbm/linalg/detail/product.hpp"
#include "fpbm/linalg/detail/self_motion.hpp"
#include "fpbm/linalg/detail/total.hpp"
#include "fpbm/scheme/detail/task_equation.hpp"

namespace fpbm {

/// Solver of a law (solve_law.hpp) for degree of redundancy 1 (docs/equations.md, which has the proof). An arm with
/// n = m + 1 has one self-motion v, J v = 0. Every solution of J u = b is u = p + γ v, where p is any solution. A joint
/// motion is therefore represented by its γ. p is computed from J and not from JJᵀ, so that the condition number of JJᵀ
/// has no effect.
template <int M, int N, typename Scalar, typename Weights, typename Value>
class SelfMotionSolver {
 public:
  /// y: p, or pairs of p and of a solution r of J r = xd. Without r, the drift is zero. All arguments must outlive the
  /// solver: a compiler keeps them in registers, but stores members in memory.
  [[gnu::always_inline]] SelfMotionSolver(const SelfMotion<M, N, Scalar>& motion, const Weights& weights,
                                          const Matrix<M, N, Scalar>& Jd, const Vector<N, Value>& y,
                                          const Vector<N, Scalar>& v, const Vector<N, Scalar>& Wv) noexcept
      : motion_(motion), weights_(weights), Jd_(Jd), y_(y), v_(v), Wv_(Wv) {
    const auto both = [&](Eigen::Index i) { return Pair<Scalar>(v.coeff(i), Wv.coeff(i)); };
    const auto squares =
        total<0, N>([&](Eigen::Index i) { return both(i) * Pair<Scalar>(v.coeff(i)); });  // vᵀv and vᵀWv.
    along_ = total<0, N>([&](Eigen::Index i) { return both(i) * Pair<Scalar>(first(y.coeff(i))); });
    over_ = Pair<Scalar>(Scalar(1)) / squares;
  }

  /// J_W⁺b = p − (vᵀWp/vᵀWv) v.
  [[nodiscard, gnu::always_inline]] Scalar weighted() const noexcept { return -along_.second() * over_.second(); }
  /// (1−α) J⁺b + α J_W⁺b, with J⁺b = p − (vᵀp/vᵀv) v.
  [[nodiscard, gnu::always_inline]] Scalar balanced(const Scalar& alpha) const noexcept {
    return alpha * weighted() - (Scalar(1) - alpha) * along_.first() * over_.first();
  }

  /// vᵀW y of the joint motion y = α W⁻¹Jdᵀμ, which is α vᵀJdᵀμ = α sᵀg with J s = Jd v and g = Jᵀμ = W J_W⁺xd.
  [[nodiscard, gnu::always_inline]] Scalar drift([[maybe_unused]] const Scalar& alpha) const noexcept {
    if constexpr (!kHasDrift) {
      return Scalar(0);
    } else {
      const Scalar rho =
          over_.second() * total<0, N>([&](Eigen::Index i) { return Wv_.coeff(i) * y_.coeff(i).second(); });
      Vector<N, Scalar> rate;  // J_W⁺xd = r − ρ v
      each(Constant<0>{}, Constant<N>{},
           [&](Eigen::Index i) { rate.coeffRef(i) = y_.coeff(i).second() - rho * v_.coeff(i); });
      return alpha * motion_.along(product(Jd_, v_), weights_.times(rate));
    }
  }

  /// N_W (y + z) = (vᵀW(y + z)/vᵀWv) v.
  template <typename Z>
  [[nodiscard, gnu::always_inline]] Scalar project(Scalar drift, const Z& z) const noexcept {
    if (z.active()) {
      const Vector<N, Scalar> value = z.value();
      drift += total<0, N>([&](Eigen::Index i) { return Wv_.coeff(i) * value.coeff(i); });
    }
    return drift * over_.second();
  }
  template <typename Z>
  [[nodiscard, gnu::always_inline]] Scalar project(const Z& z) const noexcept {
    return project(Scalar(0), z);
  }

  /// u = p + γ v.
  [[gnu::always_inline]] void set(Vector<N, Scalar>& u, const Scalar& gamma) const noexcept {
    each(Constant<0>{}, Constant<N>{},
         [&](Eigen::Index i) { u.coeffRef(i) = first(y_.coeff(i)) + gamma * v_.coeff(i); });
  }

 private:
  static constexpr bool kHasDrift = !std::is_same_v<Value, Scalar>;

  const SelfMotion<M, N, Scalar>& motion_;
  const Weights& weights_;
  const Matrix<M, N, Scalar>& Jd_;
  const Vector<N, Value>& y_;
  const Vector<N, Scalar>& v_;
  const Vector<N, Scalar>& Wv_;
  Pair<Scalar> along_;  ///< vᵀp and vᵀWp.
  Pair<Scalar> over_;   ///< 1/vᵀv and 1/vᵀWv.
};

}  // namespace fpbm
