#pragma once

#include "fpbm/core/detail/mask.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/linalg/detail/axis_self_motion.hpp"
#include "fpbm/linalg/detail/spatial_self_motion.hpp"
#include "fpbm/linalg/detail/three_by_four.hpp"

namespace fpbm {

/// Factorisation of the task Jacobian J (M × N) of an arm with one self-motion, N = M + 1, without JJᵀ. Gives the
/// self-motion v with J v = 0, and a solution y of J y = b for any b (docs/equations.md, Degree of redundancy 1).
///
/// The condition number of J enters the round-off error once, and not squared. With RowFactor instead, `make count`
/// prints 4,699 instead of 3,253 instructions for step/panda/pose/fpbm. All specialisations have the same functions:
///   factor(J, kind, threshold)     false if the factorisation `kind`, 0 to kKinds − 1, is not accurate, or if |v|² is
///                                  not more than threshold times the largest possible |v|²
///   null()                         v
///   solve(b)                       y; b may be a vector of pairs
///   along(t, g)                    μᵀt, where Jᵀμ = g
///   inverse_square(length)         an upper bound on 1/σ²_min(DJ), where D multiplies the angular rows by length [m]
///   rough_inverse_square(length)   the same or a larger upper bound, at lower cost
template <int M, int N, typename Scalar>
class SelfMotion;

/// Whether SelfMotion is defined for M rows and N joints.
template <int M, int N>
inline constexpr bool kHasSelfMotion = N == M + 1 && (M == 2 || M == 3 || M == 5 || M == 6);

/// Position in the plane, by the cross product of the rows a and b of J:
///
///   v = a × b,   J⁺c = (c₁ b × v − c₂ a × v) / vᵀv.
template <typename Scalar>
class SelfMotion<2, 3, Scalar> {
 public:
  static constexpr int kKinds = 1;

  [[nodiscard]] Mask<Scalar> factor(const Matrix<2, 3, Scalar>& J, int,
                                    const Scalar& threshold = Scalar(kCertain<Scalar>)) noexcept {
    const Three<Scalar> a = {J(0, 0), J(0, 1), J(0, 2)};
    const Three<Scalar> b = {J(1, 0), J(1, 1), J(1, 2)};
    v_ = cross(a, b);
    const Scalar square = dot(v_, v_);
    const Scalar over = Scalar(1) / square;
    first_ = over * cross(b, v_);
    second_ = over * cross(v_, a);
    return square > threshold * (dot(a, a) * dot(b, b));
  }

  [[nodiscard]] Vector<3, Scalar> null() const noexcept { return {v_.x, v_.y, v_.z}; }

  template <typename Value>
  [[nodiscard]] Vector<3, Value> solve(const Vector<2, Value>& b) const noexcept {
    const auto row = [&](const Scalar& c, const Scalar& d) { return Value(c) * b.coeff(0) + Value(d) * b.coeff(1); };
    return {row(first_.x, second_.x), row(first_.y, second_.y), row(first_.z, second_.z)};
  }

  [[nodiscard]] Scalar along(const Vector<2, Scalar>& t, const Vector<3, Scalar>& g) const noexcept {
    const Three<Scalar> h = three(g.data());
    return t(0) * dot(h, first_) + t(1) * dot(h, second_);
  }

  [[nodiscard]] Scalar inverse_square(const Scalar&) const noexcept {
    return dot(first_, first_) + dot(second_, second_);
  }
  [[nodiscard]] Scalar rough_inverse_square(const Scalar& length) const noexcept { return inverse_square(length); }

 private:
  Three<Scalar> v_;
  Three<Scalar> first_;  ///< Columns of J⁺.
  Three<Scalar> second_;
};

/// Pose in the plane: J is a 3 × 4 matrix.
template <typename Scalar>
class SelfMotion<3, 4, Scalar> {
 public:
  static constexpr int kKinds = 1;

  [[nodiscard]] Mask<Scalar> factor(const Matrix<3, 4, Scalar>& J, int,
                                    const Scalar& threshold = Scalar(kCertain<Scalar>)) noexcept {
    const auto column = [&](int i) { return J.data() + 3 * i; };
    S_.factor(three(column(0), column(1)), three(column(2), column(3)));
    return S_.is_regular(threshold);
  }

  [[nodiscard]] Vector<4, Scalar> null() const noexcept {
    const auto &v12 = S_.null12(), &v34 = S_.null34();
    return {v12.first(), v12.second(), v34.first(), v34.second()};
  }

  template <typename Value>
  [[nodiscard]] Vector<4, Value> solve(const Vector<3, Value>& b) const noexcept {
    Value y[4];
    S_.solve(three(b.data()), y);
    return {y[0], y[1], y[2], y[3]};
  }

  [[nodiscard]] Scalar along(const Vector<3, Scalar>& t, const Vector<4, Scalar>& g) const noexcept {
    return S_.along(three(t.data()), {g(0), g(1)}, {g(2), g(3)});
  }

  [[nodiscard]] Scalar inverse_square(const Scalar& length) const noexcept {
    const Three<Scalar> squares = S_.inverse_squares();
    return squares.x + squares.y + squares.z / (length * length);
  }
  [[nodiscard]] Scalar rough_inverse_square(const Scalar& length) const noexcept { return inverse_square(length); }

 private:
  ThreeByFour<Scalar> S_;  ///< J
};

/// Position and axis.
template <typename Scalar>
class SelfMotion<5, 6, Scalar> : public AxisSelfMotion<Scalar> {};

/// Pose in space.
template <typename Scalar>
class SelfMotion<6, 7, Scalar> : public SpatialSelfMotion<Scalar> {};

}  // namespace fpbm
