#pragma once

#include <type_traits>
#include <utility>

#include "fpbm/core/types.hpp"
#include "fpbm/core/status.hpp"
#include "fpbm/linalg/detail/product.hpp"
#include "fpbm/linalg/detail/sums.hpp"
#include "fpbm/objective/null_space.hpp"
#include "fpbm/scheme/detail/one_self_motion.hpp"
#include "fpbm/scheme/weights.hpp"
#include "fpbm/singular/detail/damped_gram.hpp"

namespace fpbm {

/// Argument `force` of a law without f.
struct NoForce {};

/// Joint motion u that is nearest to u₀ in the norm of W, among all u with J u = v (docs/equations.md, Unified law):
///
///   u = u₀ + J_W⁺(v − J u₀) = C ((JC)⁺v + (I − (JC)⁺JC) y₀),   C Cᵀ = W⁻¹,   y₀ = C⁻¹u₀,   u₀ = z + W⁻¹f.
///
/// u: velocities or accelerations, by level. force(solutions) returns f from solutions with the factorised Gram matrix
/// JW⁻¹Jᵀ; or force is NoForce. undamped: result of undamped_result(), or NoUndampedResult. The last kTurns rows of J
/// are angular. length: characteristic length of the arm [m]. sigma: as in DampedGram::factor(). Returns kDamped if
/// damping acts. If the status is a failure, u does not change. Flattened, since a compiler may not inline small calls
/// in a large translation unit.
template <Level kLevel, int kTurns, int M, int N, typename Scalar, typename Weights, typename Force, typename Known>
[[nodiscard, gnu::flatten]] Status least_norm(const Weights& weights, const Vector<M, Scalar>& v, const Force& force,
                                              const NullSpace<N, Scalar>& null_space,
                                              const SingularDamping<Scalar>& damping, const Matrix<M, N, Scalar>& J,
                                              const Scalar& length, const State<N, Scalar>& state,
                                              const Known& undamped, Vector<N, Scalar>& u,
                                              [[maybe_unused]] Scalar* sigma) noexcept {
  const Matrix<N, M, Scalar> Jt = transpose_of(J);
  const Matrix<N, M, Scalar> rows = weights.root_transpose(Jt);  // (JC)ᵀ
  DampedGram<M, N, Scalar, kTurns> gram(damping, J, length);
  constexpr bool kUnit = std::is_same_v<Weights, UnitWeights>;
  const Status status = gram.factor(rows, weights.template inverse_bound<Scalar>(), kUnit ? sigma : nullptr);
  if (undamped.take_if_undamped(gram, u)) return Status::kOk;
  if (failed(status)) return status;

  constexpr bool kForced = !std::is_same_v<Force, NoForce>;
  const Vector<N, Scalar> y = gram.solved([&](const auto& solutions) noexcept -> Vector<N, Scalar> {
    constexpr bool kDamped = std::decay_t<decltype(solutions)>::kIsDamped;
    constexpr bool kBraked = kDamped && kLevel == Level::kAcceleration;
    if (!(kForced || kBraked || null_space.template active<kLevel>())) {
      return solutions.motion(solutions.coefficients(v));
    }
    const Vector<N, Scalar> z = kDamped ? null_space.template velocity_part<kLevel>(state, gram.brake())
                                        : null_space.template at<kLevel>(state);
    Vector<N, Scalar> y0 = weights.inverse_root(z);
    if constexpr (kForced) y0 = sum_of(y0, weights.root_transpose(force(solutions)));
    Vector<N, Scalar> free = solutions.project(y0);
    if constexpr (kDamped) {
      if (null_space.template active<Level::kVelocity>()) {
        free = sum_of(free, solutions.secondary(weights.inverse_root(null_space.position_part(state)), v));
      }
    }
    const Vector<N, Scalar> done = solutions.motion(solutions.coefficients(v));
    return sum_of(free, done);
  });
  Vector<N, Scalar> result = weights.root(y);
  undamped.set_undamped_lanes(result);
  if (!is_finite(result)) return Status::kNotFinite;
  u = std::move(result);
  return status;
}

}  // namespace fpbm
