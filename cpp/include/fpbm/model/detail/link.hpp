#pragma once

#include <Eigen/Core>
#include <cmath>

#include "fpbm/core/types.hpp"
#include "fpbm/geometry/rotation.hpp"

namespace fpbm {

/// Transform from the frame of a joint to the frame of the next joint, both with the joint axis as z: a translation
/// (step) [m], then a rotation about x (tilt).
template <typename Scalar>
struct Link {
  Vector<3, Scalar> step;
  Scalar cosine;  ///< Cosine of the tilt.
  Scalar sine;

  template <typename Other>
  [[nodiscard]] Link<Other> cast() const noexcept {
    return {step.template cast<Other>(), Other(cosine), Other(sine)};
  }
};

/// Decomposition of the rotation of a link: R = Rz(before) Rx(tilt) Rz(after). `before` and `after` are added to the
/// angles of the joints at the two ends of the link.
template <typename Scalar>
struct DecomposedLink {
  Scalar before;  ///< [rad]
  Link<Scalar> link;
  Scalar after;  ///< [rad]

  explicit DecomposedLink(const Transform<Scalar>& transform) {
    using std::atan2;
    using std::cos;
    using std::sin;
    const auto& [p, R] = transform;
    const bool tilted = R(0, 2) != Scalar(0) || R(1, 2) != Scalar(0);
    const bool backward = R(1, 2) > Scalar(0);  // If true, the tilt is negative, so that |before| ≤ π/2.
    before = tilted ? (backward ? atan2(-R(0, 2), R(1, 2)) : atan2(R(0, 2), -R(1, 2))) : Scalar(0);
    const Scalar c = cos(before);
    const Scalar s = sin(before);
    Transform<Scalar> back;
    back.R(0, 0) = back.R(1, 1) = c;
    back.R(0, 1) = s;
    back.R(1, 0) = -s;
    const auto [step, rest] = back * transform;
    link = {step, rest(2, 2), -rest(1, 2)};
    after = atan2(-rest(0, 1), rest(0, 0));
  }
};

/// A rotation that maps z to the direction of the axis.
template <typename Scalar>
[[nodiscard]] Matrix<3, 3, Scalar> z_to(const Vector<3, Scalar>& axis) {
  using Vector3 = Vector<3, Scalar>;
  using std::abs;
  const Vector3 z = normalized(axis);
  if (z(0) == Scalar(0) && z(1) == Scalar(0) && z(2) == Scalar(1)) return identity<Matrix<3, 3, Scalar>>();
  Eigen::Index least = 0;
  for (Eigen::Index i = 1; i < 3; ++i) {
    if (abs(z(i)) < abs(z(least))) least = i;
  }
  Vector3 across(Scalar(0), Scalar(0), Scalar(0));
  across(least) = Scalar(1);
  const Vector3 x = normalized(cross(across, z));
  Matrix<3, 3, Scalar> R;
  set_column(R, 0, x);
  set_column(R, 1, cross(z, x));
  set_column(R, 2, z);
  return R;
}

}  // namespace fpbm
