#pragma once

#include "fpbm/core/level.hpp"
#include "fpbm/limits/box.hpp"
#include "fpbm/limits/box_least_squares.hpp"
#include "fpbm/limits/rows.hpp"
#include "fpbm/limits/saturated.hpp"
#include "fpbm/linalg/product.hpp"
#include "fpbm/linalg/sums.hpp"

namespace fpbm {

/// Blends found with box_least_squares(): found + (1 − (s/s₀)²)² (yielded − found), where s is the scale and s₀ =
/// kLittle the scale below which the arm yields. At velocity level s is the share of the task's velocity that is
/// left.
template <Level kLevel, int M, int N, int P, typename Scalar>
void yield(const Matrix<M, N, Scalar>& J, const Vector<N, Scalar>& qd, const Box<N, Scalar>& box,
           const Rows<N, P, Scalar>& rows, const Vector<N, Scalar>& desired, Saturated<N, Scalar>& found) noexcept {
  using JointVector = Vector<N, Scalar>;
  constexpr Scalar kLittle = Scalar(0.1);  // s₀
  constexpr Scalar kFree = Scalar(0.5);
  constexpr Scalar kRadius = Scalar(0.1);  // Damping of the least squares, as a share of ‖J‖_F.
  constexpr Scalar kDamping = Scalar(10);  // Damping of what the least squares leave free [1/s].
  const Vector<M, Scalar> task = product(J, desired);
  Scalar scale = found.scale;
  if constexpr (kLevel == Level::kVelocity) scale = dot(product(J, found.u), task) / squared_norm(task);
  const Scalar left = scale > Scalar(0) ? scale / kLittle : Scalar(0);
  if (!(left < Scalar(1))) return;
  Scalar yields = Scalar(1) - left * left;
  const Scalar mu = kRadius * kRadius * squared_norm(J);
  const JointVector rest =
      entrywise(qd, [&](Eigen::Index i) { return kLevel == Level::kAcceleration ? -kDamping * qd(i) : Scalar(0); });
  const JointVector yielded = box_least_squares<M, N, Scalar>(J, task, mu, rest, box);
  // Where the task's line gives a good share of what leaving it would give, the demand is large and the line is free.
  const Scalar gain = dot(product(J, yielded), task);
  const Scalar kept = gain > Scalar(0) ? dot(product(J, found.u), task) / (kFree * gain) : Scalar(0);
  if (!(kept < Scalar(1))) return;
  yields *= kept > Scalar(0) ? Scalar(1) - kept * kept : Scalar(1);
  const JointVector blended =
      entrywise(yielded, [&](Eigen::Index i) { return found.u(i) + yields * yields * (yielded(i) - found.u(i)); });
  const JointVector to = box.nearest(blended);  // Round-off may leave the box.
  const Scalar share = rows.share(found.u, to);
  found.u = entrywise(to, [&](Eigen::Index i) { return found.u(i) + share * (to(i) - found.u(i)); });
}

}  // namespace fpbm
