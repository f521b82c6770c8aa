#pragma once

#include "fpbm/core/mask.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/linalg/entrywise.hpp"
#include "fpbm/model/kinematics.hpp"
#include "fpbm/task/reference.hpp"

namespace fpbm {

/// Commanded tip velocity: J qd = v = xd + k (x ⊖ f(q)).
template <typename Space, int N, typename Scalar>
[[nodiscard, gnu::always_inline]] inline Vector<Space::kRows, Scalar> commanded_velocity(
    Scalar k, const Kinematics<Space, N, Scalar>& kinematics, const Reference<Space, Scalar>& reference) noexcept {
  Vector<Space::kRows, Scalar> v = reference.xd;
  if (!all_of(k == Scalar(0))) {
    const Vector<Space::kRows, Scalar> error = Space::template difference<Scalar>(reference.x, kinematics.tip);
    return entrywise(v, [&](Eigen::Index i) { return v.coeff(i) + k * error.coeff(i); });
  }
  return v;
}

/// Commanded acceleration: J qdd = b = xdd − Jd qd + k₁ (xd − J qd) + k₂ (x ⊖ f(q)).
template <typename Space, int N, typename Scalar>
[[nodiscard, gnu::always_inline]] inline Vector<Space::kRows, Scalar> commanded_acceleration(
    Scalar k1, Scalar k2, const Kinematics<Space, N, Scalar>& kinematics, const Reference<Space, Scalar>& reference,
    const State<N, Scalar>& state) noexcept {
  using Twist = Vector<Space::kRows, Scalar>;
  const Twist drift = kinematics.Jd.lazyProduct(state.qd);
  if (all_of(k1 + k2 == Scalar(0))) {
    return entrywise(drift, [&](Eigen::Index i) { return reference.xdd.coeff(i) - drift.coeff(i); });
  }
  const Twist velocity = kinematics.J.lazyProduct(state.qd);
  const Twist error = Space::template difference<Scalar>(reference.x, kinematics.tip);
  return entrywise(drift, [&](Eigen::Index i) {
    const Scalar b = reference.xdd.coeff(i) - drift.coeff(i);
    return b + k1 * (reference.xd.coeff(i) - velocity.coeff(i)) + k2 * error.coeff(i);
  });
}

}  // namespace fpbm
