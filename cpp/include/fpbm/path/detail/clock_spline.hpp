#pragma once

#include <array>
#include <cmath>
#include <cstddef>
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
  [[nodiscard]] const std::vector<double>& coefficients() const noexcept { return coefficients_; }

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

  /// Time ∫ dp/√y from the start of an interval to its fraction f, in closed form: with y″ = 2a and
  /// z = Δp/(√y₀ + √y₁), the time is 2 artanh(√a z)/√a.
  [[nodiscard]] double time(std::size_t interval, double f) const noexcept {
    const ClockState end = at(interval, f);
    const double z = f * width_ / (std::sqrt(at(interval, 0.0).y) + std::sqrt(end.y));
    const double square = end.y2 / 2.0 * z * z;
    const double root = std::sqrt(std::abs(square));
    if (root < 1e-3) return 2.0 * z * (1.0 + square / 3.0 + square * square / 5.0);
    return 2.0 * z * (square > 0.0 ? std::atanh(root) : std::atan(root)) / root;
  }

 private:
  double width_;
  std::vector<double> coefficients_;
};

}  // namespace fpbm
