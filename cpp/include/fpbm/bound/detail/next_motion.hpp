#pragma once

#include "fpbm/limits/detail/stop.hpp"
#include "fpbm/limits/limits.hpp"

namespace fpbm {

/// Motion of the next tick, which bounds restrict by rows.
template <Level kLevel_, int N, typename Scalar = double>
struct NextMotion {
  static constexpr Level kLevel = kLevel_;

  const Limits<kLevel, N, Scalar>& limits;
  const State<N, Scalar>& state;        ///< At the start of the tick.
  const Vector<N, Scalar>& u;           ///< Desired motion: accelerations [rad/s²], or velocities [rad/s].
  const Stop<kLevel, N, Scalar>& stop;  ///< The planned stop, from the start of the tick before.
  Scalar acting_ticks;                  ///< StopPlan::acting_ticks().
  /// The motion lasts at least this fraction of limits.tick(). 1, except for a measured state.
  Scalar least_fraction = Scalar(1);
};

}  // namespace fpbm
