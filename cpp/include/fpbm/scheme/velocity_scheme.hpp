#pragma once

#include "fpbm/core/types.hpp"
#include "fpbm/geometry/space.hpp"
#include "fpbm/objective/null_space.hpp"
#include "fpbm/scheme/detail/solve_law.hpp"
#include "fpbm/scheme/weights.hpp"
#include "fpbm/singular/damping.hpp"
#include "fpbm/task/detail/feedback.hpp"

namespace fpbm {

/// All velocity-level schemes of the paper, (3), (6) and (7), are this law (docs/equations.md):
///
///   qd = J_W⁺v + N_W z,   v = xd + k (x ⊖ f(q)).
///
/// MVN() and WMVN() in scheme/schemes.hpp return the schemes of the paper.
template <int N, typename Scalar = double, typename Weights = DiagonalWeights<N, Scalar>>
struct VelocityScheme {
  static constexpr Level kLevel = Level::kVelocity;
  static constexpr int kDof = N;

  Weights weights;
  Scalar k;                          ///< Position feedback gain [1/s].
  NullSpace<N, Scalar> null_space;   ///< Secondary velocity z.
  SingularDamping<Scalar> singular;  ///< Damping near singular postures, or none.

  /// Throws std::invalid_argument if k is negative or not finite.
  explicit VelocityScheme(const Weights& weights_, Scalar k_ = Scalar(0), const NullSpace<N, Scalar>& null_space_ = {},
                          const SingularDamping<Scalar>& singular_ = SingularDamping<Scalar>::off())
      : weights(weights_), k(k_), null_space(null_space_), singular(singular_) {
    validation::require_non_negative("k", k);
  }

  /// Throws std::invalid_argument if a parameter is for another number of joints.
  void require_dof(Eigen::Index dof) const {
    weights.require_dof(dof);
    null_space.require_dof(dof);
  }

  /// Joint velocities qd [rad/s] that give the tip its reference velocity, corrected by the feedback. If the status is
  /// a failure, qd does not change.
  template <typename Space>
  [[nodiscard]] Status resolve(const Kinematics<Space, N, Scalar>& kinematics,
                               const Reference<Space, Scalar>& reference, const State<N, Scalar>& state,
                               Vector<N, Scalar>& qd) const noexcept {
    const auto v = commanded_velocity(k, kinematics, reference);
    const TaskEquation<Space::kRows, N, Scalar> task{kinematics.J, kinematics.Jd, v, v};
    return solve_law<kScaledRows<Space, N>>(*this, task, scale_of_rows(kinematics), state, qd);
  }

  /// Joint velocities of a task whose rows are all in metres: the law without feedback.
  template <int M>
  [[nodiscard]] Status resolve_rows(const TaskEquation<M, N, Scalar>& task, const State<N, Scalar>& state,
                                    Vector<N, Scalar>& qd) const noexcept {
    return solve_law<kScaledRows<Position<M>, N>>(*this, task, Scalar(1), state, qd);
  }

  /// The law, in terms of a solver of the task (scheme/detail/solve_law.hpp): weighted() = J_W⁺v, project(z) = N_W z.
  template <typename Solver, typename Z>
  [[nodiscard, gnu::always_inline]] auto law(const Solver& solver, const Z& z) const noexcept {
    return solver.weighted() + solver.project(z);
  }
};

}  // namespace fpbm
