#pragma once

#include "fpbm/limits/detail/stop_plan.hpp"

namespace fpbm {

/// Stopping trajectory after a tick, with bounds on the displacement from the start of the tick until rest.
template <Level kLevel, int N, typename Scalar = double>
struct Stop {
  StopPlan<kLevel, N, Scalar> plan;
  StopDisplacement<N, Scalar> displacement;
  Scalar time;             ///< Duration of the tick and of the stop [s].
  State<N, Scalar> start;  ///< State after the tick.

  /// The stop of an arm at rest.
  [[nodiscard]] static Stop at_rest(Eigen::Index dof) {
    const auto zero = filled<Vector<N, Scalar>>(dof);
    return {StopPlan<kLevel, N, Scalar>(dof), StopDisplacement<N, Scalar>::none(dof), Scalar(0), {zero, zero}};
  }

  /// The stop after a tick from a state to another, with the acceleration `last`. fraction: of the bounds on
  /// deceleration.
  [[nodiscard]] static Stop after(const Limits<kLevel, N, Scalar>& limits, const State<N, Scalar>& from,
                                  const State<N, Scalar>& to, const Vector<N, Scalar>& last,
                                  Scalar fraction = Scalar(1)) noexcept {
    const StopPlan<kLevel, N, Scalar> plan(limits, to, last, fraction);
    return {plan, plan.displacement(limits, from, to), limits.tick() * (Scalar(1) + plan.ticks_left()), to};
  }
};

}  // namespace fpbm
