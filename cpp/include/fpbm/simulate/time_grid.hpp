#pragma once

#include <cmath>
#include <cstdio>
#include <limits>

#include "fpbm/core/detail/validation.hpp"

namespace fpbm {

/// Sample times of a rollout: t_i = i dt, over the motion and the subsequent time at rest (hold).
template <typename Scalar = double>
class TimeGrid {
 public:
  /// duration, dt and hold in seconds. Throws std::invalid_argument unless dt is positive, finite, and divides both
  /// duration and hold (up to 1e-9). The message contains the nearest valid dt.
  TimeGrid(Scalar duration, Scalar dt, Scalar hold = Scalar(0)) : duration_(duration) {
    validation::require_positive("duration", duration);
    validation::require_positive("dt", dt);
    validation::require_non_negative("hold", hold);
    motion_steps_ = steps("duration", static_cast<double>(duration), static_cast<double>(dt));
    dt_ = duration / static_cast<Scalar>(motion_steps_);
    hold_steps_ = hold > Scalar(0) ? steps("hold", static_cast<double>(hold), static_cast<double>(dt)) : 0;
  }

  [[nodiscard]] Scalar duration() const noexcept { return duration_; }
  [[nodiscard]] Scalar dt() const noexcept { return dt_; }
  [[nodiscard]] int motion_steps() const noexcept { return motion_steps_; }
  [[nodiscard]] int hold_steps() const noexcept { return hold_steps_; }
  [[nodiscard]] int steps() const noexcept { return motion_steps_ + hold_steps_; }
  [[nodiscard]] int samples() const noexcept { return steps() + 1; }
  [[nodiscard]] Scalar time(int step) const noexcept { return static_cast<Scalar>(step) * dt_; }

 private:
  static int steps(const char* span, double seconds, double dt) {
    const double ratio = seconds / dt;
    const double whole = std::fmax(1.0, std::round(ratio));
    if (whole > kMostSteps) {
      validation::fail("dt", dt, "larger: the grid has more than 1e9 steps");
    }
    // In float, the ratio of two rounded numbers has a relative error of at most 3ε/2, above 1e-9.
    constexpr double kRoundOff = 8.0 * static_cast<double>(std::numeric_limits<Scalar>::epsilon());
    if (std::abs(ratio - whole) > std::fmax(1e-9, kRoundOff) * whole) {
      char demand[128];
      std::snprintf(demand, sizeof demand, "a divisor of %s = %.9g; the nearest is %.17g", span, seconds,
                    seconds / whole);
      validation::fail("dt", dt, demand);
    }
    return static_cast<int>(whole);
  }

  static constexpr double kMostSteps = 1e9;  ///< The steps of motion and hold, and one sample, then fit an int.

  Scalar duration_;
  Scalar dt_;
  int motion_steps_;
  int hold_steps_;
};

}  // namespace fpbm
