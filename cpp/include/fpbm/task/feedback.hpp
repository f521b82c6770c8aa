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
  if (!all_of(k == Scalar(0))) v += k * Space::template difference<Scalar>(reference.x, kinematics.tip);
  return v;
}

/// Commanded acceleration: J qdd = b = xdd − Jd qd + k₁ (xd − J qd) + k₂ (x ⊖ f(q)).
template <typename Space, int N, typename Scalar>
[[nodiscard, gnu::always_inline]] inline Vector<Space::kRows, Scalar> commanded_acceleration(
    Scalar k1, Scalar k2, const Kinematics<Space, N, Scalar>& kinematics, const Reference<Space, Scalar>& reference,
    const State<N, Scalar>& state) noexcept {
  if constexpr (Space::kRows * N > 21 && !kInLanes<Scalar>) {  // By entries, of which a compiler makes fewer types.
    Vector<Space::kRows, Scalar> b = kinematics.Jd.lazyProduct(state.qd);
    b = entrywise(b, [&](Eigen::Index i) { return reference.xdd.coeff(i) - b.coeff(i); });
    if (k1 + k2 == Scalar(0)) return b;
    const Vector<Space::kRows, Scalar> xd = kinematics.J.lazyProduct(state.qd);
    const Vector<Space::kRows, Scalar> error = Space::template difference<Scalar>(reference.x, kinematics.tip);
    return entrywise(b, [&](Eigen::Index i) {
      return b.coeff(i) + k1 * (reference.xd.coeff(i) - xd.coeff(i)) + k2 * error.coeff(i);
    });
  } else {
    Vector<Space::kRows, Scalar> b = reference.xdd - kinematics.Jd.lazyProduct(state.qd);
    if (!all_of(k1 + k2 == Scalar(0))) {
      b += k1 * (reference.xd - kinematics.J.lazyProduct(state.qd));
      b += k2 * Space::template difference<Scalar>(reference.x, kinematics.tip);
    }
    return b;
  }
}

}  // namespace fpbm
