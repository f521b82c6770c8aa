#pragma once

#include "fpbm/core/detail/mask.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/linalg/detail/entrywise.hpp"
#include "fpbm/linalg/detail/product.hpp"
#include "fpbm/model/kinematics.hpp"
#include "fpbm/path/reference.hpp"

namespace fpbm {

/// Commanded tip velocity of the schemes at velocity level: J qd = v = xd + k (x ⊖ f(q)) (docs/equations.md).
template <typename Space, int N, typename Scalar>
[[nodiscard, gnu::always_inline]] inline Vector<Space::kRows, Scalar> commanded_velocity(
    Scalar k, const Kinematics<Space, N, Scalar>& kinematics, const Reference<Space, Scalar>& reference) noexcept {
  Vector<Space::kRows, Scalar> v = reference.xd;
  if (!all_of(k == Scalar(0))) {
    const Vector<Space::kRows, Scalar> error = Space::template difference<Scalar>(reference.x, kinematics.tip);
    v = entrywise(v, [&](Eigen::Index i) { return v.coeff(i) + k * error.coeff(i); });
  }
  return v;
}

/// Commanded acceleration with the feedback of (13) in docs/equations.md:
/// J qdd = b = xdd − Jd qd + k₁ (xd − J qd) + k₂ (x ⊖ f(q)).
template <typename Space, int N, typename Scalar>
[[nodiscard, gnu::always_inline]] inline Vector<Space::kRows, Scalar> commanded_acceleration(
    Scalar k1, Scalar k2, const Kinematics<Space, N, Scalar>& kinematics, const Reference<Space, Scalar>& reference,
    const State<N, Scalar>& state) noexcept {
  constexpr int M = Space::kRows;
  if constexpr (M == Eigen::Dynamic) {
    const Vector<M, Scalar> error = Space::template difference<Scalar>(reference.x, kinematics.tip);
    const Vector<M, Scalar> xd = product(kinematics.J, state.qd);
    const Vector<M, Scalar> drift = product(kinematics.Jd, state.qd);
    return entrywise(xd, [&](Eigen::Index i) {
      return reference.xdd.coeff(i) - drift.coeff(i) + k1 * (reference.xd.coeff(i) - xd.coeff(i)) + k2 * error.coeff(i);
    });
  } else {
    const Scalar* const xdd = reference.xdd.data();
    if (all_of(k1 + k2 == Scalar(0))) {
      return by_rows<M, Scalar>(
          [&](const auto& rows) { return rows(xdd) - rows_of_product(rows, kinematics.Jd, state.qd); });
    }
    const Vector<M, Scalar> error = Space::template difference<Scalar>(reference.x, kinematics.tip);
    return by_rows<M, Scalar>([&](const auto& rows) {
      using Value = decltype(rows(xdd));
      const Value velocity = rows(reference.xd.data()) - rows_of_product(rows, kinematics.J, state.qd);
      return rows(xdd) - rows_of_product(rows, kinematics.Jd, state.qd) + Value(k1) * velocity +
             Value(k2) * rows(error.data());
    });
  }
}

}  // namespace fpbm
