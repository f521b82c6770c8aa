#pragma once

#include <cmath>

#include "fpbm/core/status.hpp"
#include "fpbm/limits/limits.hpp"

namespace fpbm {

/// Motion desired at velocity level, slowed where following the velocity field would take greater accelerations than
/// the joints have and make them swing. field: the scheme's velocities at q.
template <typename Loop, typename Target, int N, typename Scalar>
[[nodiscard]] Vector<N, Scalar> slow_down(Loop& loop, const Limits<Level::kVelocity, N, Scalar>& limits,
                                          const Target& reference, const Vector<N, Scalar>& q,
                                          const Vector<N, Scalar>& field, const Vector<N, Scalar>& desired) noexcept {
  const auto& bounds = limits.bounds();
  Scalar ahead = limits.tick();
  for (Eigen::Index i = 0; i < field.size(); ++i) {
    const Scalar way = std::abs(field(i)) * ahead;
    const Scalar most = bounds.velocity(i) * limits.tick();
    if (way > most) ahead *= most / way;
  }
  const Vector<N, Scalar> x = q + ahead * field;
  Vector<N, Scalar> later = x;
  if (failed(loop.evaluate(reference, x, later))) return field;
  Scalar square = Scalar(1);
  for (Eigen::Index i = 0; i < field.size(); ++i) {
    const Scalar change = std::abs(later(i) - field(i)) / ahead;
    if (square * change > bounds.acceleration(i)) square = bounds.acceleration(i) / change;
  }
  return square < Scalar(1) ? Vector<N, Scalar>(std::sqrt(square) * field) : desired;
}

}  // namespace fpbm
