#pragma once

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "fpbm/geometry/space.hpp"
#include "fpbm/linalg/detail/three.hpp"

namespace fpbm {

/// Error of a point y from a target x for the search of postures: x ⊖ y up to third order in the angle θ of a rotation.
///
/// The rotation vector of a pose is replaced by 2 sin(θ/2) a, where a is the axis of R_x R_yᵀ: s/√(1 + trace), where s
/// is the vector of the antisymmetric part, 2 sin θ a. The squared length is 3 − trace, half the square of the
/// Frobenius norm of R_x − R_y, a smooth function except at θ = π.
template <typename Space, typename Scalar>
[[nodiscard, gnu::always_inline]] inline Vector<Space::kRows, Scalar> search_error(
    const typename Space::template Point<Scalar>& x, const typename Space::template Point<Scalar>& y) noexcept {
  if constexpr (std::is_same_v<Space, Pose>) {
    using std::max;
    using std::sqrt;
    const auto entry = [&](int i, int j) {
      return x.R.coeff(i, 0) * y.R.coeff(j, 0) + x.R.coeff(i, 1) * y.R.coeff(j, 1) + x.R.coeff(i, 2) * y.R.coeff(j, 2);
    };
    const Scalar trace = entry(0, 0) + entry(1, 1) + entry(2, 2);
    // The least value of 1 + trace bounds the length of the error by √2 near θ = π, where the axis is lost in
    // round-off.
    const Scalar scale = Scalar(1) / sqrt(max(Scalar(1) + trace, Scalar(1e-6)));
    Vector<6, Scalar> e;
    for (int i = 0; i < 3; ++i) e.coeffRef(i) = x.p.coeff(i) - y.p.coeff(i);
    e.coeffRef(3) = (entry(2, 1) - entry(1, 2)) * scale;
    e.coeffRef(4) = (entry(0, 2) - entry(2, 0)) * scale;
    e.coeffRef(5) = (entry(1, 0) - entry(0, 1)) * scale;
    return e;
  } else {
    return Space::template difference<Scalar>(x, y);
  }
}

}  // namespace fpbm
