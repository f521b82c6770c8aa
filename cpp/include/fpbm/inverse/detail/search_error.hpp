#pragma once

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "fpbm/core/detail/mask.hpp"
#include "fpbm/geometry/space.hpp"
#include "fpbm/linalg/detail/three.hpp"

namespace fpbm {

/// Value of 1 + trace below which a rotation is almost a half turn: |θ − π| < 1e-3, where s has at least 10 correct
/// digits.
inline constexpr double kAlmostHalfTurn = 1e-6;

/// Sets the angular rows of e to 2a, with the axis a of a half turn R, in the lanes of the mask.
///
/// There, s → 0, and R = 2 a aᵀ − I: the axis is the column of R + Rᵀ + 2I with the largest diagonal entry, with the
/// sign of s.
template <typename Scalar, typename Entry>
void set_half_turn(const Mask<Scalar>& lanes, const Entry& entry, Vector<6, Scalar>& e) noexcept {
  using std::sqrt;
  const auto column = [&](int j) {
    Vector<3, Scalar> c;
    for (int i = 0; i < 3; ++i) c.coeffRef(i) = entry(i, j) + entry(j, i);
    c.coeffRef(j) += Scalar(2);
    return c;
  };
  Vector<3, Scalar> axis = column(0);
  Scalar largest = axis.coeff(0);
  for (int j = 1; j < 3; ++j) {
    const Vector<3, Scalar> c = column(j);
    const Mask<Scalar> larger = c.coeff(j) > largest;
    largest = select(larger, c.coeff(j), largest);
    for (int i = 0; i < 3; ++i) axis.coeffRef(i) = select(larger, c.coeff(i), axis.coeff(i));
  }
  const Scalar along = axis.coeff(0) * e.coeff(3) + axis.coeff(1) * e.coeff(4) + axis.coeff(2) * e.coeff(5);
  const Scalar square = axis.coeff(0) * axis.coeff(0) + axis.coeff(1) * axis.coeff(1) + axis.coeff(2) * axis.coeff(2);
  const Scalar factor = select(Mask<Scalar>(along < Scalar(0)), Scalar(-2), Scalar(2)) / sqrt(square);
  for (int i = 0; i < 3; ++i) e.coeffRef(3 + i) = select(lanes, Scalar(factor * axis.coeff(i)), e.coeff(3 + i));
}

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
    const Scalar sum = Scalar(1) + (entry(0, 0) + entry(1, 1) + entry(2, 2));
    const Scalar scale = Scalar(1) / sqrt(max(sum, Scalar(kAlmostHalfTurn)));
    Vector<6, Scalar> e;
    for (int i = 0; i < 3; ++i) e.coeffRef(i) = x.p.coeff(i) - y.p.coeff(i);
    e.coeffRef(3) = (entry(2, 1) - entry(1, 2)) * scale;
    e.coeffRef(4) = (entry(0, 2) - entry(2, 0)) * scale;
    e.coeffRef(5) = (entry(1, 0) - entry(0, 1)) * scale;
    if (any_of(sum < Scalar(kAlmostHalfTurn))) set_half_turn<Scalar>(sum < Scalar(kAlmostHalfTurn), entry, e);
    return e;
  } else {
    return Space::template difference<Scalar>(x, y);
  }
}

/// Distance [m] or angle [rad] of an error, whichever is larger.
template <typename Space, typename Scalar>
[[nodiscard]] Scalar larger_part(const Vector<Space::kRows, Scalar>& error) noexcept {
  Scalar linear(0);
  Scalar angular(0);
  for (int i = 0; i < Space::kRows; ++i) {
    (i < Space::kRows - Space::kTurns ? linear : angular) += error.coeff(i) * error.coeff(i);
  }
  return std::sqrt(std::max(linear, angular));
}

}  // namespace fpbm
