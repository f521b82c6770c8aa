#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "fpbm/core/quickest_stop.hpp"

namespace fpbm {

/// One axis that goes to a target at rest in the least time, within bounds V, A and J on its velocity, acceleration and
/// jerk.
///
/// With d the sign of the way from where the quickest stop would end to the target, the axis changes its velocity to
/// d V as fast as it can until the quickest stop ends at the target, and then stops. While it goes, the stop's end
/// never recedes from the target, so the moment is the root of a monotone function.
template <typename Scalar>
struct TimeOptimalAxis {
  Scalar velocity;  ///< V, positive and finite.
  QuickestStop<Scalar> stop;

  /// Some seconds later where the velocity changes to a wanted one as fast as it can.
  [[nodiscard]] AxisState<Scalar> change(const AxisState<Scalar>& state, Scalar wanted, Scalar seconds) const noexcept {
    AxisState<Scalar> next = stop.ahead({state.q, state.v - wanted, state.a}, seconds);
    next.q += seconds * wanted;
    next.v += wanted;
    return next;
  }

  /// Some seconds later on the way to a target, in its frame, which moves at a velocity within the bound.
  /// A stop that ends nearer than the tolerance is followed, and ends at the target exactly: no round-off becomes jerk.
  [[nodiscard]] AxisState<Scalar> approach(const AxisState<Scalar>& state, Scalar target, Scalar target_velocity,
                                           Scalar seconds, Scalar tolerance) const noexcept {
    const Scalar left = target - stop.rest(state);
    AxisState<Scalar> from = state;
    Scalar gone(0);
    if (!(std::abs(left) <= tolerance)) {
      const Scalar d = left < Scalar(0) ? Scalar(-1) : Scalar(1);
      const Scalar wanted = d * velocity - target_velocity;
      const auto beyond = [&](Scalar t) noexcept { return d * (stop.rest(change(state, wanted, t)) - target); };
      gone = largest_below_zero(beyond, Scalar(0), seconds, kRounds);
      from = change(state, wanted, gone);
    }
    AxisState<Scalar> next = stop.ahead(from, seconds - gone);
    if (next.v == Scalar(0) && next.a == Scalar(0) && std::abs(next.q - target) <= tolerance) next.q = target;
    return next;
  }

  /// A tolerance for ticks of length h: round-off, and a millionth of a tick's way at the bound on jerk.
  /// size: of the numbers that the target comes from.
  [[nodiscard]] Scalar tolerance(const AxisState<Scalar>& state, Scalar size, Scalar h) const noexcept {
    const Scalar round_off = Scalar(8) * std::numeric_limits<Scalar>::epsilon();
    return std::max(Scalar(1e-6) * stop.jerk * h * h * h, round_off * (size + std::abs(stop.rest(state))));
  }

 private:
  static constexpr int kRounds = 16;  ///< After which the end is off by 2e-8 J h³ at most.
};

}  // namespace fpbm
