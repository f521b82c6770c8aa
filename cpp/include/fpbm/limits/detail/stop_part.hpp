#pragma once

#include <array>

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
  /// All accelerations are convex combinations of the first `corner_count` corners, and of 0 if `pauses`, apart from
  /// joints in `alone`, which are at the middle of `low` and `high` in the corners.
  std::array<Vector<N, Scalar>, 4> corners;
  std::size_t corner_count = 0;
  bool pauses = false;
  JointBits alone = 0;             ///< Bits of joints that follow their own shortest stops.
  Scalar ticks_alone = Scalar(0);  ///< Computed ticks of these joints.
  /// If all joints move along their velocities after the ramp: the time in which these velocities would cover the
  /// displacement of the part [s]. Otherwise 0.
  Scalar line = Scalar(0);

  /// Before the first part, of a state that is reached with the accelerations `before`. Only `state` and `last` are
  /// set.
  StopPart(const State<N, Scalar>& from, const Vector<N, Scalar>& before) : state(from), last(before) {
    for (auto* each : {&low, &high, &speed, &corners[0], &corners[1], &corners[2], &corners[3]}) {
      each->resize(before.size());
    }
  }
};

}  // namespace fpbm
