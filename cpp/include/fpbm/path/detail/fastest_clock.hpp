#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "fpbm/core/detail/validation.hpp"
#include "fpbm/model/joint.hpp"
#include "fpbm/path/detail/clock_bounds.hpp"
#include "fpbm/path/detail/clock_limits.hpp"
#include "fpbm/path/detail/clock_solver.hpp"
#include "fpbm/path/detail/given_speeds.hpp"
#include "fpbm/path/path.hpp"
#include "fpbm/path/spline.hpp"

namespace fpbm {

/// Clock p(t) that moves an arm along a joint path q(p) in the least time within its bounds on velocity, acceleration
/// and jerk, from rest to rest or with given speeds: minimises ∫ dp/ṗ (docs/paths.md, Paths in the least time).
///
/// The joint path is at rest at an end without a given speed (q′ = q″ = 0), so that ṗ is positive everywhere, and the
/// clock is a smooth function. The joint path, not the clock, makes the motion begin and end at rest. Allocates at
/// construction and in stretch(), never in at().
class FastestClock {
 public:
  /// limits: bounds on velocity (with the braking envelopes), acceleration and jerk, which may be infinite if the
  /// acceleration is finite. add_bounds(p, d, bounds) adds other bounds at a place p to its ClockBounds; d: q, q′, q″
  /// and so on. Throws std::invalid_argument if a bound is missing, a joint leaves its range, the path has no length,
  /// or the bounds do not admit the given speeds.
  template <int N, typename AddBounds>
  FastestClock(const Spline<N>& joints, const JointLimits<N>& limits, const AddBounds& add_bounds,
               const GivenSpeeds& given = {})
      : start_(joints.times().front()), clock_(joints.times().size() - 1, width_of(joints)) {
    const JointLimits<N> complete = limits.complete();
    require_clock_limits(complete);
    const auto at = [&](std::size_t i, double f) {
      const double p = start_ + (static_cast<double>(i) + f) * clock_.width();
      const auto d = joints.derivatives(i, p);
      ClockBounds place =
          clock_bounds(d, complete, (p - start_) / (clock_.width() * static_cast<double>(clock_.intervals())));
      add_bounds(p, d, place);
      return place;
    };
    std::vector<std::array<ClockBounds, 3>> bounds;
    bounds.reserve(clock_.intervals());
    double unit = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < clock_.intervals(); ++i) {
      bounds.push_back({at(i, 0.0), at(i, 0.5), at(i, 1.0)});
      for (const ClockBounds& each : bounds.back()) unit = std::min(unit, each.largest());
    }
    if (!std::isfinite(unit)) validation::reject("path", ": has no length: no joint moves along it");
    given.require_within(bounds.front().front(), bounds.back().back());
    for (auto& interval : bounds) {
      for (ClockBounds& each : interval) each.scale(unit);
    }
    // Between the places of the solver, a clock may exceed bounds, where y changes much within an interval. Then the
    // bounds of this interval are tightened. Rounds after the second gain less than 1e-4 of the duration.
    // With given speeds, a blend is more expensive than a lower rate, and two more rounds gain up to 2 %.
    const int rounds = given.any() ? 4 : 2;
    constexpr double kExcess = 1e-4;
    constexpr int kChecks = 8;
    // Between the checks, most random motions exceed no bound by more than kSafety.
    constexpr double kSafety = 2e-4;
    const auto slower_in = [&](std::size_t i) {
      double here = 1.0;
      for (int k = 0; k <= kChecks; ++k) {
        const double f = static_cast<double>(k) / kChecks;
        here = std::max(here, at(i, f).slower(clock_.at(i, f)));
      }
      return here;
    };
    double slower = 1.0;
    for (int round = 0; round < rounds; ++round) {
      ClockSolver solver(bounds, clock_.width());
      if (given.any()) {
        if (!solver.give_ends(given.squares(unit))) {
          if (round > 0) break;  // The tightened bounds do not admit the speeds.
          given.reject({unit * solver.clock().at(0, 0.0).y, unit * solver.clock().at(bounds.size() - 1, 1.0).y});
        }
        slow_ = solver.clock().coefficients();
        for (double& each : slow_) each *= unit;
      }
      clock_ = solver.solve();
      for (double& each : clock_.coefficients()) each *= unit;
      slower = 1.0;
      for (std::size_t i = 0; i < clock_.intervals(); ++i) {
        const double here = slower_in(i);
        for (ClockBounds& each : bounds[i]) each.scale(here * here);
        slower = std::max(slower, here);
      }
      if (slower < 1.0 + kExcess) break;
    }
    times_.resize(clock_.intervals() + 1, 0.0);
    if (slow_.empty()) {
      blend(0.0);
      rate_ = 1.0 / (slower * (1.0 + kSafety));
      return;
    }
    for (double share = kExcess; share < 1.0; share *= 2.0) {
      blend(share);
      slower = 1.0;
      for (std::size_t i = 0; i < clock_.intervals(); ++i) slower = std::max(slower, slower_in(i));
      if (slower < 1.0 + 1e-9) break;  // Round-off of a given speed on its bound.
    }
  }

  /// Duration of the motion [s].
  [[nodiscard]] double duration() const noexcept { return times_.back() / rate_; }

  /// Slows the clock everywhere by one factor; with given speeds, toward a slower clock with these speeds. Throws
  /// std::invalid_argument if duration [s] is below duration(), or above the duration of the slower clock.
  void stretch(double duration) {
    if (!(duration >= this->duration())) validation::fail("duration", duration, "at least ", this->duration());
    if (slow_.empty()) {
      rate_ = times_.back() / duration;
      return;
    }
    const ClockSpline fast = clock_;
    const auto blended = [&](double share) {
      clock_ = fast;
      blend(share);
      return this->duration();
    };
    double low = 0.0;
    double high = 1.0;
    if (!(blended(high) >= duration)) {
      validation::reject("start_speed", " and end_speed: a motion of ", duration,
                         " s, a multiple of dt, cannot have these speeds: choose lower speeds, or a shorter dt");
    }
    for (double middle = 0.5; low < middle && middle < high; middle = (low + high) / 2.0) {
      (blended(middle) < duration ? low : high) = middle;
    }
    blended(high);
  }

  /// Time at which the clock is at p [s].
  [[nodiscard]] double time_at(double p) const noexcept {
    const double place = std::max((p - start_) / clock_.width(), 0.0);
    const std::size_t i = std::min(static_cast<std::size_t>(place), clock_.intervals() - 1);
    return (times_[i] + time_in(i, place - static_cast<double>(i))) / rate_;
  }

  /// p, ṗ and p̈ at t [s]; outside of the motion, at the nearest end.
  [[nodiscard]] Phase<double> at(double t) const noexcept {
    const double own = std::clamp(t * rate_, 0.0, times_.back());
    const auto after = std::upper_bound(times_.begin() + 1, times_.end() - 1, own);
    const auto i = static_cast<std::size_t>(after - times_.begin()) - 1;
    // Newton's method for the fraction of the interval at which the time is `own`.
    double f = (own - times_[i]) / (times_[i + 1] - times_[i]);
    double change = 1.0;
    for (int k = 0; k < kNewtonSteps && std::abs(change) > kLastChange; ++k) {
      change = (own - times_[i] - time_in(i, f)) * std::sqrt(clock_.at(i, f).y) / clock_.width();
      f = std::clamp(f + change, 0.0, 1.0);
    }
    const ClockState state = clock_.at(i, f);
    return {start_ + (static_cast<double>(i) + f) * clock_.width(), rate_ * std::sqrt(state.y),
            rate_ * rate_ * state.y1 / 2.0};
  }

 private:
  static constexpr int kNewtonSteps = 12;      // Usually 2 or 3; 8 if y changes by 1e8 within an interval.
  static constexpr double kLastChange = 1e-8;  // Newton's method squares the error: the next change is round-off.

  template <int N>
  static double width_of(const Spline<N>& joints) noexcept {
    const auto& p = joints.times();
    return (p.back() - p.front()) / static_cast<double>(p.size() - 1);
  }

  /// Blends the clock with the share `share` of the slower clock. The rates at the ends are equal.
  void blend(double share) {
    std::vector<double>& c = clock_.coefficients();
    for (std::size_t i = 0; i < slow_.size(); ++i) c[i] += share * (slow_[i] - c[i]);
    for (std::size_t i = 0; i < clock_.intervals(); ++i) times_[i + 1] = times_[i] + time_in(i, 1.0);
  }

  /// Time from the start of interval i to its fraction f [s], by the rule of Gauss with 5 points. The rule is not exact
  /// where y changes by orders of magnitude within an interval, near a low given speed.
  [[nodiscard]] double time_in(std::size_t i, double f) const noexcept {
    if (!slow_.empty()) return clock_.time(i, f);
    constexpr std::array<double, 5> kPoints{0.5, 0.2307653449471584, 0.7692346550528416, 0.0469100770306680,
                                            0.9530899229693320};
    constexpr std::array<double, 5> kWeights{0.2844444444444444, 0.2393143352496832, 0.2393143352496832,
                                             0.1184634425280945, 0.1184634425280945};
    double sum = 0.0;
    for (std::size_t k = 0; k < 5; ++k) sum += kWeights[k] / std::sqrt(clock_.at(i, f * kPoints[k]).y);
    return sum * f * clock_.width();
  }

  double start_;
  double rate_ = 1.0;  ///< Rate of the clock relative to the solution.
  ClockSpline clock_;
  std::vector<double> slow_;   ///< Coefficients of a slower clock, if the speeds at the ends are given.
  std::vector<double> times_;  ///< Time of the solution at the start of each interval, and at the end.
};

}  // namespace fpbm
