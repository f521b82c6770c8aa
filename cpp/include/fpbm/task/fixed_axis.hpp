#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "fpbm/core/types.hpp"

namespace fpbm {

/// Rotation about a fixed axis, by its largest angle: the other two angles, velocities and accelerations are shares of
/// the largest angle's, of at most 1. So they keep any bound that the largest keeps.
template <typename Scalar>
struct FixedAxis {
  Eigen::Index largest;      ///< Coordinate of the largest angle.
  Vector<3, Scalar> angles;  ///< Shares of the angles that are left,
  Vector<3, Scalar> motion;  ///< and of the velocity and acceleration, equal to them but for round-off.
};

/// The fixed axis of a motion whose velocity and acceleration are parallel to the rotation that is left [rad]; none if
/// they are not, or nothing is left.
template <typename Scalar>
[[nodiscard]] std::optional<FixedAxis<Scalar>> fixed_axis(const Vector<3, Scalar>& left, const Vector<3, Scalar>& w,
                                                          const Vector<3, Scalar>& wd) noexcept {
  constexpr Scalar kEpsilon = std::numeric_limits<Scalar>::epsilon();
  FixedAxis<Scalar> axis;
  const Scalar angle = left.cwiseAbs().maxCoeff(&axis.largest);
  if (!(angle > Scalar(0))) return {};
  const Eigen::Index k = axis.largest;
  // The rotation that is left is a difference of orientations, whose round-off is absolute; that of w and wd is
  // relative.
  const Scalar direction = Scalar(32) * kEpsilon * (Scalar(1) + angle) / angle;
  const Vector<3, Scalar>& moving = w(k) != Scalar(0) ? w : wd(k) != Scalar(0) ? wd : left;
  for (int i = 0; i < 3; ++i) {
    const Scalar share = left(i) / left(k);
    const Scalar along = moving(i) / moving(k);
    const Scalar away = share - along;
    if (!(std::abs(away) <= direction && std::abs(along) <= Scalar(1) + Scalar(64) * kEpsilon)) return {};
    if (!(std::abs(w(i) - along * w(k)) <= Scalar(64) * kEpsilon * std::abs(w(k)))) return {};
    if (!(std::abs(wd(i) - along * wd(k)) <= Scalar(64) * kEpsilon * std::abs(wd(k)))) return {};
    axis.angles(i) = share;
    // Round-off of the angles adds up; corrected by as little, it does not.
    const Scalar corrected = along + std::clamp(away, -Scalar(8) * kEpsilon, Scalar(8) * kEpsilon);
    axis.motion(i) = std::clamp(corrected, Scalar(-1), Scalar(1));
  }
  return axis;
}

}  // namespace fpbm
