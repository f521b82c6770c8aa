#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "fpbm/core/status.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/limits/detail/rows.hpp"
#include "fpbm/linalg/detail/entrywise.hpp"
#include "fpbm/linalg/detail/sums.hpp"

/// A tick on a kept path (docs/paths.md, In a control loop). The motion of a scheme is linear in the motion of the
/// reference. With the fraction σ of the rate of the clock at the end of the tick, the motion of the joints is
/// still + σ (u − still), where `still` is the motion of the scheme for a reference that stops in the tick: the
/// velocity for a reference at rest, or the acceleration for a reference at rest at the end of the tick. The tip stays
/// on the path for every σ.
namespace fpbm {

/// The fraction σ in [0, most] to which a motion u of the joints corresponds: the nearest σ.
template <typename Desired, int N, typename Scalar>
[[nodiscard]] Scalar path_fraction(const Desired& desired, const Vector<N, Scalar>& u, Scalar most) noexcept {
  const auto change = [&](Eigen::Index i) { return desired.u.coeff(i) - desired.still.coeff(i); };
  const Scalar square = sum_over(u, [&](Eigen::Index i) { return change(i) * change(i); });
  const Scalar moved = sum_over(u, [&](Eigen::Index i) { return change(i) * (u.coeff(i) - desired.still.coeff(i)); });
  if (square == Scalar(0)) return Scalar(1);
  return moved > Scalar(0) ? std::min(moved / square, most) : Scalar(0);
}

/// Sets path_fraction and status of the result for a tick that ends in the state `next`.
template <typename TrackerState, typename Desired, typename Rows_>
void report_path(const TrackerState& state, const Desired& desired, const Rows_& rows,
                 const typename TrackerState::JointState& next, typename TrackerState::Result& result) noexcept {
  if constexpr (Desired::kOnPath) {
    if (!state.on_path() || next.qd == state.tick.after(desired.u).qd) return;
    result.path_fraction = path_fraction(desired, state.tick.motion_to(next), state.most_path_fraction);
    if (result.path_fraction < 1) {
      result.status = worse(result.status, rows.admit(desired.u) ? Status::kSlowed : Status::kBlocked);
    }
  }
}

/// Sets u to the motion on the path with the fraction σ in [0, most] nearest to `wanted` that the limits and the rows
/// admit. Returns false without an effect if they admit none. box: of the motions.
template <typename Desired, typename Box, int N, int P, typename Scalar>
[[nodiscard]] bool find_motion_on_path(const Desired& desired, const Box& box, const Rows<N, P, Scalar>& rows,
                                       Scalar most, Scalar wanted, Vector<N, Scalar>& u) noexcept {
  const auto& still = desired.still;
  const Vector<N, Scalar> change = desired.u - still;
  Scalar low(0);
  Scalar high = most;
  // The rate of a joint on a bound may be a round-off error, which must not stop the clock. box.nearest() removes the
  // error. KeptPath.begins_with_a_joint_on_a_bound fails with 0.
  constexpr Scalar kRoundOff = Scalar(1e6) * std::numeric_limits<Scalar>::epsilon();
  const Scalar least = kRoundOff * largest_magnitude(change);
  // Admits only fractions with lower ≤ σ rate ≤ upper.
  const auto narrow = [&](Scalar rate, Scalar lower, Scalar upper) noexcept {
    if (std::abs(rate) <= least) {
      if (lower > least || upper < -least) high = Scalar(-1);
      return;
    }
    low = std::max(low, (rate > Scalar(0) ? lower : upper) / rate);
    high = std::min(high, (rate > Scalar(0) ? upper : lower) / rate);
  };
  for (Eigen::Index i = 0; i < still.size(); ++i) narrow(change(i), box.lower(i) - still(i), box.upper(i) - still(i));
  if constexpr (P > 0) {
    for (Eigen::Index k = 0; k < rows.count; ++k) {
      narrow(rows.along(k, change), -std::numeric_limits<Scalar>::infinity(), -rows.excess(k, still));
    }
  }
  if (!(low <= high)) return false;
  u = box.nearest(still + std::clamp(wanted, low, high) * change);
  return true;
}

}  // namespace fpbm
