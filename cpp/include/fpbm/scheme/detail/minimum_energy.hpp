#pragma once

#include "fpbm/core/types.hpp"
#include "fpbm/geometry/space.hpp"
#include "fpbm/scheme/detail/dense_weights.hpp"
#include "fpbm/scheme/detail/solve_law.hpp"
#include "fpbm/scheme/detail/weighted_law.hpp"
#include "fpbm/task/detail/feedback.hpp"

namespace fpbm {

/// Least kinetic energy ½ qdᵀM qd among the velocities with J qd = v (Whitney 1969; docs/equations.md, Schemes with
/// dynamics):
///
///   qd = J_M⁺v + N_M z,   v = xd + k (x ⊖ f(q)).
///
/// Of velocity level, since the kinetic energy is a function of the velocities. Model_: see MinimumTorqueScheme; bias()
/// is not called.
template <typename Model_>
struct MinimumEnergyScheme {
  using Model = Model_;
  using Scalar = typename Model::Scalar;
  static constexpr Level kLevel = Level::kVelocity;
  static constexpr int kDof = Model::kDof;
  using JointVector = Vector<kDof, Scalar>;

  Model model;                         ///< Dynamics of the robot that the scheme moves.
  Scalar k;                            ///< Position feedback gain [1/s].
  NullSpace<kDof, Scalar> null_space;  ///< Secondary velocity z.
  SingularDamping<Scalar> singular;    ///< Damping near singular postures, or none.

  /// Throws std::invalid_argument if k is negative or not finite, or a joint moves no mass.
  explicit MinimumEnergyScheme(const Model& model_, Scalar k_ = Scalar(0),
                               const NullSpace<kDof, Scalar>& null_space_ = {},
                               const SingularDamping<Scalar>& singular_ = SingularDamping<Scalar>::off())
      : model(model_), k(k_), null_space(null_space_), singular(singular_) {
    validation::require_non_negative("k", k);
    require_mass_matrix(model);
  }

  /// Throws std::invalid_argument if a parameter is for another number of joints.
  void require_dof(Eigen::Index dof) const {
    validation::require_size("joints of MinimumEnergyScheme::model", model.dof(), dof);
    null_space.require_dof(dof);
  }

  /// Joint velocities qd [rad/s]. If the status is a failure, qd does not change.
  template <typename Space>
  [[nodiscard]] Status resolve(const Kinematics<Space, kDof, Scalar>& kinematics,
                               const Reference<Space, Scalar>& reference, const State<kDof, Scalar>& state,
                               JointVector& qd) const noexcept {
    const auto v = commanded_velocity(k, kinematics, reference);
    const TaskEquation<Space::kRows, kDof, Scalar> task{kinematics.J, kinematics.Jd, v, v};
    return least_energy<kScaledRows<Space, kDof>>(task, scale_of_rows(kinematics), state, qd);
  }

  /// Joint velocities of a task whose rows are all in metres: the law without feedback.
  template <int M>
  [[nodiscard]] Status resolve_rows(const TaskEquation<M, kDof, Scalar>& task, const State<kDof, Scalar>& state,
                                    JointVector& qd) const noexcept {
    return least_energy<kScaledRows<Position<M>, kDof>>(task, Scalar(1), state, qd);
  }

 private:
  template <int kTurns, int M>
  [[nodiscard]] Status least_energy(const TaskEquation<M, kDof, Scalar>& task, const Scalar& length,
                                    const State<kDof, Scalar>& state, JointVector& qd) const noexcept {
    typename Model::State joints;
    model.robot().update(state.q, joints);
    const auto mass = model.mass_matrix(joints);
    Cholesky<kDof, Scalar> cholesky;
    if (const Status status = cholesky.factor(mass); failed(status)) return status;
    const auto weights = DenseWeights<kDof, Scalar>::of(mass, cholesky);
    const WeightedLaw<kLevel, false, kDof, Scalar, DenseWeights<kDof, Scalar>> law{weights, null_space, singular};
    return solve_law<kTurns>(law, task, length, state, qd);
  }
};

}  // namespace fpbm
