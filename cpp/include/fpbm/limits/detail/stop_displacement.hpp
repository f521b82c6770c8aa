#pragma once

#include "fpbm/core/types.hpp"

namespace fpbm {

/// Bounds on the joint displacements during a motion: at any time, the displacement from the start is
/// s·line + t·ramp_correction + o [rad] or [m]. s and t increase from 0 to 1, and each entry of o is between low and
/// high.
template <int N, typename Scalar = double>
struct StopDisplacement {
  Vector<N, Scalar> line;             ///< Displacement at the constant velocity after the ramp.
  Vector<N, Scalar> ramp_correction;  ///< Correction of `line` for the last tick and the ramp.
  Vector<N, Scalar> low;              ///< ≤ 0
  Vector<N, Scalar> high;             ///< ≥ 0
  /// Velocities in which the motion begins [rad/s]: before the last tick, or in the last tick at velocity level, where
  /// the velocities of a tick are constant. s·line + t·ramp_correction is a combination of `start_velocity` and
  /// −ramp_correction with non-negative coefficients (docs/clearance_proof.md, "First-order terms").
  Vector<N, Scalar> start_velocity;

  /// Displacement of n joints at rest.
  [[nodiscard]] static StopDisplacement none(Eigen::Index n) {
    const auto zero = filled<Vector<N, Scalar>>(n);
    return {zero, zero, zero, zero, zero};
  }
};

}  // namespace fpbm
