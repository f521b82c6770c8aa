#pragma once

#include "fpbm/core/types.hpp"
#include "fpbm/geometry/space.hpp"
#include "fpbm/objective/null_space.hpp"
#include "fpbm/scheme/detail/solve_law.hpp"
#include "fpbm/scheme/weights.hpp"
#include "fpbm/singular/damping.hpp"
#include "fpbm/task/detail/feedback.hpp"

namespace fpbm {

/// All acceleration-level schemes of the paper, (5), (8), (9), (13) and (16), are this law (docs/equations.md, Unified
/// law):
///
///   qdd = (1−α) J⁺b + α J_W⁺b + N_W (α W⁻¹Jdᵀμ + z),   μ = (JW⁻¹Jᵀ)⁻¹xd,
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
  template <typename Space>
  [[nodiscard]] Status resolve(const Kinematics<Space, N, Scalar>& kinematics,
                               const Reference<Space, Scalar>& reference, const State<N, Scalar>& state,
                               Vector<N, Scalar>& qdd) const noexcept {
    const auto b = commanded_acceleration(k1, k2, kinematics, reference, state);
    const TaskEquation<Space::kRows, N, Scalar> task{kinematics.J, kinematics.Jd, b, reference.xd};
    return solve_law<kScaledRows<Space, N>>(*this, task, scale_of_rows(kinematics), state, qdd);
  }

  /// Joint accelerations of a task whose rows are all in metres: the law without feedback.
  template <int M>
  [[nodiscard]] Status resolve_rows(const TaskEquation<M, N, Scalar>& task, const State<N, Scalar>& state,
                                    Vector<N, Scalar>& qdd) const noexcept {
    return solve_law<kScaledRows<Position<M>, N>>(*this, task, Scalar(1), state, qdd);
  }

  /// The law, in terms of a solver of the task (scheme/detail/solve_law.hpp):
  /// balanced(α) = (1−α) J⁺b + α J_W⁺b, drift(α) = α W⁻¹Jdᵀμ, project(u, z) = N_W (u + z).
  template <typename Solver, typename Z>
  [[nodiscard, gnu::always_inline]] auto law(const Solver& solver, const Z& z) const noexcept {
    return solver.balanced(alpha) + solver.project(solver.drift(alpha), z);
  }
};

}  // namespace fpbm
