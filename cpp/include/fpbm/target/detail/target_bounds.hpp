#pragma once

#include <optional>

#include "fpbm/core/detail/validation.hpp"
#include "fpbm/path/detail/time_optimal_axis.hpp"

namespace fpbm {

/// Bounds on the motion of a reference, for each axis of the base frame. Angular bounds apply if the task has angles.
template <typename Scalar = double>
struct TargetBounds {
  Scalar velocity{0};              ///< [m/s]
  Scalar acceleration{0};          ///< [m/s²]
  Scalar jerk{0};                  ///< [m/s³]
  Scalar angular_velocity{0};      ///< [rad/s]
  Scalar angular_acceleration{0};  ///< [rad/s²]
  Scalar angular_jerk{0};          ///< [rad/s³]

  /// Axis with the linear or the angular bounds. Throws std::invalid_argument if a bound is not positive and finite.
  [[nodiscard]] TimeOptimalAxis<Scalar> lengths() const {
    validation::require_positive("velocity", velocity);
    validation::require_positive("acceleration", acceleration);
    validation::require_positive("jerk", jerk);
    return {velocity, {acceleration, jerk}};
  }
  [[nodiscard]] TimeOptimalAxis<Scalar> angles() const {
    validation::require_positive("angular_velocity", angular_velocity);
    validation::require_positive("angular_acceleration", angular_acceleration);
    validation::require_positive("angular_jerk", angular_jerk);
    return {angular_velocity, {angular_acceleration, angular_jerk}};
  }
};

template <typename Scalar = double>
struct TargetFilterOptions {
  Scalar dt = Scalar(1e-3);  ///< Length of a tick [s]. Default: the tick of the Franka Control Interface.
  /// Without a message, a target continues to move, and a twist is followed, for this time [s]. The default is a
  /// choice: five lost messages in a row at 30 Hz have no effect. With a longer timeout, the stop after the last
  /// message is later.
  Scalar timeout = Scalar(0.2);
  std::optional<double> start;  ///< Time at the first tick on the clock of the stamps [s]; estimated if not given.

  /// Throws std::invalid_argument if an option is out of range.
  void require_good() const {
    validation::require_positive("dt", dt);
    validation::require_positive("timeout", timeout);
    if (start) validation::require_finite("start", *start);
  }
};

}  // namespace fpbm
