#pragma once

#include <utility>

#include "fpbm/core/types.hpp"
#include "fpbm/geometry/space.hpp"
#include "fpbm/scheme/detail/dense_weights.hpp"
#include "fpbm/scheme/detail/solve_law.hpp"
#include "fpbm/scheme/detail/weighted_law.hpp"
#include "fpbm/scheme/weights.hpp"
#include "fpbm/task/detail/feedback.hpp"

namespace fpbm {

/// Least torque τ = M q̈ + h among the accelerations with J qdd = b, in balance with a scheme of least velocity
/// (docs/equations.md, Schemes with dynamics):
///
///   qdd = (1−α) MTN + α WMVN,   MTN = J_W⁺b + N_W (z − M⁻¹h) with W = M²,   b as in (13).
///
/// MTN minimises |τ|² in each state if z = 0 (Hollerbach and Suh 1987), and is unstable on long motions without
/// null-space damping. WMVN is (9) with the constant weights of the scheme.
///
/// Model_: Dynamics, or a class with its functions robot(), mass_matrix(), bias() and dof().
template <typename Model_, typename Weights = UnitWeights>
struct MinimumTorqueScheme {
  using Model = Model_;
  using Scalar = typename Model::Scalar;
  static constexpr Level kLevel = Level::kAcceleration;
  static constexpr int kDof = Model::kDof;
  using JointVector = Vector<kDof, Scalar>;

  Model model;                         ///< Dynamics of the robot that the scheme moves.
  Scalar alpha;                        ///< Balance in [0, 1]: weight of WMVN (9). MTN has the weight 1 − α.
  Weights weights;                     ///< W of WMVN.
  Scalar k1;                           ///< Velocity feedback gain [1/s].
  Scalar k2;                           ///< Position feedback gain [1/s²].
  NullSpace<kDof, Scalar> null_space;  ///< Secondary acceleration z of both parts.
  SingularDamping<Scalar> singular;    ///< Damping near singular postures, or none.

  /// Throws std::invalid_argument if alpha is not in [0, 1], a gain is negative or not finite, or a joint moves no
  /// mass.
  MinimumTorqueScheme(const Model& model_, Scalar alpha_, const Weights& weights_, Scalar k1_, Scalar k2_,
                      const NullSpace<kDof, Scalar>& null_space_ = {},
                      const SingularDamping<Scalar>& singular_ = SingularDamping<Scalar>::off())
      : model(model_),
        alpha(alpha_),
        weights(weights_),
        k1(k1_),
        k2(k2_),
        null_space(null_space_),
        singular(singular_) {
    validation::require_fraction("alpha", alpha);
    validation::require_non_negative("k1", k1);
    validation::require_non_negative("k2", k2);
    require_mass_matrix(model);
  }

  /// Throws std::invalid_argument if a parameter is for another number of joints.
  void require_dof(Eigen::Index dof) const {
    validation::require_size("joints of MinimumTorqueScheme::model", model.dof(), dof);
    weights.require_dof(dof);
    null_space.require_dof(dof);
  }

  /// Gravity moves the arm in the null space.
  [[nodiscard]] static bool moves_at_rest() noexcept { return true; }

  /// Joint accelerations qdd [rad/s²]. If the status is a failure, qdd does not change.
  template <typename Space>
  [[nodiscard]] Status resolve(const Kinematics<Space, kDof, Scalar>& kinematics,
                               const Reference<Space, Scalar>& reference, const State<kDof, Scalar>& state,
                               JointVector& qdd) const noexcept {
    const auto b = commanded_acceleration(k1, k2, kinematics, reference, state);
    const TaskEquation<Space::kRows, kDof, Scalar> task{kinematics.J, kinematics.Jd, b, reference.xd};
    return balanced<kScaledRows<Space, kDof>>(task, scale_of_rows(kinematics), state, qdd);
  }

  /// Joint accelerations of a task whose rows are all in metres: the law without feedback.
  template <int M>
  [[nodiscard]] Status resolve_rows(const TaskEquation<M, kDof, Scalar>& task, const State<kDof, Scalar>& state,
                                    JointVector& qdd) const noexcept {
    return balanced<kScaledRows<Position<M>, kDof>>(task, Scalar(1), state, qdd);
  }

 private:
  template <int kTurns, int M>
  [[nodiscard]] Status balanced(const TaskEquation<M, kDof, Scalar>& task, const Scalar& length,
                                const State<kDof, Scalar>& state, JointVector& qdd) const noexcept {
    using Velocity = WeightedLaw<kLevel, true, kDof, Scalar, Weights>;
    if (alpha == Scalar(0)) return least_torque<kTurns>(task, length, state, qdd);
    const Velocity law{weights, null_space, singular};
    if (alpha == Scalar(1)) return solve_law<kTurns>(law, task, length, state, qdd);
    JointVector torque = filled<JointVector>(state.q.size());
    JointVector velocity = torque;
    const Status status =
        worse(least_torque<kTurns>(task, length, state, torque), solve_law<kTurns>(law, task, length, state, velocity));
    if (!failed(status)) {
      qdd = entrywise(
          torque, [&](Eigen::Index i) { return (Scalar(1) - alpha) * torque.coeff(i) + alpha * velocity.coeff(i); });
    }
    return status;
  }

  /// MTN.
  template <int kTurns, int M>
  [[nodiscard]] Status least_torque(const TaskEquation<M, kDof, Scalar>& task, const Scalar& length,
                                    const State<kDof, Scalar>& state, JointVector& qdd) const noexcept {
    typename Model::State joints;
    model.robot().update(state.q, state.qd, joints);
    const auto mass = model.mass_matrix(joints);
    Cholesky<kDof, Scalar> cholesky;
    if (const Status status = cholesky.factor(mass); failed(status)) return status;
    const auto squared = DenseWeights<kDof, Scalar>::of_square(mass, cholesky);
    const JointVector free = cholesky.solve(model.bias(joints));
    const auto z = null_space.plus(entrywise(free, [&](Eigen::Index i) { return -free.coeff(i); }));
    const WeightedLaw<kLevel, false, kDof, Scalar, DenseWeights<kDof, Scalar>> law{squared, z, singular};
    return solve_law<kTurns>(law, task, length, state, qdd);
  }
};

}  // namespace fpbm
