#pragma once

#include "fpbm/core/types.hpp"

namespace fpbm {

/// Part of a stopping trajectory: some ticks of a StopPlan.
template <int N, typename Scalar = double>
struct StopPart {
  State<N, Scalar> state;   ///< At the end of the part.
  Vector<N, Scalar> last;   ///< Acceleration of the last tick.
  Vector<N, Scalar> low;    ///< Smallest accelerations.
  Vector<N, Scalar> high;   ///< Largest accelerations.
  Vector<N, Scalar> speed;  ///< Largest speeds.
  /// If the joints move along their velocities after the ramp: time in which they would cover the distance of the part
  /// at these velocities [s]. Otherwise 0.
  Scalar along = Scalar(0);
  Scalar turned = Scalar(0);  ///< Angle by which the links turn in this time, at most [rad].
};

/// Motion of a joint from the start of a StopPlan. v: velocity after the ramp. a: acceleration before the plan.
template <typename Scalar>
struct StopProgress {
  Scalar velocity;  ///< The velocity is velocity · v − ramp_velocity · h a.
  Scalar ramp_velocity;
  Scalar line;  ///< The displacement is line · h v + ramp · h² a.
  Scalar ramp;
};

}  // namespace fpbm
