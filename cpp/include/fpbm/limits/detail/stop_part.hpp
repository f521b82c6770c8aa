#pragma once

#include "fpbm/core/types.hpp"

namespace fpbm {

/// Some ticks of a StopPlan.
template <int N, typename Scalar = double>
struct StopPart {
  State<N, Scalar> state;   ///< At the end of the part; before advance(), at its start.
  Vector<N, Scalar> last;   ///< Accelerations of the last tick; before advance(), of the tick before the part.
  Vector<N, Scalar> low;    ///< Smallest accelerations.
  Vector<N, Scalar> high;   ///< Largest accelerations.
  Vector<N, Scalar> speed;  ///< Largest speeds.
  /// If all joints move along their velocities after the ramp: the time in which these velocities would cover the
  /// displacement of the part [s]. Otherwise 0.
  Scalar line = Scalar(0);
};

}  // namespace fpbm
