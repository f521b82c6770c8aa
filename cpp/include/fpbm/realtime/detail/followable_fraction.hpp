#pragma once

#include <cmath>

#include "fpbm/core/status.hpp"
#include "fpbm/limits/limits.hpp"

namespace fpbm {

/// Fraction of a velocity field that the joints can follow. The fraction is below 1 if the whole field requires
/// accelerations above the joints' bounds: joints that follow the whole field would oscillate. field: velocities of the
/// scheme at q [rad/s]. reference_after(seconds): corrected reference at the posture q + seconds · field.
template <typename Loop, typename ReferenceAfter, int N, typename Scalar>
[[nodiscard]] Scalar followable_fraction(Loop& loop, const Limits<Level::kVelocity, N, Scalar>& limits,
                                         ReferenceAfter&& reference_after, const Vector<N, Scalar>& q,
                                         const Vector<N, Scalar>& field) noexcept {
  const auto& bounds = limits.bounds();
  // The derivative of the field in the direction of the field is the acceleration of joints that follow the field. At a
  // fraction s of the field, the acceleration is s² times as large.
  Scalar ahead = limits.tick();
  for (Eigen::Index i = 0; i < field.size(); ++i) {
    const Scalar displacement = std::abs(field(i)) * ahead;
    const Scalar most = bounds.velocity(i) * limits.tick();
    if (displacement > most) ahead *= most / displacement;
  }
  const Vector<N, Scalar> x = q + ahead * field;
  Vector<N, Scalar> later = x;
  if (failed(loop.evaluate(reference_after(ahead), x, later))) return Scalar(1);
  Scalar square = Scalar(1);
  for (Eigen::Index i = 0; i < field.size(); ++i) {
    const Scalar change = std::abs(later(i) - field(i)) / ahead;
    if (square * change > bounds.acceleration(i)) square = bounds.acceleration(i) / change;
  }
  return std::sqrt(square);
}

}  // namespace fpbm
