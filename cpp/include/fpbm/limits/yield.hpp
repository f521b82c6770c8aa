#pragma once

#include <algorithm>

#include "fpbm/core/level.hpp"
#include "fpbm/limits/box.hpp"
#include "fpbm/limits/box_least_squares.hpp"
#include "fpbm/limits/rows.hpp"
#include "fpbm/limits/saturated.hpp"
#include "fpbm/linalg/product.hpp"
#include "fpbm/linalg/sums.hpp"

namespace fpbm {

/// Freedom f of the direction b of a task, from 0 (blocked) to 1, where the motion u keeps this direction and the
/// motion `leaving` does not (docs/limits.md, Saturation in the null space):
///
///   min((J u · b)/(0.3 J leaving · b), 1) min((σ_b/σ₀)², 1),    σ_b = ‖Jᵀb‖/(‖J‖‖b‖)
///
/// The first factor compares the parts of the task that both motions realise. If only the demand is large, both parts
/// are small, but u realises a large fraction of the part of `leaving`. If the posture loses the direction b, both
/// parts are small too; there, the second factor is small.
template <int M, int N, typename Scalar>
[[nodiscard]] Scalar freedom(const Matrix<M, N, Scalar>& J, const Vector<M, Scalar>& task, const Vector<N, Scalar>& u,
                             const Vector<N, Scalar>& leaving) noexcept {
  constexpr Scalar kShare = Scalar(0.3);
  constexpr Scalar kLost = Scalar(0.3);  // σ₀
  const Scalar most = kShare * dot(product(J, leaving), task);
  const Scalar size = kLost * kLost * squared_norm(J) * squared_norm(task);
  if (!(most > Scalar(0) && size > Scalar(0))) return Scalar(0);
  const Scalar kept = std::clamp(dot(product(J, u), task) / most, Scalar(0), Scalar(1));
  return kept * std::min(squared_norm(transpose_times(J, task)) / size, Scalar(1));
}

/// Blends the motion of `found` with yielded, the result of box_least_squares():
/// found + (1 − (s/s₀)²)² (1 − f²)² (yielded − found). s is the task scale, s₀ = kLittle the scale below which the
/// motions are blended, and f the result of freedom(). At velocity level, s is the fraction of the task velocity that
/// `found` realises.
template <Level kLevel, int M, int N, int P, typename Scalar>
void yield(const Matrix<M, N, Scalar>& J, const Vector<N, Scalar>& qd, const Box<N, Scalar>& box,
           const Rows<N, P, Scalar>& rows, const Vector<N, Scalar>& desired, Saturated<N, Scalar>& found) noexcept {
  using JointVector = Vector<N, Scalar>;
  constexpr Scalar kLittle = Scalar(0.1);  // s₀
  constexpr Scalar kRadius = Scalar(0.1);  // Damping of the least-squares solution, as a fraction of ‖J‖_F.
  constexpr Scalar kDamping = Scalar(10);  // Null-space damping of the least-squares solution [1/s].
  const Vector<M, Scalar> task = product(J, desired);
  Scalar scale = found.scale;
  if constexpr (kLevel == Level::kVelocity) scale = dot(product(J, found.u), task) / squared_norm(task);
  const Scalar left = scale > Scalar(0) ? scale / kLittle : Scalar(0);
  if (!(left < Scalar(1))) return;
  const Scalar mu = kRadius * kRadius * squared_norm(J);
  const JointVector rest =
      entrywise(qd, [&](Eigen::Index i) { return kLevel == Level::kAcceleration ? -kDamping * qd(i) : Scalar(0); });
  const JointVector yielded = box_least_squares<M, N, Scalar>(J, task, mu, rest, box);
  const Scalar free = freedom(J, task, found.u, yielded);
  const Scalar yields = (Scalar(1) - left * left) * (Scalar(1) - free * free);
  const JointVector blended =
      entrywise(yielded, [&](Eigen::Index i) { return found.u(i) + yields * yields * (yielded(i) - found.u(i)); });
  const JointVector to = box.nearest(blended);  // Round-off may lead out of the box.
  const Scalar share = rows.share(found.u, to);
  found.u = entrywise(to, [&](Eigen::Index i) { return found.u(i) + share * (to(i) - found.u(i)); });
}

}  // namespace fpbm
