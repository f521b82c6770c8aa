#pragma once

#include <algorithm>

#include "fpbm/core/types.hpp"
#include "fpbm/limits/detail/box.hpp"
#include "fpbm/limits/detail/box_least_squares.hpp"
#include "fpbm/limits/detail/rows.hpp"
#include "fpbm/limits/detail/saturated_motion.hpp"
#include "fpbm/linalg/detail/product.hpp"
#include "fpbm/linalg/detail/sums.hpp"

namespace fpbm {

/// Freedom f of the direction b of a task, from 0 (blocked) to 1. The motion u keeps the direction b, and the motion
/// `other` does not (docs/limits.md, Saturation in the null space):
///
///   min((J u · b)/(0.3 J other · b), 1) min((σ_b/0.3)², 1),    σ_b = ‖Jᵀb‖/(‖J‖‖b‖)
///
/// The first factor compares the part of the task that u realises with the part that `other` realises. If both parts
/// are small because the demand is large, the first factor is not small. If both parts are small because the posture
/// loses the direction b, the second factor is small.
template <int M, int N, typename Scalar>
[[nodiscard]] Scalar freedom(const Matrix<M, N, Scalar>& J, const Vector<M, Scalar>& task, const Vector<N, Scalar>& u,
                             const Vector<N, Scalar>& other) noexcept {
  // `fpbm_tests --gtest_filter='Yield*'` prints how many of 800 motions keep their direction: 796 or more for each
  // factor from 0.03 to 0.3, and less than 504 with 0.6.
  constexpr Scalar kKeptFraction = Scalar(0.3);
  constexpr Scalar kLostSigma = Scalar(0.3);
  const Scalar most = kKeptFraction * dot(product(J, other), task);
  const Scalar size = kLostSigma * kLostSigma * squared_norm(J) * squared_norm(task);
  if (!(most > Scalar(0) && size > Scalar(0))) return Scalar(0);
  const Scalar kept = std::clamp(dot(product(J, u), task) / most, Scalar(0), Scalar(1));
  return kept * std::min(squared_norm(transpose_times(J, task)) / size, Scalar(1));
}

/// Blends the motion of `found` with solution, the result of box_least_squares():
/// found + (1 − (s/s₀)²)² (1 − f²)² (solution − found). s is the task scale, s₀ = kBlendedScale the scale below which
/// the motions are blended, and f the result of freedom(). At velocity level, s is the fraction of the task velocity
/// that `found` realises.
template <Level kLevel, int M, int N, int P, typename Scalar>
void blend_with_least_squares(const Matrix<M, N, Scalar>& J, const Vector<N, Scalar>& qd, const Box<N, Scalar>& box,
                              const Rows<N, P, Scalar>& rows, const Vector<N, Scalar>& desired,
                              SaturatedMotion<N, Scalar>& found) noexcept {
  using JointVector = Vector<N, Scalar>;
  // Yield.keeps_the_direction_of_a_large_demand passes with s₀ from 0.03 to 0.9, and with radii from 0.01 to 0.3.
  constexpr Scalar kBlendedScale = Scalar(0.1);  // s₀
  constexpr Scalar kRadius = Scalar(0.1);        // Damping of the least-squares solution, as a fraction of ‖J‖_F.
  constexpr Scalar kDamping = Scalar(10);        // Null-space damping of the least-squares solution [1/s].
  const Vector<M, Scalar> task = product(J, desired);
  Scalar scale = found.scale;
  if constexpr (kLevel == Level::kVelocity) scale = dot(product(J, found.u), task) / squared_norm(task);
  const Scalar relative = scale > Scalar(0) ? scale / kBlendedScale : Scalar(0);
  if (!(relative < Scalar(1))) return;
  const Scalar mu = kRadius * kRadius * squared_norm(J);
  const JointVector rest =
      entrywise(qd, [&](Eigen::Index i) { return kLevel == Level::kAcceleration ? -kDamping * qd(i) : Scalar(0); });
  const JointVector solution = box_least_squares<M, N, Scalar>(J, task, mu, rest, box);
  const Scalar free = freedom(J, task, found.u, solution);
  const Scalar weight = (Scalar(1) - relative * relative) * (Scalar(1) - free * free);
  const JointVector blended =
      entrywise(solution, [&](Eigen::Index i) { return found.u(i) + weight * weight * (solution(i) - found.u(i)); });
  const JointVector to = box.nearest(blended);  // Round-off may lead out of the box.
  const Scalar fraction = rows.admitted_fraction(found.u, to);
  found.u = entrywise(to, [&](Eigen::Index i) { return found.u(i) + fraction * (to(i) - found.u(i)); });
}

}  // namespace fpbm
