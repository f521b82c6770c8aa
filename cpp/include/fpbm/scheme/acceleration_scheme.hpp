#pragma once

#include <type_traits>
#include <utility>

#include "fpbm/core/types.hpp"
#include "fpbm/geometry/space.hpp"
#include "fpbm/linalg/detail/product.hpp"
#include "fpbm/linalg/detail/sums.hpp"
#include "fpbm/objective/null_space.hpp"
#include "fpbm/scheme/detail/least_norm.hpp"
#include "fpbm/scheme/weights.hpp"
#include "fpbm/singular/damping.hpp"
#include "fpbm/task/detail/feedback.hpp"

namespace fpbm {

/// All acceleration-level schemes of the paper, (5), (8), (9), (13) and (16), are this law (docs/equations.md, Unified
/// law):
///
///   qdd = (1−α) J⁺b + α (J_W⁺b + N_W W⁻¹Jdᵀμ) + N_W z,   μ = (JW⁻¹Jᵀ)⁻¹xd,
///   b = xdd − Jd qd + k₁ (xd − J qd) + k₂ (x ⊖ f(q)).
///
/// With k₁, k₂ > 0, the tip error e obeys ë + k₁ė + k₂e = 0 for all α and W. MAN(), WMVNAcceleration(), Balanced() and
/// FPBM() in scheme/schemes.hpp return the schemes of the paper.
template <int N, typename Scalar = double, typename Weights = DiagonalWeights<N, Scalar>>
struct AccelerationScheme {
  static constexpr Level kLevel = Level::kAcceleration;
  static constexpr int kDof = N;

  Scalar alpha;  ///< Balance in [0, 1]: weight of WMVN (9). MAN (8) has the weight 1 − α.
  Weights weights;
  Scalar k1;                         ///< Velocity feedback gain [1/s].
  Scalar k2;                         ///< Position feedback gain [1/s²].
  NullSpace<N, Scalar> null_space;   ///< Secondary acceleration z.
  SingularDamping<Scalar> singular;  ///< Damping near singular postures, or none.

  /// Throws std::invalid_argument if alpha is not in [0, 1], or a gain is negative or not finite.
  AccelerationScheme(Scalar alpha_, const Weights& weights_, Scalar k1_, Scalar k2_,
                     const NullSpace<N, Scalar>& null_space_ = {},
                     const SingularDamping<Scalar>& singular_ = SingularDamping<Scalar>::off())
      : alpha(alpha_), weights(weights_), k1(k1_), k2(k2_), null_space(null_space_), singular(singular_) {
    validation::require_fraction("alpha", alpha);
    validation::require_non_negative("k1", k1);
    validation::require_non_negative("k2", k2);
  }

  /// Throws std::invalid_argument if a parameter is for another number of joints.
  void require_dof(Eigen::Index dof) const {
    weights.require_dof(dof);
    null_space.require_dof(dof);
  }

  /// Joint accelerations qdd [rad/s²] that give the tip its reference acceleration, corrected by the feedback. If the
  /// status is a failure, qdd does not change.
  /// sigma, unless null, is set to the lower bound 1/√tr((JJᵀ)⁻¹) on σ_min(J), if the factorisation for qdd provides
  /// this bound.
  template <typename Space>
  [[nodiscard]] Status resolve(const Kinematics<Space, N, Scalar>& kinematics,
                               const Reference<Space, Scalar>& reference, const State<N, Scalar>& state,
                               Vector<N, Scalar>& qdd, Scalar* sigma = nullptr) const noexcept {
    const auto b = commanded_acceleration(k1, k2, kinematics, reference, state);
    return solve<kScaledRows<Space, N>>(b, kinematics.J, kinematics.Jd, reference.xd, scale_of_rows(kinematics), state,
                                        qdd, sigma);
  }

  /// Joint accelerations with J qdd = b for any rows, all in metres: the law without feedback. J̇ qd is already
  /// subtracted from b.
  template <int M>
  [[nodiscard]] Status resolve_rows(const Vector<M, Scalar>& b, const Vector<M, Scalar>& xd,
                                    const Matrix<M, N, Scalar>& J, const Matrix<M, N, Scalar>& Jd,
                                    const State<N, Scalar>& state, Vector<N, Scalar>& qdd,
                                    Scalar* sigma = nullptr) const noexcept {
    return solve<kScaledRows<Position<M>, N>>(b, J, Jd, xd, Scalar(1), state, qdd, sigma);
  }

 private:
  /// resolve() for a commanded b. Instantiated once for each number of rows and of angular rows, not for each task
  /// space.
  template <int kTurns, int M>
  [[nodiscard]] Status solve(const Vector<M, Scalar>& b, const Matrix<M, N, Scalar>& J, const Matrix<M, N, Scalar>& Jd,
                             const Vector<M, Scalar>& xd, const Scalar& length, const State<N, Scalar>& state,
                             Vector<N, Scalar>& qdd, Scalar* sigma) const noexcept {
    if constexpr (kHasSelfMotion<M, N>) {
      auto undamped = undamped_result<kTurns>(
          singular, J, length,
          [&](const auto& motion, Vector<N, Scalar>& u) noexcept {
            if constexpr (!kInLanes<Scalar>) {
              if (alpha == Scalar(0)) {
                return with_one_self_motion<kLevel>(motion, weights, alpha, b, Jd, null_space, state, u);
              }
            }
            const Vector<M, Pair<Scalar>> rhs = side_by_side<M, 1, Scalar>(b, xd);
            return with_one_self_motion<kLevel>(motion, weights, alpha, rhs, Jd, null_space, state, u);
          },
          sigma);
      if (all_of(undamped.regular)) {
        qdd = std::move(undamped.u);
        return Status::kOk;
      }
      return solve_by_factorisation<kTurns>(b, J, Jd, xd, length, state, undamped, qdd, sigma);
    } else {
      return solve_by_factorisation<kTurns>(b, J, Jd, xd, length, state, NoUndampedResult{}, qdd, sigma);
    }
  }

  /// solve() by factorisation of the rows of J, or of JC with C Cᵀ = W⁻¹, or of both (docs/equations.md, Other degrees
  /// of redundancy). Near singular postures, the damped Gram matrices of these rows are factorised (DampedGram). The
  /// law determines which factorisations are necessary:
  ///
  ///   UnitWeights                                  J, since J_W⁺ = J⁺
  ///   α = 0, and W = I or no secondary motion z    J, since qdd = J⁺b + N_W z with W = I or z = 0
  ///   α = 1                                        JC
  ///   otherwise, and always with lanes             J and JC (solve_pair)
  template <int kTurns, int M, typename Known>
  [[nodiscard]] Status solve_by_factorisation(const Vector<M, Scalar>& b, const Matrix<M, N, Scalar>& J,
                                              const Matrix<M, N, Scalar>& Jd, const Vector<M, Scalar>& xd,
                                              const Scalar& length, const State<N, Scalar>& state,
                                              const Known& undamped, Vector<N, Scalar>& qdd,
                                              Scalar* sigma) const noexcept {
    constexpr bool kUnit = std::is_same_v<Weights, UnitWeights>;
    if constexpr (kInLanes<Scalar>) {  // Each lane may have its own alpha.
      return solve_pair<kTurns>(b, J, Jd, xd, length, state, undamped, qdd, sigma);
    } else {
      if constexpr (kUnit) {
        // With one self-motion, solve_by_factorisation() is called only near singular postures, and one instantiation
        // for all alpha is sufficient.
        if constexpr (!kHasSelfMotion<M, N>) {
          if (alpha == Scalar(0)) return unweighted<kTurns>(b, J, length, state, undamped, qdd, sigma);
        }
      } else if (alpha == Scalar(0) && (weights.is_unit() || !null_space.template active<kLevel>())) {
        Vector<N, Scalar> result;
        const Status status = unweighted<kTurns>(b, J, length, state, undamped, result, sigma);
        // Near a singular posture, the brake adds −brake qd to z, which N_W must project: continue with both
        // factorisations.
        if (status != Status::kDamped || weights.is_unit() || singular.brake() == Scalar(0)) {
          if (!failed(status)) qdd = std::move(result);
          return status;
        }
      }
      if constexpr (!kUnit) {
        if (alpha != Scalar(1)) return solve_pair<kTurns>(b, J, Jd, xd, length, state, undamped, qdd, sigma);
      }
      const auto force = [&](const auto& solutions) noexcept -> Vector<N, Scalar> {
        const Vector<N, Scalar> whole = transpose_times(Jd, solutions.force(solutions.coefficients(xd)));
        return entrywise(whole, [&](Eigen::Index i) { return alpha * whole.coeff(i); });
      };
      return least_norm<kLevel, kTurns>(weights, b, force, null_space, singular, J, length, state, undamped, qdd,
                                        sigma);
    }
  }

  /// The law with α = 0 and W = I, which needs one factorisation.
  template <int kTurns, int M, typename Known>
  [[nodiscard]] Status unweighted(const Vector<M, Scalar>& b, const Matrix<M, N, Scalar>& J, const Scalar& length,
                                  const State<N, Scalar>& state, const Known& undamped, Vector<N, Scalar>& qdd,
                                  Scalar* sigma) const noexcept {
    return least_norm<kLevel, kTurns>(UnitWeights{}, b, NoForce{}, null_space, singular, J, length, state, undamped,
                                      qdd, sigma);
  }

  /// The law with two factorisations in parallel, of J and of JC with C Cᵀ = W⁻¹ (docs/equations.md, Other degrees of
  /// redundancy):
  ///
  ///   qdd = (1−α) J⁺b + C [α (JC)⁺b + (I − (JC)⁺JC) y],   y = α CᵀJdᵀμ + C⁻¹z,   μ = (JW⁻¹Jᵀ)⁻¹xd.
  template <int kTurns, int M, typename Known>
  [[nodiscard, gnu::flatten]] Status solve_pair(const Vector<M, Scalar>& b, const Matrix<M, N, Scalar>& J,
                                                const Matrix<M, N, Scalar>& Jd, const Vector<M, Scalar>& xd,
                                                const Scalar& length, const State<N, Scalar>& state,
                                                const Known& undamped, Vector<N, Scalar>& qdd,
                                                Scalar* sigma) const noexcept {
    DampedGram<M, N, Pair<Scalar>, kTurns> gram(singular, J, length);  // J and JC.
    const Matrix<N, M, Pair<Scalar>> rows = weights.with_unit(J);      // Jᵀ and (JC)ᵀ.
    const Status status = gram.factor(rows, Scalar(1), sigma);
    if (undamped.take_if_undamped(gram, qdd)) return Status::kOk;
    if (failed(status)) return status;

    Vector<N, Scalar> result = gram.solved([&](const auto& solutions) noexcept -> Vector<N, Scalar> {
      const Vector<M, Scalar> mu =
          second<M, 1, Scalar>(solutions.force(solutions.coefficients(side_by_side<M, 1, Scalar>(xd, xd))));
      const Vector<N, Scalar> whole = transpose_times(Jd, mu);
      const Vector<N, Scalar> force = entrywise(whole, [&](Eigen::Index i) { return alpha * whole.coeff(i); });
      Vector<N, Scalar> y = weights.root_transpose(force);  // α CᵀJdᵀμ, the first term of y.
      constexpr bool kDamped = std::decay_t<decltype(solutions)>::kIsDamped;
      if (kDamped || null_space.template active<kLevel>()) {
        const Vector<N, Scalar> z = kDamped ? null_space.template velocity_part<kLevel>(state, gram.brake())
                                            : null_space.template at<kLevel>(state);
        y = sum_of(y, weights.inverse_root(z));
      }
      const Vector<M, Scalar> even = entrywise(b, [&](Eigen::Index i) { return (Scalar(1) - alpha) * b.coeff(i); });
      const Vector<M, Scalar> weighted = entrywise(b, [&](Eigen::Index i) { return alpha * b.coeff(i); });
      const Vector<N, Pair<Scalar>> parts =
          solutions.motion(solutions.coefficients(side_by_side<M, 1, Scalar>(even, weighted)));
      y = second<N, 1, Scalar>(solutions.project(side_by_side<N, 1, Scalar>(y, y)));
      if constexpr (kDamped) {
        if (null_space.template active<Level::kVelocity>()) {
          const Vector<N, Scalar> z = weights.inverse_root(null_space.position_part(state));
          y = sum_of(y, second<N, 1, Scalar>(solutions.secondary(side_by_side<N, 1, Scalar>(z, z), b)));
        }
      }
      y = entrywise(y, [&](Eigen::Index i) { return y.coeff(i) + parts.coeff(i).second(); });
      return plus_first<N, Scalar>(weights.root(y), parts);
    });
    undamped.set_undamped_lanes(result);
    if (!is_finite(result)) return Status::kNotFinite;
    qdd = std::move(result);
    return status;
  }
};

}  // namespace fpbm
