#pragma once

#include <algorithm>

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

}  // namespace fpbm
