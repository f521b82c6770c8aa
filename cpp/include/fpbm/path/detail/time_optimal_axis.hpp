#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "fpbm/core/detail/quickest_stop.hpp"

namespace fpbm {

/// Time-optimal motion of one axis to a target at rest, within bounds V, A and J on velocity, acceleration and jerk.
///
/// Let d be the sign of the displacement from the end of the quickest stop to the target. The axis changes its velocity
/// to d V in minimum time until the quickest stop ends at the target, and then stops. During the change of velocity,
/// the end of the quickest stop never moves away from the target. The switching time is therefore the root of a
/// monotonic function.
template <typename Scalar>
struct TimeOptimalAxis {
  Scalar velocity;  ///< V, positive and finite.
  QuickestStop<Scalar> stop;

  /// The velocity within the bound that is nearest to v.
  [[nodiscard]] Scalar nearest_velocity(Scalar v) const noexcept { return std::min(std::max(v, -velocity), velocity); }

  /// State after `seconds` [s] of a time-optimal change to the velocity `desired`.
  [[nodiscard]] AxisState<Scalar> change(const AxisState<Scalar>& state, Scalar desired,
                                         Scalar seconds) const noexcept {
    AxisState<Scalar> next = stop.ahead({state.q, state.v - desired, state.a}, seconds);
    next.q += seconds * desired;
    next.v += desired;
    return next;
  }

  /// State after `seconds` [s] of the motion to a target. The state is relative to the target, whose velocity is within
  /// the bound. If the quickest stop ends within the tolerance of the target, the axis follows this stop and ends
  /// exactly at the target: round-off errors cause no jerk.
  [[nodiscard]] AxisState<Scalar> approach(const AxisState<Scalar>& state, Scalar target, Scalar target_velocity,
                                           Scalar seconds, Scalar tolerance) const noexcept {
    const Scalar left = target - stop.end_position(state);
    AxisState<Scalar> from = state;
    Scalar gone(0);
    if (!(std::abs(left) <= tolerance)) {
      const Scalar d = left < Scalar(0) ? Scalar(-1) : Scalar(1);
      const Scalar desired = d * velocity - target_velocity;
      const auto beyond = [&](Scalar t) noexcept {
        return d * (stop.end_position(change(state, desired, t)) - target);
      };
      gone = largest_below_zero(beyond, Scalar(0), seconds, kRounds);
      from = change(state, desired, gone);
    }
    AxisState<Scalar> next = stop.ahead(from, seconds - gone);
    if (next.v == Scalar(0) && next.a == Scalar(0) && std::abs(next.q - target) <= tolerance) next.q = target;
    return next;
  }

  /// Tolerance for ticks of length h [s]: the larger of the round-off error and a part of J h³, the displacement of a
  /// tick at the bound on jerk. size: largest coordinate of the target, for the round-off error. part: factor of J h³.
  ///
  /// Factors of 1e-6 to 1e-2 of J h³, and of 1 to 80 epsilon, pass TargetTurn.* and TargetStream*. With 1e-7 of J h³,
  /// TargetTurn.* fails.
  [[nodiscard]] Scalar tolerance(const AxisState<Scalar>& state, Scalar size, Scalar h,
                                 Scalar part = Scalar(1e-6)) const noexcept {
    const Scalar round_off = Scalar(8) * std::numeric_limits<Scalar>::epsilon();
    return std::max(part * stop.jerk * h * h * h, round_off * (size + std::abs(stop.end_position(state))));
  }

 private:
  /// Rounds of largest_below_zero(). For any number of rounds, the stop does not end beyond the target. With 12,
  /// TargetTurn.from_a_motion fails.
  static constexpr int kRounds = 16;
};

}  // namespace fpbm
