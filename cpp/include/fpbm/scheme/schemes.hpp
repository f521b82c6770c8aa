#pragma once

#include <type_traits>

#include "fpbm/scheme/acceleration_scheme.hpp"
#include "fpbm/scheme/detail/dense_weights.hpp"
#include "fpbm/scheme/detail/minimum_energy.hpp"
#include "fpbm/scheme/detail/minimum_torque.hpp"
#include "fpbm/scheme/velocity_scheme.hpp"

/// Schemes of the paper by name, with equation numbers of the paper (docs/equations.md): FPBM<7>(0.6, weights, 10, 25).
///
/// MinimumTorque(), BalancedTorque() and MinimumEnergy() are beside the paper, and need the Dynamics of the robot.
///
/// weights is a vector (the diagonal of W), a matrix (W itself), or DiagonalWeights, DenseWeights, UnitWeights.
/// null_space is the secondary motion z. singular is the damping near singular postures, none by default.
/// Each function throws std::invalid_argument if a parameter is out of range.
namespace fpbm {

namespace named {

/// T in a non-deduced context, so that k1 = 10 does not make Scalar int.
template <typename T>
struct Same {
  using type = T;
};
template <typename T>
using NotDeduced = typename Same<T>::type;

template <int N, typename Scalar, typename Weights>
[[nodiscard]] auto weights_of(const Weights& weights) {
  if constexpr (!std::is_base_of_v<Eigen::EigenBase<Weights>, Weights>) {
    return weights;
  } else if constexpr (Weights::ColsAtCompileTime == 1) {
    return DiagonalWeights<N, Scalar>(Vector<N, Scalar>(weights));
  } else {
    return DenseWeights<N, Scalar>(Matrix<N, N, Scalar>(weights));
  }
}
template <int N, typename Scalar, typename Weights>
using WeightsOf = decltype(weights_of<N, Scalar>(std::declval<const Weights&>()));

template <typename Scalar>
[[nodiscard]] SingularDamping<Scalar> undamped() {
  return SingularDamping<Scalar>::off();
}

}  // namespace named

// NOLINTBEGIN(readability-identifier-naming): the paper's names.

/// Minimum velocity norm, (6): qd = J⁺xd. With z, the general solution (3), qd = J⁺xd + (I − J⁺J) z.
template <int N, typename Scalar = double>
[[nodiscard]] VelocityScheme<N, Scalar, UnitWeights> MVN(
    named::NotDeduced<Scalar> k = Scalar(0), const NullSpace<N, Scalar>& null_space = {},
    const SingularDamping<Scalar>& singular = named::undamped<Scalar>()) {
  return VelocityScheme<N, Scalar, UnitWeights>(UnitWeights{}, k, null_space, singular);
}

/// Weighted minimum velocity norm, (7): qd = J_W⁺xd, the qd with the least qdᵀW qd.
template <int N, typename Scalar = double, typename Weights>
[[nodiscard]] VelocityScheme<N, Scalar, named::WeightsOf<N, Scalar, Weights>> WMVN(
    const Weights& weights, named::NotDeduced<Scalar> k = Scalar(0), const NullSpace<N, Scalar>& null_space = {},
    const SingularDamping<Scalar>& singular = named::undamped<Scalar>()) {
  return VelocityScheme<N, Scalar, named::WeightsOf<N, Scalar, Weights>>(named::weights_of<N, Scalar>(weights), k,
                                                                         null_space, singular);
}

/// Minimum acceleration norm, (8): qdd = J⁺(xdd − Jd qd). With z, the general solution (5).
template <int N, typename Scalar = double>
[[nodiscard]] AccelerationScheme<N, Scalar, UnitWeights> MAN(
    const NullSpace<N, Scalar>& null_space = {}, const SingularDamping<Scalar>& singular = named::undamped<Scalar>()) {
  return {Scalar(0), UnitWeights{}, Scalar(0), Scalar(0), null_space, singular};
}

/// Feedback-added pseudoinverse-type balanced minimisation, (13): the balance (16) of MAN and WMVN with feedback.
template <int N, typename Scalar = double, typename Weights>
[[nodiscard]] AccelerationScheme<N, Scalar, named::WeightsOf<N, Scalar, Weights>> FPBM(
    named::NotDeduced<Scalar> alpha, const Weights& weights, named::NotDeduced<Scalar> k1, named::NotDeduced<Scalar> k2,
    const NullSpace<N, Scalar>& null_space = {}, const SingularDamping<Scalar>& singular = named::undamped<Scalar>()) {
  return {alpha, named::weights_of<N, Scalar>(weights), k1, k2, null_space, singular};
}

/// Balance of MAN (8) and WMVN (9) without feedback, (16): qdd = (1−α) MAN + α WMVN.
template <int N, typename Scalar = double, typename Weights>
[[nodiscard]] auto Balanced(named::NotDeduced<Scalar> alpha, const Weights& weights,
                            const NullSpace<N, Scalar>& null_space = {},
                            const SingularDamping<Scalar>& singular = named::undamped<Scalar>()) {
  return FPBM<N, Scalar>(alpha, weights, Scalar(0), Scalar(0), null_space, singular);
}

/// Weighted minimum velocity norm at acceleration level, (9), the time derivative of (7) (Theorem 1):
/// qdd = J_W⁺(xdd − Jd qd) + N_W W⁻¹Jdᵀ(JW⁻¹Jᵀ)⁻¹xd.
template <int N, typename Scalar = double, typename Weights>
[[nodiscard]] auto WMVNAcceleration(const Weights& weights, const NullSpace<N, Scalar>& null_space = {},
                                    const SingularDamping<Scalar>& singular = named::undamped<Scalar>()) {
  return FPBM<N, Scalar>(Scalar(1), weights, Scalar(0), Scalar(0), null_space, singular);
}

/// Least torque: the qdd with the least |M qdd + h|² (MinimumTorqueScheme), with feedback as in (13). model: Dynamics
/// of the robot. Set a null-space damping: without damping, long motions are unstable.
template <typename Model>
[[nodiscard]] MinimumTorqueScheme<Model> MinimumTorque(
    const Model& model, named::NotDeduced<typename Model::Scalar> k1, named::NotDeduced<typename Model::Scalar> k2,
    const NullSpace<Model::kDof, typename Model::Scalar>& null_space = {},
    const SingularDamping<typename Model::Scalar>& singular = named::undamped<typename Model::Scalar>()) {
  using Scalar = typename Model::Scalar;
  return {model, Scalar(0), UnitWeights{}, k1, k2, null_space, singular};
}

/// Balance of least torque and WMVN (9) with feedback: qdd = (1−α) MinimumTorque + α WMVN.
template <typename Model, typename Weights>
[[nodiscard]] MinimumTorqueScheme<Model, named::WeightsOf<Model::kDof, typename Model::Scalar, Weights>> BalancedTorque(
    const Model& model, named::NotDeduced<typename Model::Scalar> alpha, const Weights& weights,
    named::NotDeduced<typename Model::Scalar> k1, named::NotDeduced<typename Model::Scalar> k2,
    const NullSpace<Model::kDof, typename Model::Scalar>& null_space = {},
    const SingularDamping<typename Model::Scalar>& singular = named::undamped<typename Model::Scalar>()) {
  const auto W = named::weights_of<Model::kDof, typename Model::Scalar>(weights);
  return {model, alpha, W, k1, k2, null_space, singular};
}

/// Least kinetic energy: the qd with the least qdᵀM qd (MinimumEnergyScheme), at velocity level.
template <typename Model>
[[nodiscard]] MinimumEnergyScheme<Model> MinimumEnergy(
    const Model& model, named::NotDeduced<typename Model::Scalar> k = typename Model::Scalar(0),
    const NullSpace<Model::kDof, typename Model::Scalar>& null_space = {},
    const SingularDamping<typename Model::Scalar>& singular = named::undamped<typename Model::Scalar>()) {
  return MinimumEnergyScheme<Model>(model, k, null_space, singular);
}

// NOLINTEND(readability-identifier-naming)

}  // namespace fpbm
