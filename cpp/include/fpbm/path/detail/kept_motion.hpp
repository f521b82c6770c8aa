#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "fpbm/core/types.hpp"
#include "fpbm/path/detail/fastest_clock.hpp"

namespace fpbm {

/// Plan of a motion along a path that a PathFollower keeps (kept_path()).
struct KeptMotion {
  FastestClock clock;
  double ramp;                    ///< Least ramp of the follower with which no change of its rate exceeds a bound [s].
  double step;                    ///< Time between postures [s].
  Eigen::Index dof;               ///< Number of joints.
  std::vector<double> q;          ///< Postures, one after another [rad] or [m].
  std::vector<double> closeness;  ///< Bounds::closeness() within kRange in each posture [m].

  /// Gaps above this range have no effect [m].
  static constexpr double kRange = 0.1;
  /// Gap to an obstacle that has moved before which the clock stops [m].
  static constexpr double kStop = 0.02;

  /// The posture at t [s], interpolated linearly.
  template <int N>
  [[nodiscard]] Vector<N> posture(double t) const noexcept {
    const auto [i, fraction] = place(t);
    const double* const from = &q[i * static_cast<std::size_t>(dof)];
    Vector<N> result(dof);
    for (Eigen::Index j = 0; j < dof; ++j) result(j) = from[j] + fraction * (from[j + dof] - from[j]);
    return result;
  }

  /// Largest rate of the clock if the closeness in the posture at t is `now` [m]: 1 as planned, 0 if a gap that was
  /// above kRange is now kStop.
  [[nodiscard]] double rate(double t, double now) const noexcept {
    constexpr double kTolerance = 1e-3;  // Error of the interpolation, in all gaps together.
    const std::size_t i = place(t).first;
    const double excess = now - std::max(closeness[i], closeness[i + 1]) - kTolerance;
    return std::clamp(1.0 - excess / (kRange - kStop), 0.0, 1.0);
  }

 private:
  /// Index of the posture before t, and the fraction of the step after this posture.
  [[nodiscard]] std::pair<std::size_t, double> place(double t) const noexcept {
    const double steps = std::clamp(t / step, 0.0, static_cast<double>(closeness.size() - 1));
    const std::size_t i = std::min(static_cast<std::size_t>(steps), closeness.size() - 2);
    return {i, steps - static_cast<double>(i)};
  }
};

}  // namespace fpbm
