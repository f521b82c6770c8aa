#pragma once

#include <cmath>

#include "fpbm/core/status.hpp"
#include "fpbm/limits/limits.hpp"

namespace fpbm {

/// Share of a velocity field that joints can follow: below 1 where following it would take greater accelerations than
/// they have and make them swing. field: the scheme's velocities at q.
template <typename Loop, typename Target, int N, typename Scalar>
[[nodiscard]] Scalar slow_down(Loop& loop, const Limits<Level::kVelocity, N, Scalar>& limits, const Target& reference,
                               const Vector<N, Scalar>& q, const Vector<N, Scalar>& field) noexcept {
  const auto& bounds = limits.bounds();
  Scalar ahead = limits.tick();
  for (Eigen::Index i = 0; i < field.size(); ++i) {
    const Scalar way = std::abs(field(i)) * ahead;
    const Scalar most = bounds.velocity(i) * limits.tick();
    if (way > most) ahead *= most / way;
  }
  const Vector<N, Scalar> x = q + ahead * field;
  Vector<N, Scalar> later = x;
  if (failed(loop.evaluate(reference, x, later))) return Scalar(1);
  Scalar square = Scalar(1);
  for (Eigen::Index i = 0; i < field.size(); ++i) {
    const Scalar change = std::abs(later(i) - field(i)) / ahead;
    if (square * change > bounds.acceleration(i)) square = bounds.acceleration(i) / change;
  }
  return std::sqrt(square);
}

}  // namespace fpbm
