#pragma once

#include <cmath>
#include <cstddef>

#include "fpbm/core/detail/mask.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/geometry/rotation.hpp"
#include "fpbm/linalg/detail/entrywise.hpp"
#include "fpbm/linalg/detail/pair.hpp"
#include "fpbm/linalg/detail/split_vector.hpp"
#include "fpbm/linalg/detail/sums.hpp"

namespace fpbm {

/// Largest sin²θ up to which angle_over_sine() is exact to round-off: the first omitted term, 0.0098 sin¹⁸θ, is at most
/// 6e-19.
inline constexpr double kLargestSquare = 1.0 / 64.0;

/// θ/sin θ for z = sin²θ, by the arcsine series.
template <typename Scalar>
[[nodiscard, gnu::always_inline]] inline Scalar angle_over_sine(const Scalar& z) noexcept {
  // Even and odd powers are summed separately, so that a processor computes two short dependency chains in parallel.
  // The coefficients are written as Scalar constants, so that float needs no conversion from double at run time.
  const Scalar y = z * z;
  Scalar even = Scalar(6435.0 / 557056.0) * y + Scalar(231.0 / 13312.0);
  even = (even * y + Scalar(35.0 / 1152.0)) * y + Scalar(3.0 / 40.0);
  even = even * y + Scalar(1);
  Scalar odd = Scalar(143.0 / 10240.0) * y + Scalar(63.0 / 2816.0);
  odd = (odd * y + Scalar(5.0 / 112.0)) * y + Scalar(1.0 / 6.0);
  return even + z * odd;
}

namespace rotation_detail {

/// Rotation vector of a rotation matrix from its quaternion, which is accurate at every angle.
template <typename Scalar>
[[nodiscard]] Vector<3, Scalar> large_rotation_vector(const Matrix<3, 3, Scalar>& R) noexcept {
  if constexpr (kInLanes<Scalar>) {
    Vector<3, Scalar> r;
    for (std::size_t lane = 0; lane < Scalar::size(); ++lane) {
      const auto number = [lane](const Scalar& x) -> Number<Scalar> { return x[lane]; };
      const Vector<3, Number<Scalar>> one = large_rotation_vector<Number<Scalar>>(R.unaryExpr(number));
      for (int i = 0; i < 3; ++i) r(i)[lane] = one(i);
    }
    return r;
  } else {
    using std::atan2;
    const Vector<4, Scalar> q = quaternion(R);
    const Vector<3, Scalar> v(q(1), q(2), q(3));
    const Scalar sine = norm(v);
    const Scalar scale = sine > Scalar(0) ? atan2(sine, q(0)) / sine : Scalar(1);
    return entrywise(v, [&](Eigen::Index i) { return Scalar(2) * scale * v(i); });
  }
}

/// Rotation vector r of a rotation matrix R from its trace and s, the vector of R − Rᵀ: s = 2 sin|r| r/|r|. whole()
/// returns R.
///
/// Small angles, which are the typical errors, need no square root and no division.
template <typename Scalar, typename Whole>
[[nodiscard, gnu::always_inline]] inline Vector<3, Scalar> rotation_vector(const Vector<3, Scalar>& s,
                                                                           const Scalar& trace,
                                                                           const Whole& whole) noexcept {
  const Scalar z = squared_norm(s) / Scalar(4);
  const Mask<Scalar> small = trace > Scalar(2) && z < Scalar(kLargestSquare);
  const Scalar half = angle_over_sine(z) / Scalar(2);
  Vector<3, Scalar> r(half * s.coeff(0), half * s.coeff(1), half * s.coeff(2));
  if (all_of(small)) return r;
  const Vector<3, Scalar> large = large_rotation_vector<Scalar>(whole());
  if constexpr (kInLanes<Scalar>) {
    for (int i = 0; i < 3; ++i) where(!small, r(i)) = large(i);
    return r;
  } else {
    return large;
  }
}

}  // namespace rotation_detail

/// Rotation vector of a rotation matrix, |r| ≤ π [rad]; the inverse of rotation().
template <typename Scalar>
[[nodiscard]] Vector<3, Scalar> rotation_vector(const Matrix<3, 3, Scalar>& R) noexcept {
  const Vector<3, Scalar> s(R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1));
  return rotation_detail::rotation_vector<Scalar>(s, trace_of(R), [&R] { return R; });
}

/// Rotation vector of R_x R_yᵀ, |r| ≤ π [rad]. If the angle is small, the product is not stored in memory.
template <typename Scalar>
[[nodiscard, gnu::always_inline]] inline Vector<3, Scalar> rotation_between(const Matrix<3, 3, Scalar>& x,
                                                                            const Matrix<3, 3, Scalar>& y) noexcept {
  using Split = SplitVector<Scalar>;
  const auto column = [&](int j) {
    const auto term = [&](int k) { return Pair<Scalar>(y.coeff(j, k)) * Split::load(x.data() + 3 * k); };
    return term(0) + term(1) + term(2);
  };
  const Split a = column(0);
  const Split b = column(1);
  const Split c = column(2);
  const Vector<3, Scalar> s(b.z - c.xy.second(), c.xy.first() - a.z, a.xy.second() - b.xy.first());
  return rotation_detail::rotation_vector<Scalar>(s, a.xy.first() + b.xy.second() + c.z,
                                                  [&]() -> Matrix<3, 3, Scalar> { return times(x, transposed(y)); });
}

}  // namespace fpbm
