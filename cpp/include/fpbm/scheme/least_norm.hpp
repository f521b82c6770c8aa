#pragma once

#include <type_traits>

#include "fpbm/core/level.hpp"
#include "fpbm/core/status.hpp"
#include "fpbm/objective/null_space.hpp"
#include "fpbm/scheme/one_self_motion.hpp"
#include "fpbm/singular/damping.hpp"

namespace fpbm {

/// Drift of a law that has none.
struct NoDrift {};

/// The joint motion u nearest to u₀ in the norm of W among those with J u = v:
///
///   u = u₀ + J_W⁺(v − J u₀) = u₀ + C (JC)⁺(v − J u₀),   C Cᵀ = W⁻¹,   u₀ = z + drift.
///
/// u: velocities or accelerations by level. drift(gram) is the part of u₀ that needs the factorised Gram matrix JW⁻¹Jᵀ,
/// or NoDrift. foreseen: what one_self_motion.hpp knows. The last kTurns rows of J are angular; length: the arm's [m].
/// Returns kDamped where damping acts. Leaves u unchanged where it fails. Flattened, since a large translation unit may
/// not inline small calls.
template <Level kLevel, int kTurns, int M, int N, typename Scalar, typename Weights, typename Drift, typename Known>
[[nodiscard, gnu::flatten]] Status least_norm(const Weights& weights, const Vector<M, Scalar>& v, const Drift& drift,
                                              const NullSpace<N, Scalar>& null_space,
                                              const SingularDamping<Scalar>& damping, const Matrix<M, N, Scalar>& J,
                                              const Scalar& length, const State<N, Scalar>& state,
                                              const Known& foreseen, Vector<N, Scalar>& u) noexcept {
  Matrix<N, M, Scalar> rows = weights.root_transpose(J);  // (JC)ᵀ
  DampedGram<M, N, Scalar, kTurns> gram(damping, J, length);
  const Status status = gram.factor(rows, weights.template inverse_bound<Scalar>());
  if (foreseen.answers(gram, u)) return Status::kOk;
  if (failed(status)) return status;

  constexpr bool kDrifts = !std::is_same_v<Drift, NoDrift>;
  const bool braked = kLevel == Level::kAcceleration && status == Status::kDamped;
  Vector<N, Scalar> result;
  if (kDrifts || braked || null_space.template active<kLevel>()) {
    Vector<N, Scalar> u0 = null_space.template at<kLevel>(state);
    if constexpr (kDrifts) u0 += drift(gram);
    if (braked) u0 -= gram.brake() * state.qd;
    const Vector<M, Scalar> rest = v - J.lazyProduct(u0);
    const Vector<N, Scalar> task = gram.motion(gram.shares(rest));
    result = u0 + weights.root(task);
  } else {
    const Vector<N, Scalar> task = gram.motion(gram.shares(v));
    result = weights.root(task);
  }
  foreseen.settle(result);
  if (!is_finite(result)) return Status::kNotFinite;
  u = result;
  return status;
}

}  // namespace fpbm
