#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "fpbm/core/detail/validation.hpp"
#include "fpbm/geometry/detail/joint_space.hpp"
#include "fpbm/model/detail/usable_bounds.hpp"
#include "fpbm/model/detail/velocity_envelope.hpp"
#include "fpbm/model/joint.hpp"
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

/// Range of a coordinate.
template <typename Scalar>
struct Range {
  Scalar low = -std::numeric_limits<Scalar>::infinity();
  Scalar high = std::numeric_limits<Scalar>::infinity();

  void include(Scalar x) noexcept {
    low = std::min(low, x);
    high = std::max(high, x);
  }
  [[nodiscard]] Scalar nearest(Scalar x) const noexcept { return std::min(std::max(x, low), high); }
  /// The range, moved into another range.
  [[nodiscard]] Range within(const Range& other) const noexcept { return {other.nearest(low), other.nearest(high)}; }
  /// The range relative to x.
  [[nodiscard]] Range from(Scalar x) const noexcept { return {low - x, high - x}; }
};

/// Axes of a reference of a tip: TargetBounds.
template <typename Space, typename Scalar>
struct AxesOf {
  using Bounds = TargetBounds<Scalar>;
  static constexpr int kLengths = Space::kRows - Space::kTurns;
  /// `part` of TimeOptimalAxis::tolerance().
  static constexpr Scalar kPart = Scalar(1e-6);

  TimeOptimalAxis<Scalar> lengths;
  TimeOptimalAxis<Scalar> angles;

  AxesOf(const Bounds& bounds, Scalar)
      : lengths(bounds.lengths()), angles(Space::kTurns > 0 ? bounds.angles() : bounds.lengths()) {}

  [[nodiscard]] TimeOptimalAxis<Scalar> operator()(int i) const noexcept { return i < kLengths ? lengths : angles; }
  [[nodiscard]] Range<Scalar> range(int) const noexcept { return {}; }
  [[nodiscard]] VelocityEnvelope<Level::kAcceleration, Scalar> envelope(int) const noexcept { return {}; }
};

/// Axes of a reference of joints: JointLimits. A joint without a bound on jerk may change its acceleration by any
/// amount within a tick.
template <int M, typename Scalar>
struct AxesOf<JointSpace<M>, Scalar> {
  using Bounds = JointLimits<M, Scalar>;
  static constexpr int kLengths = M;
  /// `part` of TimeOptimalAxis::tolerance(), which is reserved in the bounds. With 1e-10, one motion in 1,000 stays
  /// 1e-15 rad from its target.
  static constexpr Scalar kPart = Scalar(1e-8);

  std::array<TimeOptimalAxis<Scalar>, static_cast<std::size_t>(M)> each;
  Bounds limits;

  AxesOf(const Bounds& bounds, Scalar dt) : limits(bounds.complete()) {
    validation::require_positive("dt", dt);
    for (int i = 0; i < M; ++i) {
      const auto finite = [&](const char* name, Scalar bound) {
        const validation::Argument argument = validation::element(name, i);
        if (!(bound > Scalar(0) && std::isfinite(bound))) validation::fail(argument, bound, "positive and finite");
        return bound;
      };
      finite("limits.velocity", limits.velocity(i));
      const Scalar acceleration = finite("limits.acceleration", limits.acceleration(i));
      limits.set(i, usable_bounds<Level::kAcceleration>(i, limits.joint(i), dt));
      const Scalar jerk = std::min(limits.jerk(i), Scalar(2) * acceleration / dt);
      // Reserved for differences of positions: 8 halves of an ulp by rounding, and two snaps to a target, each of at
      // most the tolerance.
      const Scalar widest = std::max(std::abs(limits.lower(i)), std::abs(limits.upper(i)));
      const Scalar off =
          Scalar(36) * std::numeric_limits<Scalar>::epsilon() * (std::isfinite(widest) ? widest : Scalar(1)) +
          Scalar(8) * kPart * jerk * dt * dt * dt;
      each[static_cast<std::size_t>(i)] = {
          limits.velocity(i), {reduced(acceleration, off / (dt * dt)), reduced(jerk, off / (dt * dt * dt))}};
    }
  }

  [[nodiscard]] const TimeOptimalAxis<Scalar>& operator()(int i) const noexcept {
    return each[static_cast<std::size_t>(i)];
  }
  [[nodiscard]] Range<Scalar> range(int i) const noexcept { return {limits.lower(i), limits.upper(i)}; }
  [[nodiscard]] VelocityEnvelope<Level::kAcceleration, Scalar> envelope(int i) const noexcept {
    return {Scalar(0), limits.velocity_offset(i) / limits.deceleration(i), Scalar(1) / limits.deceleration(i)};
  }

 private:
  /// A bound minus a reserve, which is at most a thousandth of the bound, a choice: in single precision, the rounding
  /// is larger than the bounds on jerk of arms.
  [[nodiscard]] static Scalar reduced(Scalar bound, Scalar reserve) noexcept {
    return bound - std::min(reserve, bound / Scalar(1000));
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

template <typename Scalar = double>
struct StreamOptions : TargetFilterOptions<Scalar> {
  /// Time after which the reference passes the points of push() [s]. With the period of the stream plus its jitter, the
  /// motion between the points is smooth. With 0, the reference follows a prediction from the last three points.
  Scalar delay = Scalar(0);
  /// Least time in which the target changes from a chunk to the next [s]. With 0, the reference joins a chunk that is
  /// not a continuation of the chunk before in minimum time.
  Scalar blend = Scalar(0);

  void require_good() const {
    TargetFilterOptions<Scalar>::require_good();
    validation::require_non_negative("delay", delay);
    validation::require_non_negative("blend", blend);
  }
};

}  // namespace fpbm
