#pragma once

#include <array>
#include <cmath>

#include "fpbm/core/detail/validation.hpp"
#include "fpbm/path/detail/clock_solver.hpp"

namespace fpbm {

/// Speeds of the tip at the start and at the end of a motion [m/s], and the rates ṗ of the clock for these speeds; zero
/// at an end at rest.
struct GivenSpeeds {
  static constexpr std::array<const char*, 2> kNames{"start_speed", "end_speed"};

  ClockEnds speed{};
  ClockEnds rate{};

  [[nodiscard]] bool any() const noexcept { return speed[0] > 0.0 || speed[1] > 0.0; }

  /// y = ṗ² in a unit of y.
  [[nodiscard]] ClockEnds squares(double unit) const noexcept {
    return {rate[0] * rate[0] / unit, rate[1] * rate[1] / unit};
  }

  /// Throws std::invalid_argument unless the bounds on velocities admit the speeds. Removes these bounds at the ends,
  /// where y is given and may be equal to its bound.
  void require_within(ClockBounds& start, ClockBounds& end) const {
    constexpr double kRoundOff = 1.0 + 1e-12;
    for (const std::size_t i : {0U, 1U}) {
      if (!(speed[i] > 0.0)) continue;
      ClockBounds& place = i == 0 ? start : end;
      const double largest = place.largest_for_speeds();
      if (rate[i] * rate[i] > largest * kRoundOff) {
        validation::fail(kNames[i], speed[i], "at most ", largest_speed(i, largest),
                         ", by the bounds on velocities at this end: choose a lower speed");
      }
      place.remove_speeds();
    }
  }

  /// Throws std::invalid_argument. admitted: y at both ends that the bounds admit.
  [[noreturn]] void reject(const ClockEnds& admitted) const {
    constexpr double kInside = 0.99;  // Fraction of the admitted y, which is on the bounds.
    const ClockEnds lower{largest_speed(0, kInside * admitted[0]), largest_speed(1, kInside * admitted[1])};
    constexpr const char* kRemedy =
        ": the joints cannot change the speed faster within their bounds: choose a lower speed or a longer path";
    if (speed[0] > 0.0 && speed[1] > 0.0) {
      validation::reject_value(kNames[0], speed[0], " = ", speed[0], " and end_speed = ", speed[1],
                               ": must be nearer to each other or lower, for example ", lower[0], " and ", lower[1],
                               kRemedy);
    }
    const std::size_t end = speed[0] > 0.0 ? 0 : 1;
    validation::fail(kNames[end], speed[end], "lower, for example ", lower[end], kRemedy);
  }

 private:
  /// The speed with y = largest, rounded down to three digits.
  [[nodiscard]] double largest_speed(std::size_t end, double largest) const noexcept {
    if (!(rate[end] > 0.0)) return 0.0;
    const double exact = speed[end] / rate[end] * std::sqrt(largest);
    const double digit = std::pow(10.0, std::floor(std::log10(exact)) - 2.0);
    return std::floor(exact / digit) * digit;
  }
};

}  // namespace fpbm
