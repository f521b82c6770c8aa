#pragma once

#include "fpbm/core/status.hpp"
#include "fpbm/model/kinematics.hpp"
#include "fpbm/resolver/damping.hpp"
#include "fpbm/resolver/null_space.hpp"
#include "fpbm/resolver/weights.hpp"
#include "fpbm/task/reference.hpp"

namespace fpbm {

/// The balance (16) of MAN (8) and WMVN (9) for a commanded b, with z projected on the null space:
///
///   qdd = (1−α) Jᵀλ₁ + W⁻¹(α Jdᵀμ + Jᵀλ₂) + z,
///   λ₁ = (JJᵀ)⁻¹b,  μ = (JW⁻¹Jᵀ)⁻¹xd,  λ₂ = (JW⁻¹Jᵀ)⁻¹(α b − α JW⁻¹Jdᵀμ − J z),
///
/// with no pseudoinverse or projector formed, and both factorisations made side by side.
/// Damped near singular postures, and then kDamped. Leaves qdd alone where it fails. Flattened, since a large
/// translation unit may keep small calls apart.
template <typename Space, int N, typename Scalar, typename Weights>
[[nodiscard, gnu::flatten]] Status balance(Scalar alpha, const Weights& weights, const Vector<Space::kRows, Scalar>& b,
                                           const NullSpace<N, Scalar>& null_space,
                                           const SingularDamping<Scalar>& damping,
                                           const Kinematics<Space, N, Scalar>& kinematics,
                                           const Reference<Space, Scalar>& reference, const State<N, Scalar>& state,
                                           Vector<N, Scalar>& qdd) noexcept {
  constexpr int M = Space::kRows;
  const auto& J = kinematics.J;
  DampedGram<M, N, Pair<Scalar>> gram(damping, J);  // Of JJᵀ and JW⁻¹Jᵀ.
  const Status status = gram.factor(UnitWeights{}, weights.with_unit(J));
  if (failed(status)) return status;

  const Vector<M, Pair<Scalar>> both = gram.solve(side_by_side<M, 1, Scalar>(b, reference.xd));
  const Vector<M, Scalar> lambda1 = first<M, 1, Scalar>(both);
  const Vector<M, Scalar> mu = second<M, 1, Scalar>(both);
  const Vector<N, Scalar> Jdtmu = alpha * kinematics.Jd.transpose().lazyProduct(mu);
  Vector<N, Scalar> u = weights.solve(Jdtmu);
  if (null_space.template active<Level::kAcceleration>()) u += null_space.template at<Level::kAcceleration>(state);
  if (status == Status::kDamped) u -= gram.brake() * state.qd;
  const Vector<M, Scalar> rest = alpha * b - J.lazyProduct(u);
  const Vector<M, Scalar> lambda2 = second<M, 1, Scalar>(gram.solve(side_by_side<M, 1, Scalar>(rest, rest)));

  const Vector<M, Scalar> shared = (Scalar(1) - alpha) * lambda1;
  const Vector<N, Scalar> Jtlambda = J.transpose().lazyProduct(lambda2);
  const Vector<N, Scalar> result = J.transpose().lazyProduct(shared) + u + weights.solve(Jtlambda);
  if (!is_finite(result)) return Status::kNotFinite;
  qdd = result;
  return status;
}

}  // namespace fpbm
