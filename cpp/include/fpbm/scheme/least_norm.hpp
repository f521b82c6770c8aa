#pragma once

#include "fpbm/core/level.hpp"
#include "fpbm/core/status.hpp"
#include "fpbm/objective/null_space.hpp"
#include "fpbm/singular/damping.hpp"

namespace fpbm {

/// The joint motion u nearest to u₀ in the norm of W among those with J u = v:
///
///   u = u₀ + J_W⁺(v − J u₀) = u₀ + W⁻¹Jᵀλ,   λ = (JW⁻¹Jᵀ)⁻¹(v − J u₀),   u₀ = z + drift.
///
/// WinvJt: W⁻¹Jᵀ. inverse_bound: bound on the largest eigenvalue of W⁻¹. drift(gram) is a part of u₀ that needs the
/// factorised Gram matrix JW⁻¹Jᵀ; it counts where drifts is true.
/// Damped near singular postures, and then kDamped. Leaves u unchanged where it fails. Flattened, since a large
/// translation unit may not inline small calls.
template <Level kLevel, int M, int N, typename Scalar, typename Drift>
[[nodiscard, gnu::flatten]] Status least_norm(const Matrix<N, M, Scalar>& WinvJt, Scalar inverse_bound,
                                              const Vector<M, Scalar>& v, bool drifts, const Drift& drift,
                                              const NullSpace<N, Scalar>& null_space,
                                              const SingularDamping<Scalar>& damping, const Matrix<M, N, Scalar>& J,
                                              const State<N, Scalar>& state, Vector<N, Scalar>& u) noexcept {
  DampedGram<M, N, Scalar> gram(damping, J);
  const Status status = gram.factor(WinvJt, inverse_bound);
  if (failed(status)) return status;

  Vector<N, Scalar> result;
  const bool braked = kLevel == Level::kAcceleration && status == Status::kDamped;
  if (drifts || braked || null_space.template active<kLevel>()) {
    Vector<N, Scalar> u0 = null_space.template at<kLevel>(state);
    if (drifts) u0 += drift(gram);
    if (braked) u0 -= gram.brake() * state.qd;
    const Vector<M, Scalar> rest = v - J.lazyProduct(u0);
    result = u0 + WinvJt.lazyProduct(gram.solve(rest));
  } else {
    result = WinvJt.lazyProduct(gram.solve(v));
  }
  if (!is_finite(result)) return Status::kNotFinite;
  u = result;
  return status;
}

}  // namespace fpbm
