#pragma once

#include "fpbm/core/cholesky.hpp"
#include "fpbm/core/status.hpp"
#include "fpbm/model/kinematics.hpp"
#include "fpbm/resolver/null_space.hpp"
#include "fpbm/task/reference.hpp"

namespace fpbm {

/// The balance (16) of MAN (8) and WMVN (9) for a commanded b, with z projected on the null space:
///
///   qdd = (1−α) Jᵀλ₁ + W⁻¹(α Jdᵀμ + Jᵀλ₂) + z,
///   λ₁ = (JJᵀ)⁻¹b,  μ = (JW⁻¹Jᵀ)⁻¹xd,  λ₂ = (JW⁻¹Jᵀ)⁻¹(α b − α JW⁻¹Jdᵀμ − J z),
///
/// with no pseudoinverse or projector formed. α = 0 without z, and α = 1, cost one factorisation only.
/// Leaves qdd alone unless it returns kOk. Flattened, since a large translation unit may keep small calls apart.
template <typename Space, int N, typename Scalar, typename Weights>
[[nodiscard, gnu::flatten]] Status balance(Scalar alpha, const Weights& weights, const Vector<Space::kRows, Scalar>& b,
                                           const NullSpace<N, Scalar>& null_space,
                                           const Kinematics<Space, N, Scalar>& kinematics,
                                           const Reference<Space, Scalar>& reference, const State<N, Scalar>& state,
                                           Vector<N, Scalar>& qdd) noexcept {
  constexpr int M = Space::kRows;
  const auto& J = kinematics.J;
  const bool has_z = null_space.template active<Level::kAcceleration>();
  Cholesky<M, Scalar> cholesky;
  Vector<N, Scalar> result = Vector<N, Scalar>::Zero(J.cols());

  if (alpha != Scalar(1)) {
    const Matrix<M, M, Scalar> gram = J.lazyProduct(J.transpose());
    if (const Status status = cholesky.factor(gram); status != Status::kOk) return status;
    const Vector<M, Scalar> lambda1 = cholesky.solve(b);
    result = (Scalar(1) - alpha) * J.transpose().lazyProduct(lambda1);
  }
  if (alpha != Scalar(0) || has_z) {
    const Matrix<N, M, Scalar> WinvJt = weights.solve(J.transpose());
    const Matrix<M, M, Scalar> gram = J.lazyProduct(WinvJt);
    if (const Status status = cholesky.factor(gram); status != Status::kOk) return status;
    const Vector<M, Scalar> mu = cholesky.solve(reference.xd);
    const Vector<N, Scalar> Jdtmu = alpha * kinematics.Jd.transpose().lazyProduct(mu);
    Vector<N, Scalar> u = weights.solve(Jdtmu);
    if (has_z) u += null_space.template at<Level::kAcceleration>(state);
    const Vector<M, Scalar> rest = alpha * b - J.lazyProduct(u);
    result += u + WinvJt.lazyProduct(cholesky.solve(rest));
  }
  if (!result.allFinite()) return Status::kNotFinite;
  qdd = result;
  return Status::kOk;
}

}  // namespace fpbm
