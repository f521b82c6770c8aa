#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "fpbm/bound/detail/next_motion.hpp"
#include "fpbm/limits/detail/stop.hpp"
#include "fpbm/path/detail/fastest_clock.hpp"
#include "fpbm/path/spline.hpp"

namespace fpbm {

/// The factors by which a clock p(t) is slower in intervals of p than its bounds admit, so that the bounds of a tracker
/// accept a stop in each tick.
class SlowerIntervals {
 public:
  static constexpr std::size_t kCount = 600;
  using Factors = std::array<double, kCount>;

  /// duration: largest p.
  explicit SlowerIntervals(double duration) : duration_(duration) { factors_.fill(1.0); }

  [[nodiscard]] double at(double p) const noexcept { return factors_[interval(p)]; }
  [[nodiscard]] std::size_t interval(double p) const noexcept {
    return std::min(static_cast<std::size_t>(std::max(p, 0.0) / duration_ * kCount), kCount - 1);
  }

  /// Multiplies each factor by the largest of the given factors nearby.
  void slow_down(const Factors& factors) noexcept {
    constexpr std::size_t kNear = kCount / 100;
    for (std::size_t i = 0; i < kCount; ++i) {
      const auto begin = factors.begin() + static_cast<std::ptrdiff_t>(i - std::min(i, kNear));
      const auto end = factors.begin() + static_cast<std::ptrdiff_t>(std::min(i + kNear + 1, kCount));
      factors_[i] *= *std::max_element(begin, end);
    }
  }

 private:
  double duration_;
  Factors factors_;
};

/// Whether the bounds accept a tick from a state with the accelerations u, and a stop after the tick (prove()).
template <int N, typename Kept>
[[nodiscard]] bool accepts_stop(Kept& bounds, const Limits<Level::kAcceleration, N>& limits, const State<N>& from,
                                const Vector<N>& u) {
  using StopOf = Stop<Level::kAcceleration, N>;
  const double h = limits.tick();
  const State<N> to{from.q + h * (from.qd + h / 2.0 * u), from.qd + h * u};
  const StopOf rest = StopOf::at_rest(from.q.size());
  (void)bounds.rows(NextMotion<Level::kAcceleration, N>{limits, from, u, rest, 0.0});
  for (double fraction = 1.0; fraction > 0.0; fraction = bounds.slower_stop(fraction)) {
    if (bounds.accepts(limits, from, StopOf::after(limits, from, to, u, fraction))) return true;
  }
  return false;
}

/// Slows a clock down where the bounds do not accept the stop of a tracker, so that they accept the stop from a motion
/// that is faster by a factor `faster`. Returns the number of intervals with a stop that is not accepted.
template <int N, typename Kept>
int slow_down(SlowerIntervals& slower, const Spline<N>& joints, const FastestClock& clock, Kept& bounds,
              const Limits<Level::kAcceleration, N>& limits, double faster) {
  constexpr double kStep = 0.95;  // Factor between attempts.
  constexpr double kSlowest = 0.05;
  const double h = limits.tick();
  const auto ticks = static_cast<int>(std::lround(clock.duration() / h));
  const auto state = [&](double p, double rate) {
    const auto at = joints.at(p);
    return State<N>{at.x, at.xd * rate};
  };
  SlowerIntervals::Factors factors;
  factors.fill(1.0);
  Phase<double> phase = clock.at(0.0);
  for (int k = 1; k <= ticks; ++k) {
    const Phase<double> next = clock.at(k * h);
    const State<N> from = state(phase.s, phase.sd);
    const Vector<N> u = (state(next.s, next.sd).qd - from.qd) / h;
    double f = 1.0;
    while (f > kSlowest && !accepts_stop(bounds, limits, State<N>{from.q, f * from.qd}, Vector<N>(f * f * u))) {
      f *= kStep;
    }
    double& factor = factors[slower.interval(phase.s)];
    if (f < 1.0) factor = std::max(factor, faster / f);
    phase = next;
  }
  slower.slow_down(factors);
  return static_cast<int>(std::count_if(factors.begin(), factors.end(), [](double factor) { return factor > 1.0; }));
}

}  // namespace fpbm
