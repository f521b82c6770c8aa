#pragma once

#include "fpbm/core/status.hpp"
#include "fpbm/resolver/damping.hpp"
#include "fpbm/resolver/null_space.hpp"

namespace fpbm {

/// The joint motion u nearest to z in the norm of W among those with J u = v:
///
///   u = J_W⁺v + N_W z = W⁻¹Jᵀλ + z,   λ = (JW⁻¹Jᵀ)⁻¹(v − J z),
///
/// with no pseudoinverse or projector formed. Damped near singular postures, and then kDamped. Leaves u alone where it
/// fails. Flattened, since a large translation unit may keep small calls apart.
template <Level kLevel, int M, int N, typename Scalar, typename Weights>
[[nodiscard, gnu::flatten]] Status least_norm(const Weights& weights, const Vector<M, Scalar>& v,
                                              const NullSpace<N, Scalar>& null_space,
                                              const SingularDamping<Scalar>& damping, const Matrix<M, N, Scalar>& J,
                                              const State<N, Scalar>& state, Vector<N, Scalar>& u) noexcept {
  const Matrix<N, M, Scalar> WinvJt = weights.solve(J.transpose());
  DampedGram<M, N, Scalar> gram(damping, J);
  const Status status = gram.factor(weights, WinvJt);
  if (failed(status)) return status;

  Vector<N, Scalar> result;
  const bool braked = kLevel == Level::kAcceleration && status == Status::kDamped;
  if (braked || null_space.template active<kLevel>()) {
    Vector<N, Scalar> z = null_space.template at<kLevel>(state);
    if (braked) z -= gram.brake() * state.qd;
    const Vector<M, Scalar> rest = v - J.lazyProduct(z);
    result = z + WinvJt.lazyProduct(gram.solve(rest));
  } else {
    result = WinvJt.lazyProduct(gram.solve(v));
  }
  if (!is_finite(result)) return Status::kNotFinite;
  u = result;
  return status;
}

}  // namespace fpbm
