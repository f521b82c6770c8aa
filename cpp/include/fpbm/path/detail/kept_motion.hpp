#pragma once

#include <algorithm>
#include <type_traits>
#include <utility>

#include "fpbm/core/types.hpp"

namespace fpbm {

/// The motion along a path that a PathFollower keeps. The numbers belong to a PlannedMotion.
struct KeptMotion {
  double ramp;              ///< Least ramp of the follower with which no change of its rate exceeds a bound [s].
  double step;              ///< Time between postures [s].
  Eigen::Index dof;         ///< Number of joints.
  Eigen::Index count;       ///< Number of postures, at least 2.
  const double* q;          ///< Postures, one after another [rad] or [m].
  const double* closeness;  ///< Bounds::closeness() within kRange in each posture [m].

  /// Gaps above this range have no effect [m].
  static constexpr double kRange = 0.1;
  /// Gap to an obstacle that has moved before which the clock stops [m].
  static constexpr double kStop = 0.02;

  /// The posture at t [s], interpolated linearly.
  template <int N>
  [[nodiscard]] Vector<N> posture(double t) const noexcept {
    const Eigen::Index i = before(t);
    const double fraction = std::min(t / step - static_cast<double>(i), 1.0);
    const double* const from = q + i * dof;
    Vector<N> result(dof);
    for (Eigen::Index j = 0; j < dof; ++j) result.coeffRef(j) = from[j] + fraction * (from[j + dof] - from[j]);
    return result;
  }

  /// The velocity at t [s], interpolated linearly between central differences.
  template <int N>
  [[nodiscard]] Vector<N> velocity(double t) const noexcept {
    const double place = std::min(std::max(t / step - 0.5, 0.0), static_cast<double>(count - 2));
    const auto i = static_cast<Eigen::Index>(place);
    const double fraction = place - static_cast<double>(i);
    const double* const from = q + i * dof;
    const bool last = i + 2 >= count;
    Vector<N> result(dof);
    for (Eigen::Index j = 0; j < dof; ++j) {
      const double now = from[j + dof] - from[j];
      const double next = last ? 0.0 : from[j + 2 * dof] - from[j + dof];
      result.coeffRef(j) = (now + fraction * (next - now)) / step;
    }
    return result;
  }

  /// Largest rate of the clock if the closeness in the posture at t is `now` [m]: 1 as planned, 0 if a gap that was
  /// above kRange is now kStop.
  [[nodiscard]] double rate(double t, double now) const noexcept {
    constexpr double kTolerance = 1e-3;  // Error of the interpolation, in all gaps together.
    const Eigen::Index i = before(t);
    const double excess = now - std::max(closeness[i], closeness[i + 1]) - kTolerance;
    return std::max(std::min(1.0 - excess / (kRange - kStop), 1.0), 0.0);
  }

 private:
  /// Index of the posture before t ≥ 0.
  [[nodiscard]] Eigen::Index before(double t) const noexcept {
    return static_cast<Eigen::Index>(std::min(t / step, static_cast<double>(count - 2)));
  }
};

/// Whether a path may be kept: it has a member motion().
template <typename Path, typename = void>
inline constexpr bool kMayBeKept = false;
template <typename Path>
inline constexpr bool kMayBeKept<Path, std::void_t<decltype(std::declval<const Path&>().motion())>> = true;

/// The motion along a kept path, or null.
template <typename Path>
[[nodiscard]] const KeptMotion* motion_along([[maybe_unused]] const Path& path) noexcept {
  if constexpr (kMayBeKept<Path>) return path.motion();
  return nullptr;
}

}  // namespace fpbm
