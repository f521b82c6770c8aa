#pragma once

#include "fpbm/core/cholesky.hpp"
#include "fpbm/core/status.hpp"
#include "fpbm/resolver/null_space.hpp"

namespace fpbm {

/// The joint motion u nearest to z in the norm of W among those with J u = v:
///
///   u = J_W⁺v + N_W z = W⁻¹Jᵀλ + z,   λ = (JW⁻¹Jᵀ)⁻¹(v − J z),
///
/// with no pseudoinverse or projector formed. Leaves u alone unless it returns kOk.
/// Flattened, since a large translation unit may keep small calls apart.
template <Level kLevel, int M, int N, typename Scalar, typename Weights>
[[nodiscard, gnu::flatten]] Status least_norm(const Weights& weights, const Vector<M, Scalar>& v,
                                              const NullSpace<N, Scalar>& null_space, const Matrix<M, N, Scalar>& J,
                                              const State<N, Scalar>& state, Vector<N, Scalar>& u) noexcept {
  const Matrix<N, M, Scalar> WinvJt = weights.solve(J.transpose());
  const Matrix<M, M, Scalar> gram = J.lazyProduct(WinvJt);
  Cholesky<M, Scalar> cholesky;
  if (const Status status = cholesky.factor(gram); status != Status::kOk) return status;

  Vector<N, Scalar> result;
  if (null_space.template active<kLevel>()) {
    const Vector<N, Scalar> z = null_space.template at<kLevel>(state);
    const Vector<M, Scalar> rest = v - J.lazyProduct(z);
    result = z + WinvJt.lazyProduct(cholesky.solve(rest));
  } else {
    result = WinvJt.lazyProduct(cholesky.solve(v));
  }
  if (!result.allFinite()) return Status::kNotFinite;
  u = result;
  return Status::kOk;
}

}  // namespace fpbm
