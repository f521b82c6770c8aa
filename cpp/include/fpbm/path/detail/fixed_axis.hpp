#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "fpbm/core/types.hpp"

namespace fpbm {

/// Rotation about a fixed axis, represented by the coordinate of the rotation vector with the largest angle. The other
/// two coordinates have the angle, velocity and acceleration of coordinate `largest`, times factors of magnitude ≤ 1.
/// The other two coordinates therefore keep any bound that coordinate `largest` keeps.
template <typename Scalar>
struct FixedAxis {
  Eigen::Index largest;      ///< Coordinate of the largest angle.
  Vector<3, Scalar> angles;  ///< Ratios of the remaining angles to coordinate `largest`.
  Vector<3, Scalar> motion;  ///< Ratios of velocity and acceleration to coordinate `largest`: `angles` up to round-off.
};

/// Fixed axis of a rotation whose angular velocity w [rad/s] and acceleration wd [rad/s²] are parallel to the remaining
/// rotation vector `left` [rad]. Returns no value if these vectors are not parallel, or if `left` is zero.
template <typename Scalar>
[[nodiscard]] std::optional<FixedAxis<Scalar>> fixed_axis(const Vector<3, Scalar>& left, const Vector<3, Scalar>& w,
                                                          const Vector<3, Scalar>& wd) noexcept {
  constexpr Scalar kEpsilon = std::numeric_limits<Scalar>::epsilon();
  // In brackets: the range that passes TargetTurn.*.
  constexpr Scalar kDirection = Scalar(32) * kEpsilon;  // [8 to 3e7 epsilon] Round-off error of the remaining rotation.
  constexpr Scalar kParallel = Scalar(64) * kEpsilon;   // [2 to 6400 epsilon] Round-off error of w and wd.
  constexpr Scalar kCorrection = Scalar(8) * kEpsilon;  // [0 to 800 epsilon] Largest correction in a tick.
  FixedAxis<Scalar> axis;
  const Scalar angle = left.cwiseAbs().maxCoeff(&axis.largest);
  if (!(angle > Scalar(0))) return {};
  const Eigen::Index k = axis.largest;
  // The remaining rotation is a difference of orientations, with an absolute round-off error. The round-off errors of w
  // and wd are relative.
  const Scalar direction = kDirection * (Scalar(1) + angle) / angle;
  const Vector<3, Scalar>& moving = w(k) != Scalar(0) ? w : wd(k) != Scalar(0) ? wd : left;
  for (int i = 0; i < 3; ++i) {
    const Scalar ratio = left(i) / left(k);
    const Scalar along = moving(i) / moving(k);
    const Scalar away = ratio - along;
    if (!(std::abs(away) <= direction && std::abs(along) <= Scalar(1) + kParallel)) return {};
    if (!(std::abs(w(i) - along * w(k)) <= kParallel * std::abs(w(k)))) return {};
    if (!(std::abs(wd(i) - along * wd(k)) <= kParallel * std::abs(wd(k)))) return {};
    axis.angles(i) = ratio;
    // The round-off errors of the angles would accumulate without a correction of the same magnitude.
    const Scalar corrected = along + std::clamp(away, -kCorrection, kCorrection);
    axis.motion(i) = std::clamp(corrected, Scalar(-1), Scalar(1));
  }
  return axis;
}

}  // namespace fpbm
