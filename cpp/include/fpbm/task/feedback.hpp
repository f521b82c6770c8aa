#pragma once

#include "fpbm/core/mask.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/model/kinematics.hpp"
#include "fpbm/task/reference.hpp"

namespace fpbm {

/// Commanded tip velocity: J qd = v = xd + k (x ⊖ f(q)).
template <typename Space, int N, typename Scalar>
[[nodiscard, gnu::always_inline]] inline Vector<Space::kRows, Scalar> commanded_velocity(
    Scalar k, const Kinematics<Space, N, Scalar>& kinematics, const Reference<Space, Scalar>& reference) noexcept {
  Vector<Space::kRows, Scalar> v = reference.xd;
  if (!all_of(k == Scalar(0))) v += k * Space::template difference<Scalar>(reference.x, kinematics.tip);
  return v;
}

/// Commanded acceleration: J qdd = b = xdd − Jd qd + k₁ (xd − J qd) + k₂ (x ⊖ f(q)).
template <typename Space, int N, typename Scalar>
[[nodiscard, gnu::always_inline]] inline Vector<Space::kRows, Scalar> commanded_acceleration(
    Scalar k1, Scalar k2, const Kinematics<Space, N, Scalar>& kinematics, const Reference<Space, Scalar>& reference,
    const State<N, Scalar>& state) noexcept {
  Vector<Space::kRows, Scalar> b = reference.xdd - kinematics.Jd.lazyProduct(state.qd);
  if (!all_of(k1 + k2 == Scalar(0))) {
    b += k1 * (reference.xd - kinematics.J.lazyProduct(state.qd));
    b += k2 * Space::template difference<Scalar>(reference.x, kinematics.tip);
  }
  return b;
}

}  // namespace fpbm
