#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "fpbm/path/detail/banded_system.hpp"
#include "fpbm/path/detail/clock_bounds.hpp"
#include "fpbm/path/detail/clock_spline.hpp"

namespace fpbm {

/// Numbers at the start and at the end of a clock.
using ClockEnds = std::array<double, 2>;

/// Clock with the least duration ∫ dp/√y within its bounds, by an interior-point method: Newton's method minimises
/// τ ∫ dp/√y + Σ barrier(), for increasing τ. Every iterate keeps all bounds. The matrix of a step has two bands beside
/// its diagonal. The bounds on jerk are not convex: the result is a local minimum.
class ClockSolver {
 public:
  /// Fractions of an interval at which the bounds hold, with the weights of Simpson's rule. In the middle alone, jerks
  /// exceed their bounds at the ends of an interval.
  static constexpr std::array<double, 3> kFractions{0.0, 0.5, 1.0};
  static constexpr std::array<double, 3> kSimpson{1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0};

  /// bounds: for each interval, the bounds at kFractions, in a unit of y near the largest constant y.
  ClockSolver(const std::vector<std::array<ClockBounds, 3>>& bounds, double width)
      : bounds_(bounds), spline_(bounds.size(), width) {
    for (std::size_t k = 0; k < 3; ++k) weights_[k] = spline_.weights(kFractions[k]);
    barriers_ = static_cast<double>(3 * bounds.size() * bounds[0][0].count());
    constexpr double kStart = 0.5;  // Fraction of the largest constant y.
    double largest = std::numeric_limits<double>::infinity();
    for (const auto& interval : bounds_) {
      for (const ClockBounds& each : interval) largest = std::min(largest, each.largest());
    }
    std::fill(spline_.coefficients().begin(), spline_.coefficients().end(), kStart * largest);
    emphasis_ = barriers_ / (30.0 * duration(spline_));
  }

  [[nodiscard]] const ClockSpline& clock() const noexcept { return spline_; }

  /// Gives y at the start and the end; zero: y is free. All bounds are kept: if they do not admit the given values, the
  /// result is false, and clock() has values that they admit.
  [[nodiscard]] bool give_ends(const ClockEnds& y) {
    constexpr int kMostSteps = 200;  // Random paths need at most 30.
    constexpr int kCentring = 10;
    constexpr double kLeast = 1e-4;  // Shorter steps approach the largest values that the bounds admit.
    given_ = y;
    for (int steps = 0; steps < kMostSteps; ++steps) {
      const double length = approach();
      for (int k = 0; k < kCentring && step(emphasis_) > 1e-2 * barriers_; ++k) {
      }
      if (length == 1.0) return true;
      if (length < kLeast) return false;
    }
    return false;
  }

  /// The clock. The duration exceeds the duration at the minimum by at most the factor kGap, for convex bounds.
  [[nodiscard]] ClockSpline solve() {
    constexpr double kGap = 5e-4;
    constexpr double kGrowth = 6.0;  // Factor of τ. 4 to 10 need 25 to 35 steps.
    constexpr int kMostSteps = 200;  // Random paths need at most 60.
    double emphasis = emphasis_;
    for (int steps = 0; steps < kMostSteps; emphasis *= kGrowth) {
      // A decrement of 1 % of the number of bounds changes the duration by much less than the gap.
      while (steps++ < kMostSteps && step(emphasis) > 1e-2 * barriers_) {
      }
      if (barriers_ < kGap * emphasis * duration(spline_)) break;
    }
    return spline_;
  }

 private:
  [[nodiscard]] double duration(const ClockSpline& spline) const noexcept {
    double sum = 0.0;
    for (std::size_t i = 0; i < bounds_.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) sum += kSimpson[k] / std::sqrt(spline.at(i, weights_[k]).y);
    }
    return sum * spline.width();
  }

  [[nodiscard]] double merit(const ClockSpline& spline, double emphasis) const noexcept {
    double sum = 0.0;
    for (std::size_t i = 0; i < bounds_.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        const ClockState at = spline.at(i, weights_[k]);
        const double barrier = bounds_[i][k].barrier(at);
        if (!(barrier < std::numeric_limits<double>::infinity())) return barrier;
        sum += barrier + emphasis * spline.width() * kSimpson[k] / std::sqrt(at.y);
      }
    }
    return sum;
  }

  /// A step of Newton's method toward the given values at the ends, as long as the bounds admit. Returns its length.
  double approach() {
    assemble(emphasis_, false);
    const double last = spline_.at(bounds_.size() - 1, 1.0).y;
    direction({given_[0] - spline_.at(0, 0.0).y, given_[1] - last});
    ClockSpline next = spline_;
    double length = 1.0;
    for (int k = 0; k < kLengths; ++k, length *= kShorter) {
      move(next, length);
      if (!(merit(next, emphasis_) < std::numeric_limits<double>::infinity())) continue;
      constexpr double kInside = 0.9;  // Of the longest step, so that the next step can be as long.
      if (length < 1.0) move(next, length *= kInside);
      spline_ = next;
      return length;
    }
    return 0.0;
  }

  void move(ClockSpline& next, double length) const {
    for (std::size_t i = 0; i < system_.size(); ++i) {
      next.coefficients()[i] = spline_.coefficients()[i] + length * system_.right[i];
    }
  }

  static constexpr double kShorter = 0.6;
  static constexpr int kLengths = 40;  // The shortest step is 1e-9 of the step of Newton's method.

  /// One step of Newton's method with a line search. Returns the decrement of Newton's method.
  double step(double emphasis) {
    assemble(emphasis, true);
    const double decrement = direction({});
    constexpr double kArmijo = 0.1;
    const double before = merit(spline_, emphasis);
    ClockSpline next = spline_;
    double length = 1.0;
    for (int k = 0; k < kLengths; ++k, length *= kShorter) {
      move(next, length);
      if (merit(next, emphasis) <= before - kArmijo * length * decrement) {
        spline_ = next;
        return decrement;
      }
    }
    return 0.0;
  }

  /// Whether y is given at a place of an interval.
  [[nodiscard]] bool gives(std::size_t interval, std::size_t place) const noexcept {
    return (interval == 0 && place == 0 && given_[0] > 0.0) ||
           (interval + 1 == bounds_.size() && place == 2 && given_[1] > 0.0);
  }

  /// Gradient of the merit, and the diagonal and the two bands of its Hessian. constant: whether the given y do not
  /// change; without their derivatives, which are large at low speeds, the round-off errors are smaller.
  void assemble(double emphasis, bool constant) {
    system_.reset(spline_.coefficients().size());
    for (std::size_t i = 0; i < bounds_.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        const auto& w = weights_[k];
        const ClockState at = spline_.at(i, w);
        const double rate = emphasis * spline_.width() * kSimpson[k] / (at.y * std::sqrt(at.y));
        std::array<double, 3> g{-rate / 2.0, 0.0, 0.0};
        std::array<double, 6> h{0.75 * rate / at.y, 0.0, 0.0, 0.0, 0.0, 0.0};
        bounds_[i][k].add_derivatives(at, g, h);
        if (constant && gives(i, k)) g[0] = h[0] = h[1] = h[2] = 0.0;
        for (std::size_t r = 0; r < 3; ++r) {
          system_.right[i + r] -= g[0] * w[0][r] + g[1] * w[1][r] + g[2] * w[2][r];
          const std::array<double, 3> row{h[0] * w[0][r] + h[1] * w[1][r] + h[2] * w[2][r],
                                          h[1] * w[0][r] + h[3] * w[1][r] + h[4] * w[2][r],
                                          h[2] * w[0][r] + h[4] * w[1][r] + h[5] * w[2][r]};
          for (std::size_t c = r; c < 3; ++c) {
            system_.matrix[i + r][c - r] += row[0] * w[0][c] + row[1] * w[1][c] + row[2] * w[2][c];
          }
        }
      }
    }
  }

  /// Solves for the step of Newton's method. Returns the decrement. changes: of the given values at the ends, where y
  /// is the mean of two coefficients.
  double direction(const ClockEnds& changes) {
    const std::size_t n = system_.size();
    if (given_[0] > 0.0) system_.require_sum(0, 1, 2, 2.0 * changes[0]);
    if (given_[1] > 0.0) system_.require_sum(n - 1, n - 2, n - 3, 2.0 * changes[1]);
    const double decrement = system_.solve();
    std::vector<double>& x = system_.right;
    if (given_[0] > 0.0) x[0] = 2.0 * changes[0] - x[1];
    if (given_[1] > 0.0) x[n - 1] = 2.0 * changes[1] - x[n - 2];
    return decrement;
  }

  const std::vector<std::array<ClockBounds, 3>>& bounds_;
  ClockSpline spline_;
  std::array<std::array<std::array<double, 3>, 3>, 3> weights_{};
  double barriers_;
  double emphasis_;  ///< First τ.
  ClockEnds given_{};
  BandedSystem system_;  ///< Its solution is the step of Newton's method.
};

}  // namespace fpbm
