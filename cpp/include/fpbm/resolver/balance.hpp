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
/// with no pseudoinverse or projector formed. α = 0 without z, and α = 1, cost one factorisation only.
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
  DampedGram<M, N, Scalar> gram(damping, J);
  Vector<N, Scalar> result = Vector<N, Scalar>::Zero(J.cols());
  Status status = Status::kOk;

  if (alpha != Scalar(1)) {
    status = gram.factor(UnitWeights{}, J.transpose());
    if (failed(status)) return status;
    const Vector<M, Scalar> lambda1 = gram.solve(b);
    result = (Scalar(1) - alpha) * J.transpose().lazyProduct(lambda1);
  }
  const bool has_z = null_space.template active<Level::kAcceleration>() || status == Status::kDamped;
  if (alpha != Scalar(0) || has_z) {
    const Matrix<N, M, Scalar> WinvJt = weights.solve(J.transpose());
    status = worse(status, gram.factor(weights, WinvJt));
    if (failed(status)) return status;
    const Vector<M, Scalar> mu = gram.solve(reference.xd);
    const Vector<N, Scalar> Jdtmu = alpha * kinematics.Jd.transpose().lazyProduct(mu);
    Vector<N, Scalar> u = weights.solve(Jdtmu);
    if (has_z) u += null_space.template at<Level::kAcceleration>(state);
    if (status == Status::kDamped) u -= gram.brake() * state.qd;
    const Vector<M, Scalar> rest = alpha * b - J.lazyProduct(u);
    result += u + WinvJt.lazyProduct(gram.solve(rest));
  }
  if (!result.allFinite()) return Status::kNotFinite;
  qdd = result;
  return status;
}

}  // namespace fpbm
