#pragma once

#include <algorithm>
#include <cmath>

#include "fpbm/limits/detail/stop_part.hpp"
#include "fpbm/limits/detail/stop_plan.hpp"

namespace fpbm {

/// Motion of a joint from the start of a StopPlan, in closed form. v: velocity after the ramp. a: acceleration before
/// the plan.
template <typename Scalar>
struct StopProgress {
  Scalar velocity;  ///< The velocity is velocity · v − ramp_velocity · h a.
  Scalar ramp_velocity;
  Scalar line;  ///< The displacement is line · h v + ramp · h² a.
  Scalar ramp;

  /// After k ticks of the ramp, which has `ticks` ticks: a sum over the accelerations a (1 − (j + 1)/ticks), j < k.
  [[nodiscard]] static StopProgress in_ramp(Scalar k, Scalar ticks) noexcept {
    const Scalar whole = std::max(ticks - Scalar(1), Scalar(0)) / Scalar(2);
    const Scalar r = std::max(ticks, Scalar(1));
    return {Scalar(1), whole - k + k * (k + Scalar(1)) / (Scalar(2) * r), k,
            k * (k / Scalar(2) - whole) - k * (k + Scalar(1)) * (Scalar(2) * k + Scalar(1)) / (Scalar(12) * r)};
  }
  /// After k ticks of the whole plan.
  [[nodiscard]] static StopProgress after(Scalar k, Scalar ramp_ticks, const StopProfile<Scalar>& profile) noexcept {
    if (k < ramp_ticks) return in_ramp(k, ramp_ticks);
    const auto [velocity, distance] = profile.after(k);
    return {velocity, Scalar(0), distance, in_ramp(ramp_ticks, ramp_ticks).ramp};
  }
};

/// advance() for joint i, which follows its own shortest stop.
template <int N, typename Scalar>
void advance_alone(const Limits<Level::kAcceleration, N, Scalar>& limits, Eigen::Index i, Scalar ticks,
                   StopPart<N, Scalar>& part) noexcept {
  const Scalar h = limits.tick();
  auto& [q, qd] = part.state;
  part.speed(i) = std::abs(qd(i));
  for (Scalar k(0); k < ticks; k += Scalar(1)) {
    const Scalar u = brake_alone(limits, i, part.state, part.last);
    part.low(i) = k > Scalar(0) ? std::min(part.low(i), u) : u;
    part.high(i) = k > Scalar(0) ? std::max(part.high(i), u) : u;
    q(i) += h * (qd(i) + h / Scalar(2) * u);
    qd(i) += h * u;
    part.speed(i) = std::max(part.speed(i), std::abs(qd(i)));
    part.last(i) = u;
    part.ticks_alone += Scalar(1);
    if (u == Scalar(0) && qd(i) == Scalar(0)) break;  // A slow stop of the other joints may take 50 times as long.
  }
}

/// Advances a plan by a number of ticks, 1 to ticks_left(), as so many calls of next(): in closed form for joints that
/// brake in proportion. Updates part.state and part.last, and sets the other members of the part.
template <int N, typename Scalar>
void advance(StopPlan<Level::kAcceleration, N, Scalar>& plan, const Limits<Level::kAcceleration, N, Scalar>& limits,
             Scalar ticks, StopPart<N, Scalar>& part) noexcept {
  const Scalar h = limits.tick();
  const Scalar end = plan.k_ + ticks;
  const auto from = StopProgress<Scalar>::after(plan.k_, plan.ramp_ticks_, plan.profile_);
  const auto to = StopProgress<Scalar>::after(end, plan.ramp_ticks_, plan.profile_);
  // Factors of the accelerations: of a in the ramp, and of v/h in the brake.
  const Scalar ramp_end = std::min(end, plan.ramp_ticks_);
  const bool ramps = plan.k_ < ramp_end;
  const bool brakes = ramp_end < end;
  const Scalar ramp_first = ramps ? Scalar(1) - (plan.k_ + Scalar(1)) / plan.ramp_ticks_ : Scalar(0);
  const Scalar ramp_last = ramps ? Scalar(1) - ramp_end / plan.ramp_ticks_ : Scalar(0);
  const auto brake = plan.profile_.removed_fractions(std::max(plan.k_, ramp_end), end - Scalar(1));
  const Scalar removed = plan.profile_.removed_fraction(end - Scalar(1));
  part.alone = plan.stops_alone_;
  part.ticks_alone = Scalar(0);
  const bool pauses = ramps && brakes;  // At the end of the ramp.
  part.pauses = pauses && part.alone == 0;
  part.corner_count = pauses ? (part.pauses ? 3 : 4) : 2;
  for (Eigen::Index i = 0; i < plan.last_.size(); ++i) {
    if (plan.stops_alone(i)) {
      advance_alone(limits, i, ticks, part);
      for (auto& corner : part.corners) corner(i) = (part.low(i) + part.high(i)) / Scalar(2);
      continue;
    }
    const Scalar a = plan.last_(i);
    const Scalar v = plan.velocity_(i);
    const Scalar before = part.state.qd(i);
    const Scalar after = to.velocity * v - h * to.ramp_velocity * a;
    part.state.q(i) += h * (to.line - from.line) * v + h * h * (to.ramp - from.ramp) * a;
    part.state.qd(i) = after;
    part.speed(i) = std::max({std::abs(before), std::abs(after), ramps && brakes ? std::abs(v) : Scalar(0)});
    auto& corners = part.corners;
    std::size_t corner = 0;
    if (ramps) corners[corner++](i) = ramp_first * a;
    if (ramps && !brakes) corners[corner++](i) = ramp_last * a;
    if (brakes) {
      corners[corner++](i) = -brake.low * v / h;
      corners[corner++](i) = -brake.high * v / h;
    }
    part.low(i) = std::min(corners[0](i), corners[1](i));
    part.high(i) = std::max(corners[0](i), corners[1](i));
    if (pauses) {
      corners[3](i) = Scalar(0);
      part.low(i) = std::min({part.low(i), corners[2](i), Scalar(0)});
      part.high(i) = std::max({part.high(i), corners[2](i), Scalar(0)});
    }
    part.last(i) = brakes ? -removed * v / h : ramp_last * a;
  }
  plan.k_ = end;
  part.line = ramps || plan.stops_alone_ != 0 ? Scalar(0) : h * (to.line - from.line);
}

}  // namespace fpbm
