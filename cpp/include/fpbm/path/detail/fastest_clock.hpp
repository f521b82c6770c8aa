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
#include "fpbm/path/detail/clock_solver.hpp"
#include "fpbm/path/path.hpp"
#include "fpbm/path/spline.hpp"

namespace fpbm {

/// Clock p(t) that moves an arm along a joint path q(p) in the least time within its bounds on velocity, acceleration
/// and jerk, from rest to rest: minimises ∫ dp/ṗ (docs/paths.md, Paths in the least time).
///
/// The joint path is at rest at both ends (q′ = q″ = 0), so that ṗ is positive everywhere, and the clock is a smooth
/// function. The joint path, not the clock, makes the motion begin and end at rest. Allocates at construction, never in
/// at().
class FastestClock {
 public:
  /// limits: bounds on velocity (with the braking envelopes), acceleration and jerk, which may be infinite if the
  /// acceleration is finite. add_bounds(p, q, q′, bounds) adds other bounds at a place p to its ClockBounds. Throws
  /// std::invalid_argument if a bound is missing, a joint leaves its range, or the path has no length.
  template <int N, typename AddBounds>
  FastestClock(const Spline<N>& joints, const JointLimits<N>& limits, const AddBounds& add_bounds)
      : start_(joints.times().front()), clock_(joints.times().size() - 1, width_of(joints)) {
    const JointLimits<N> complete = limits.complete();
    require_acceleration(complete);
    const auto at = [&](std::size_t i, double f) {
      const double p = start_ + (static_cast<double>(i) + f) * clock_.width();
      const auto d = joints.derivatives(i, p);
      ClockBounds place = bounds_at<N>(d, complete, p);
      add_bounds(p, d[0], d[1], place);
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
    for (auto& interval : bounds) {
      for (ClockBounds& each : interval) each.scale(unit);
    }
    // Between the places of the solver, a clock may exceed bounds, where y changes much within an interval. Then the
    // bounds of this interval are tightened. Rounds after the second gain less than 1e-4 of the duration.
    constexpr int kRounds = 2;
    constexpr double kExcess = 1e-4;
    constexpr int kChecks = 8;
    // Between the checks, most random motions exceed no bound by more than kSafety.
    constexpr double kSafety = 2e-4;
    double slower = 1.0;
    for (int round = 0; round < kRounds; ++round) {
      clock_ = ClockSolver(bounds, limits.lower.size(), clock_.width()).solve();
      for (double& each : clock_.coefficients()) each *= unit;
      slower = 1.0;
      for (std::size_t i = 0; i < clock_.intervals(); ++i) {
        double here = 1.0;
        for (int k = 0; k <= kChecks; ++k) {
          const double f = static_cast<double>(k) / kChecks;
          here = std::max(here, at(i, f).slower(clock_.at(i, f)));
        }
        for (ClockBounds& each : bounds[i]) each.scale(here * here);
        slower = std::max(slower, here);
      }
      if (slower < 1.0 + kExcess) break;
    }
    times_.resize(clock_.intervals() + 1, 0.0);
    for (std::size_t i = 0; i < clock_.intervals(); ++i) times_[i + 1] = times_[i] + time_in(i, 1.0);
    rate_ = 1.0 / (slower * (1.0 + kSafety));
  }

  /// Duration of the motion [s].
  [[nodiscard]] double duration() const noexcept { return times_.back() / rate_; }

  /// Slows the clock everywhere by one factor. Throws std::invalid_argument if duration [s] is below duration().
  void stretch(double duration) {
    if (!(duration >= this->duration())) validation::fail("duration", duration, "at least ", this->duration());
    rate_ = times_.back() / duration;
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
    for (int k = 0; k < kNewtonSteps; ++k) {
      f += (own - times_[i] - time_in(i, f)) * std::sqrt(clock_.at(i, f).y) / clock_.width();
      f = std::clamp(f, 0.0, 1.0);
    }
    const ClockState state = clock_.at(i, f);
    return {start_ + (static_cast<double>(i) + f) * clock_.width(), rate_ * std::sqrt(state.y),
            rate_ * rate_ * state.y1 / 2.0};
  }

 private:
  static constexpr int kNewtonSteps = 5;  // 3 steps reach round-off in motions of all presets.

  template <int N>
  static double width_of(const Spline<N>& joints) noexcept {
    const auto& p = joints.times();
    return (p.back() - p.front()) / static_cast<double>(p.size() - 1);
  }

  template <int N>
  static void require_acceleration(const JointLimits<N>& limits) {
    for (Eigen::Index i = 0; i < limits.acceleration.size(); ++i) {
      const auto positive = [i](const char* name, double bound) {
        if (!(bound > 0.0)) validation::fail(validation::element(name, i), bound, "positive");
      };
      positive("limits.velocity", limits.velocity(i));
      positive("limits.acceleration", limits.acceleration(i));
      positive("limits.jerk", limits.jerk(i));
      if (!std::isfinite(limits.acceleration(i))) {
        validation::fail(validation::element("limits.acceleration", i), limits.acceleration(i),
                         "finite: the clock needs a bound on each acceleration");
      }
    }
  }

  template <int N>
  ClockBounds bounds_at(const std::array<Vector<N>, 6>& d, const JointLimits<N>& limits, double p) const {
    Vector<N> velocity = limits.velocity;
    for (Eigen::Index k = 0; k < velocity.size(); ++k) {
      const double q = d[0](k);
      if (q < limits.lower(k) - kRoundOff || q > limits.upper(k) + kRoundOff) {
        validation::reject("path", ": leaves the range of joint ", k, " at the fraction ",
                           (p - start_) / (clock_.width() * static_cast<double>(clock_.intervals())), ": position ", q,
                           " is ", std::max(q - limits.upper(k), limits.lower(k) - q), " outside of [", limits.lower(k),
                           ", ", limits.upper(k), "]");
      }
      const double distance = std::max(d[1](k) > 0.0 ? limits.upper(k) - q : q - limits.lower(k), 0.0);
      velocity(k) = std::min(velocity(k), std::max(braking_velocity(limits.joint(k), distance), kLeastSpeed));
    }
    return ClockBounds(std::array<Vector<N>, 3>{d[1], d[2], d[3]}, velocity, limits.acceleration, limits.jerk);
  }
  /// Largest velocity at a distance from an end of the range, from which a Tracker can stop: the braking envelope.
  [[nodiscard]] static double braking_velocity(const JointBounds<double>& joint, double distance) noexcept {
    if (std::isfinite(joint.deceleration)) {
      return std::sqrt(2.0 * joint.deceleration * distance) - joint.velocity_offset;
    }
    const double ramp = joint.acceleration / joint.jerk;
    const double offset = JointBounds<double>::kOffset * joint.acceleration * ramp;
    return std::sqrt(offset * offset + 2.0 * joint.acceleration * distance) - offset;
  }

  /// Round-off error of the spline for a joint that stands at an end of its range [rad] or [m].
  static constexpr double kRoundOff = 1e-12;
  /// Least velocity of a braking envelope [rad/s] or [m/s]: at the end of its range, a joint may stand.
  static constexpr double kLeastSpeed = 1e-6;

  /// Time from the start of interval i to its fraction f [s], by the rule of Gauss with 5 points.
  [[nodiscard]] double time_in(std::size_t i, double f) const noexcept {
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
  std::vector<double> times_;  ///< Time of the solution at the start of each interval, and at the end.
};

}  // namespace fpbm
