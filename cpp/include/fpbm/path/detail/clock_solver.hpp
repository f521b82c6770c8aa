#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "fpbm/path/detail/clock_bounds.hpp"

namespace fpbm {

/// The squared rate y(p) of a clock, as a quadratic B-spline with equal intervals of p: y′ is continuous, and y″ is
/// constant in each interval. Therefore, the accelerations of a motion are continuous.
class ClockSpline {
 public:
  ClockSpline(std::size_t intervals, double width) : width_(width), coefficients_(intervals + 2, 0.0) {}

  [[nodiscard]] std::size_t intervals() const noexcept { return coefficients_.size() - 2; }
  [[nodiscard]] double width() const noexcept { return width_; }
  [[nodiscard]] std::vector<double>& coefficients() noexcept { return coefficients_; }

  /// Weights of the three coefficients of an interval in y, y′ and y″, at the fraction f of the interval.
  [[nodiscard]] std::array<std::array<double, 3>, 3> weights(double f) const noexcept {
    const double rest = 1.0 - f;
    const double square = width_ * width_;
    return {{{rest * rest / 2.0, 0.5 + f * rest, f * f / 2.0},
             {-rest / width_, (rest - f) / width_, f / width_},
             {1.0 / square, -2.0 / square, 1.0 / square}}};
  }
  [[nodiscard]] ClockState at(std::size_t interval, const std::array<std::array<double, 3>, 3>& w) const noexcept {
    const double* c = &coefficients_[interval];
    const auto sum = [c](const std::array<double, 3>& row) { return row[0] * c[0] + row[1] * c[1] + row[2] * c[2]; };
    return {sum(w[0]), sum(w[1]), sum(w[2])};
  }
  [[nodiscard]] ClockState at(std::size_t interval, double f) const noexcept { return at(interval, weights(f)); }

 private:
  double width_;
  std::vector<double> coefficients_;
};

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
  ClockSolver(const std::vector<std::array<ClockBounds, 3>>& bounds, Eigen::Index dof, double width)
      : bounds_(bounds), spline_(bounds.size(), width) {
    for (std::size_t k = 0; k < 3; ++k) weights_[k] = spline_.weights(kFractions[k]);
    barriers_ = static_cast<double>(3 * bounds.size() * (2 + 4 * static_cast<std::size_t>(dof)));
  }

  /// The clock. The duration exceeds the duration at the minimum by at most the factor kGap, for convex bounds.
  [[nodiscard]] ClockSpline solve() {
    constexpr double kGap = 5e-4;
    constexpr double kStart = 0.5;   // Fraction of the largest constant y.
    constexpr double kGrowth = 6.0;  // Factor of τ. 4 to 10 need 25 to 35 steps.
    constexpr int kMostSteps = 200;  // Random paths need at most 60.
    std::vector<double>& c = spline_.coefficients();
    double largest = std::numeric_limits<double>::infinity();
    for (const auto& interval : bounds_) {
      for (const ClockBounds& each : interval) largest = std::min(largest, each.largest());
    }
    std::fill(c.begin(), c.end(), kStart * largest);
    double emphasis = barriers_ / (30.0 * duration(spline_));
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

  /// One step of Newton's method with a line search. Returns the decrement of Newton's method.
  double step(double emphasis) {
    assemble(emphasis);
    const double decrement = direction();
    constexpr double kArmijo = 0.1;
    constexpr double kShorter = 0.6;
    constexpr int kLengths = 40;  // The shortest step is 1e-9 of the step of Newton's method.
    const double before = merit(spline_, emphasis);
    ClockSpline next = spline_;
    double length = 1.0;
    for (int k = 0; k < kLengths; ++k, length *= kShorter) {
      for (std::size_t i = 0; i < step_.size(); ++i) {
        next.coefficients()[i] = spline_.coefficients()[i] + length * step_[i];
      }
      if (merit(next, emphasis) <= before - kArmijo * length * decrement) {
        spline_ = next;
        return decrement;
      }
    }
    return 0.0;
  }

  /// Gradient of the merit, and the diagonal and the two bands of its Hessian.
  void assemble(double emphasis) {
    matrix_.assign(spline_.coefficients().size(), {});
    step_.assign(matrix_.size(), 0.0);
    for (std::size_t i = 0; i < bounds_.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        const auto& w = weights_[k];
        const ClockState at = spline_.at(i, w);
        const double rate = emphasis * spline_.width() * kSimpson[k] / (at.y * std::sqrt(at.y));
        std::array<double, 3> g{-rate / 2.0, 0.0, 0.0};
        std::array<double, 6> h{0.75 * rate / at.y, 0.0, 0.0, 0.0, 0.0, 0.0};
        bounds_[i][k].add_derivatives(at, g, h);
        for (std::size_t r = 0; r < 3; ++r) {
          step_[i + r] -= g[0] * w[0][r] + g[1] * w[1][r] + g[2] * w[2][r];
          const std::array<double, 3> row{h[0] * w[0][r] + h[1] * w[1][r] + h[2] * w[2][r],
                                          h[1] * w[0][r] + h[3] * w[1][r] + h[4] * w[2][r],
                                          h[2] * w[0][r] + h[4] * w[1][r] + h[5] * w[2][r]};
          for (std::size_t c = r; c < 3; ++c) {
            matrix_[i + r][c - r] += row[0] * w[0][c] + row[1] * w[1][c] + row[2] * w[2][c];
          }
        }
      }
    }
  }

  /// Solves for the step of Newton's method by LDLᵀ with two bands, in place. Returns the decrement.
  double direction() {
    const std::size_t n = step_.size();
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t k = 1; k < 3 && i + k < n; ++k) {
        const double factor = matrix_[i][k] / matrix_[i][0];
        for (std::size_t c = k; c < 3; ++c) matrix_[i + k][c - k] -= factor * matrix_[i][c];
        step_[i + k] -= factor * step_[i];
      }
    }
    double decrement = 0.0;
    for (std::size_t i = n; i-- > 0;) {
      decrement += step_[i] * step_[i] / matrix_[i][0];
      for (std::size_t k = 1; k < 3 && i + k < n; ++k) step_[i] -= matrix_[i][k] * step_[i + k];
      step_[i] /= matrix_[i][0];
    }
    return decrement;
  }

  const std::vector<std::array<ClockBounds, 3>>& bounds_;
  ClockSpline spline_;
  std::array<std::array<std::array<double, 3>, 3>, 3> weights_{};
  double barriers_;
  std::vector<std::array<double, 3>> matrix_;
  std::vector<double> step_;
};

}  // namespace fpbm
