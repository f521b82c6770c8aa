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

/// s₀: a level with a smaller scale yields, unless its direction is free.
template <typename Scalar>
inline constexpr Scalar kLittle = Scalar(0.1);

/// Motion of joints that a blocked task leaves free: they brake.
template <Level kLevel, int N, typename Scalar>
[[nodiscard]] Vector<N, Scalar> calm_motion(const Vector<N, Scalar>& qd) noexcept {
  constexpr Scalar kDamping = Scalar(10);  // [1/s]
  return entrywise(qd, [&](Eigen::Index i) { return kLevel == Level::kAcceleration ? -kDamping * qd(i) : Scalar(0); });
}

/// Share of `yielded`, which leaves the task's direction b, in the motion of a level:
///
///   w = (1 − (s/s₀)²)² (1 − f²)²,   f = min((J found · b)/(0.3 J yielded · b), 1) min((σ_b/0.1)², 1)
///
/// s is the scale. f compares what both motions give of the task: from 0.3 on, the direction is free, and s is
/// small because the demand is large. σ_b = ‖(JZ)ᵀb‖/(‖J‖‖b‖) is small where the posture or the higher levels lose the
/// direction; there both give little. rates: (JZ)ᵀb.
template <int M, int N, typename Scalar, typename Rates>
[[nodiscard]] Scalar yielded_share(const Matrix<M, N, Scalar>& J, const Vector<M, Scalar>& task, const Rates& rates,
                                   Scalar scale, const Vector<N, Scalar>& found,
                                   const Vector<N, Scalar>& yielded) noexcept {
  constexpr Scalar kFree = Scalar(0.3);
  constexpr Scalar kLost = Scalar(0.1);
  const Scalar left = scale > Scalar(0) ? scale / kLittle<Scalar> : Scalar(0);
  if (!(left < Scalar(1))) return Scalar(0);
  const Scalar most = kFree * dot(product(J, yielded), task);
  const Scalar kept = most > Scalar(0) ? dot(product(J, found), task) / most : Scalar(0);
  const Scalar size = squared_norm(J) * squared_norm(task);
  const Scalar present = size > Scalar(0) ? squared_norm(rates) / (kLost * kLost * size) : Scalar(0);
  const Scalar free = std::clamp(kept, Scalar(0), Scalar(1)) * std::min(present, Scalar(1));
  const Scalar blocked = (Scalar(1) - left * left) * (Scalar(1) - free * free);
  return blocked * blocked;
}

/// Blends found, the motion of the first level, with box_least_squares(), as far as yielded_share() says. At velocity
/// level the scale is the share of the task's velocity that is left.
template <Level kLevel, int M, int N, int P, typename Scalar>
void yield(const Matrix<M, N, Scalar>& J, const Vector<N, Scalar>& qd, const Box<N, Scalar>& box,
           const Rows<N, P, Scalar>& rows, const Vector<N, Scalar>& desired, Saturated<N, Scalar>& found) noexcept {
  using JointVector = Vector<N, Scalar>;
  constexpr Scalar kRadius = Scalar(0.1);  // Damping of the least squares, as a share of ‖J‖_F.
  const Vector<M, Scalar> task = product(J, desired);
  Scalar scale = found.scale;
  if constexpr (kLevel == Level::kVelocity) scale = dot(product(J, found.u), task) / squared_norm(task);
  if (!(scale < kLittle<Scalar>)) return;
  const Scalar mu = kRadius * kRadius * squared_norm(J);
  const JointVector yielded = box_least_squares<M, N, Scalar>(J, task, mu, calm_motion<kLevel>(qd), box);
  const Scalar yields = yielded_share(J, task, transpose_times(J, task), scale, found.u, yielded);
  if (!(yields > Scalar(0))) return;
  const JointVector blended =
      entrywise(yielded, [&](Eigen::Index i) { return found.u(i) + yields * (yielded(i) - found.u(i)); });
  const JointVector to = box.nearest(blended);  // Round-off may leave the box.
  const Scalar share = rows.share(found.u, to);
  found.u = entrywise(to, [&](Eigen::Index i) { return found.u(i) + share * (to(i) - found.u(i)); });
}

}  // namespace fpbm
