#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "fpbm/clearance/separation.hpp"
#include "fpbm/limits/stop_plan.hpp"
#include "fpbm/linalg/sums.hpp"

namespace fpbm {

/// Stopping trajectory of the drives (Sweep) as displacements of all joints of a robot [rad or m]: s·way + t·tick + o,
/// where s and t increase from 0 to 1, and low ≤ o ≤ high.
///
/// The displacement r = t·tick + o is the deviation from the straight line s·way: docs/clearance.md, "Algorithm".
template <typename Clearance>
struct JointSweep {
  using Scalar = typename Clearance::Scalar;
  using AllJoints = typename Clearance::AllJoints;

  AllJoints way;
  AllJoints tick;
  AllJoints low;
  AllJoints high;
  AllJoints rest;  ///< Bound e on |r|.

  template <int N>
  JointSweep(const Clearance& clearance, const Sweep<N, Scalar>& sweep) noexcept
      : JointSweep(clearance.robot().drives(), sweep) {}

  /// Smallest gᵀr, for a gradient g [m/rad or 1]: the largest decrease of a gap by the deviation r.
  [[nodiscard]] Scalar least(const AllJoints& gradient) const noexcept {
    return least_of_own(gradient) + std::min(gradient.dot(tick), Scalar(0));
  }
  /// Smallest gᵀo: the part of least() by joints that follow their own shortest stop.
  [[nodiscard]] Scalar least_of_own(const AllJoints& gradient) const noexcept {
    return gradient.cwiseProduct(low).cwiseMin(gradient.cwiseProduct(high)).sum();
  }
  /// Whether gᵀ(s·way + t·tick) ≥ 0 along the whole trajectory, because this sum consists of nonnegative multiples of
  /// `begun` and −tick. begun: joint velocities at the start of the trajectory [rad/s or m/s].
  [[nodiscard]] bool opens(const AllJoints& gradient, const AllJoints& begun) const noexcept {
    return gradient.dot(begun) >= Scalar(0) && gradient.dot(tick) <= Scalar(0);
  }

 private:
  template <typename Drives, int N>
  JointSweep(const Drives& drives, const Sweep<N, Scalar>& sweep) noexcept
      : way(drives.rates(sweep.way)),
        tick(drives.rates(sweep.tick)),
        low(drives.least(sweep.low, sweep.high)),
        high(-drives.least(-sweep.high, -sweep.low)),
        rest(tick.cwiseAbs() + high.cwiseMax(-low)) {}
};

/// Decrease of a gap by joints that follow their own shortest stop, beyond the decrease at constant velocity for a time
/// T: Σ_k max(min(g_k q̇_k T, 0) − min(g_k low_k, g_k high_k), 0) [m]. gradient: g. speed: q̇. time: T [s].
template <typename Clearance, typename Scalar>
[[nodiscard]] Scalar beyond_slope(const JointSweep<Clearance>& sweep, const typename Clearance::AllJoints& speed,
                                  const typename Clearance::AllJoints& gradient, Scalar time) noexcept {
  Scalar beyond(0);
  for (Eigen::Index k = 0; k < gradient.size(); ++k) {
    const Scalar least = std::min(gradient(k) * sweep.low(k), gradient(k) * sweep.high(k));
    const Scalar slope = std::min(gradient(k) * speed(k) * time, Scalar(0));
    beyond += std::max(slope - least, Scalar(0));
  }
  return beyond;
}

/// Largest t ≤ whole with gap − slope t − bend t² ≥ 0; −1 if the gap is negative, or a number is NaN. The form of the
/// root avoids cancellation.
template <typename Scalar>
[[nodiscard]] Scalar furthest(Scalar gap, Scalar slope, Scalar bend, Scalar whole) noexcept {
  using std::sqrt;
  if (!(gap >= Scalar(0))) return Scalar(-1);
  if (gap >= whole * (slope + whole * bend)) return whole;
  const Scalar t = Scalar(2) * gap / (slope + sqrt(slope * slope + Scalar(4) * bend * gap));
  return t >= Scalar(0) ? t : Scalar(-1);
}

}  // namespace fpbm
