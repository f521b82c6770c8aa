#pragma once

#include <algorithm>

#include "fpbm/limits/detail/stop_plan.hpp"

namespace fpbm {

/// Stopping trajectory of the drives (StopDisplacement) as displacements of all joints of a robot [rad or m]:
/// s·line + t·ramp_correction + o, where s and t increase from 0 to 1, and low ≤ o ≤ high.
///
/// The displacement r = t·ramp_correction + o is the deviation from the straight line: docs/clearance_proof.md.
template <int Joints, typename Scalar>
struct JointDisplacement {
  using AllJoints = Vector<Joints, Scalar>;

  AllJoints line;
  AllJoints ramp_correction;
  AllJoints low;
  AllJoints high;
  AllJoints deviation;  ///< Bound e on |r|.

  template <typename Drives, int N>
  JointDisplacement(const Drives& drives, const StopDisplacement<N, Scalar>& stop) noexcept
      : line(drives.rates(stop.line)),
        ramp_correction(drives.rates(stop.ramp_correction)),
        low(drives.least(stop.low, stop.high)),
        high(-drives.least(-stop.high, -stop.low)),
        deviation(ramp_correction.cwiseAbs() + high.cwiseMax(-low)) {}

  /// Smallest gᵀr, for a gradient g [m/rad or 1]: the largest decrease of a gap by the deviation r.
  [[nodiscard]] Scalar least(const AllJoints& gradient) const noexcept {
    return least_of_single_stops(gradient) + std::min(gradient.dot(ramp_correction), Scalar(0));
  }
  /// Smallest gᵀo: the part of least() by joints that follow their own shortest stop.
  [[nodiscard]] Scalar least_of_single_stops(const AllJoints& gradient) const noexcept {
    return gradient.cwiseProduct(low).cwiseMin(gradient.cwiseProduct(high)).sum();
  }
  /// Sufficient condition for gᵀ(s·line + t·ramp_correction) ≥ 0 along the whole trajectory: this sum consists of
  /// nonnegative multiples of the start velocity and −ramp_correction. start_velocity: velocities of all joints
  /// [rad/s or m/s].
  [[nodiscard]] bool opens(const AllJoints& gradient, const AllJoints& start_velocity) const noexcept {
    return gradient.dot(start_velocity) >= Scalar(0) && gradient.dot(ramp_correction) <= Scalar(0);
  }
};

}  // namespace fpbm
