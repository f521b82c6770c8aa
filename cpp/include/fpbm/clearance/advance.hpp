#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "fpbm/clearance/separation.hpp"
#include "fpbm/limits/stop_plan.hpp"
#include "fpbm/linalg/sums.hpp"

namespace fpbm {

/// A sweep of a robot's drives, as one of its joints.
template <typename Clearance>
struct JointSweep {
  using Scalar = typename Clearance::Scalar;
  using AllJoints = typename Clearance::AllJoints;

  AllJoints way;
  AllJoints tick;
  AllJoints low;
  AllJoints high;
  AllJoints rest;  ///< Most that all but `way` displaces a joint, either way.

  template <int N>
  JointSweep(const Clearance& clearance, const Sweep<N, Scalar>& sweep) noexcept
      : JointSweep(clearance.robot().drives(), sweep) {}

  /// Least that all but `way` adds to what has this gradient.
  [[nodiscard]] Scalar least(const AllJoints& gradient) const noexcept {
    return least_of_own(gradient) + std::min(gradient.dot(tick), Scalar(0));
  }
  /// The same of low and high alone.
  [[nodiscard]] Scalar least_of_own(const AllJoints& gradient) const noexcept {
    return gradient.cwiseProduct(low).cwiseMin(gradient.cwiseProduct(high)).sum();
  }
  /// Whether `way` and `tick` together never reduce what has this gradient. begun: of the sweep, by the joints.
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

/// What joints that take their own quickest stop may take from a gap, beyond its slope at their speed for some time.
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

/// Most of a gap's rest of the way, up to `whole`, that surely leaves a gap above zero; below zero where there is none.
template <typename Scalar>
[[nodiscard]] Scalar furthest(Scalar gap, Scalar slope, Scalar bend, Scalar whole) noexcept {
  using std::sqrt;
  if (!(gap >= Scalar(0))) return Scalar(-1);
  if (gap >= whole * (slope + whole * bend)) return whole;
  return Scalar(2) * gap / (slope + sqrt(slope * slope + Scalar(4) * bend * gap));
}

}  // namespace fpbm
