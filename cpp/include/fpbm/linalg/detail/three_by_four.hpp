#pragma once

#include "fpbm/linalg/detail/three.hpp"

namespace fpbm {

/// Least ratio of |ṽ|² to its largest value (is_regular). The relative error of ṽ is about ε/√ratio: 2e-10 at this
/// ratio, and 5e-6 in float. Rows with a smaller ratio are factorised by RowFactor. 0.4 ε to 4e5 ε pass `SelfMotions*`.
template <typename Scalar>
inline constexpr auto kCertain = 4096 * std::numeric_limits<Number<Scalar>>::epsilon();

/// Null vector ṽ and pseudoinverse of a matrix S of three rows and four columns s₁ … s₄, from its minors
/// (docs/equations.md, Degree of redundancy 1, Block elimination). With c_kl = s_k × s_l:
///
///   ṽ = (s₂·c₃₄, −s₁·c₃₄, s₄·c₁₂, −s₃·c₁₂),   S ṽ = 0,   |ṽ|² = det SSᵀ,
///   S⁺a = D ṽ / |ṽ|²,   where D is skew-symmetric with the entries ± c_kl·a (combine).
///
/// The formulas are Cramer's rule for [S; ṽᵀ] y = [a; 0], and need one division, no pivoting and no square root. The
/// condition number of S enters the round-off error once, and not squared as with SSᵀ.
///
/// A Twice holds the values of two columns or minors: s12 is (s₁, s₂), c13_24 is (c₁₃, c₂₄), v34 is (ṽ₃, ṽ₄).
template <typename Scalar>
class ThreeByFour {
 public:
  using Twice = Pair<Scalar>;

  /// Sets S by its columns: s12 is (s₁, s₂), s34 is (s₃, s₄). If |ṽ|² > 0, all other results are finite.
  [[gnu::always_inline]] void factor(const Three<Twice>& s12, const Three<Twice>& s34) noexcept {
    const Three<Twice> s13 = firsts(s12, s34);
    const Three<Twice> s24 = seconds(s12, s34);
    c12_34_ = cross(s13, s24);
    c13_24_ = cross(s12, s34);
    c14_23_ = cross(s12, swapped(s34));
    const Three<Twice> c34_12 = swapped(c12_34_);
    const Twice v13 = dot(s24, c34_12);
    const Twice v24 = Twice(Scalar(0)) - dot(s13, c34_12);
    v12_ = firsts(v13, v24);
    v34_ = seconds(v13, v24);
    square_ = sum(v12_ * v12_ + v34_ * v34_);
    over_ = Scalar(1) / square_;
    const auto row = [](const Twice& a, const Twice& b) { return sum(a * a + b * b); };
    largest_ = row(s12.x, s34.x) * row(s12.y, s34.y) * row(s12.z, s34.z);
  }

  /// Whether |ṽ|² is more than threshold times its largest value, the product of the squared lengths of the rows of S.
  /// |ṽ|² has its largest value if the rows are orthogonal. The round-off error of ṽ is proportional to the product of
  /// the lengths of the rows.
  [[nodiscard]] Mask<Scalar> is_regular(const Scalar& threshold) const noexcept {
    return square_ > threshold * largest_;
  }

  /// |ṽ|²
  [[nodiscard]] const Scalar& null_square() const noexcept { return square_; }
  /// ṽ
  [[nodiscard]] const Twice& null12() const noexcept { return v12_; }
  [[nodiscard]] const Twice& null34() const noexcept { return v34_; }

  /// y = S⁺a.
  template <typename Value>
  [[gnu::always_inline]] void solve(const Three<Value>& a, Value (&y)[4]) const noexcept {
    combine(minors(a), y);
  }

  /// S⁺ by columns: s12[j] has rows 1 and 2 of column j, s34[j] has rows 3 and 4. Rows 2 and 4 have the opposite sign.
  void inverse(Twice (&s12)[3], Twice (&s34)[3]) const noexcept {
    const Twice over(over_);
    const Twice v12 = over * v12_, v34 = over * v34_;
    const Twice v21 = swapped(v12), v43 = swapped(v34);
    const Twice v1(v12.first()), v2(v12.second()), v3(v34.first()), v4(v34.second());
    const auto column = [&](int j, const Twice& d12_34, const Twice& d13_24, const Twice& d14_23) {
      const Twice d13_14 = firsts(d13_24, d14_23), d24_23 = seconds(d13_24, d14_23);
      const Twice d24_14(d24_23.first(), d13_14.second()), d23_13(d24_23.second(), d13_14.first());
      s12[j] = v3 * d24_14 - v4 * d23_13 - Twice(d12_34.second()) * v21;
      s34[j] = v2 * swapped(d13_14) - v1 * d24_23 - Twice(d12_34.first()) * v43;
    };
    column(0, c12_34_.x, c13_24_.x, c14_23_.x);
    column(1, c12_34_.y, c13_24_.y, c14_23_.y);
    column(2, c12_34_.z, c13_24_.z, c14_23_.z);
  }

  /// hᵀS⁺a.
  [[nodiscard]] Scalar along(const Three<Scalar>& a, const Twice& h12, const Twice& h34) const noexcept {
    const auto [d12, d13, d14, d23, d24, d34] = minors(a);
    const Scalar h1 = h12.first(), h2 = h12.second(), h3 = h34.first(), h4 = h34.second();
    const Scalar v1 = v12_.first(), v2 = v12_.second(), v3 = v34_.first(), v4 = v34_.second();
    return over_ * (((h2 * v1 - h1 * v2) * d34 + (h1 * v3 - h3 * v1) * d24) +
                    ((h4 * v1 - h1 * v4) * d23 + (h3 * v2 - h2 * v3) * d14) +
                    ((h2 * v4 - h4 * v2) * d13 + (h4 * v3 - h3 * v4) * d12));
  }

  /// Squared lengths of the columns of S⁺, which are the diagonal of (SSᵀ)⁻¹. Entry i is Σ m²/|ṽ|² over the 2 × 2
  /// minors m of the two other rows of S. The minors m are component i of the c_kl.
  [[nodiscard]] Three<Scalar> inverse_squares() const noexcept {
    const auto squares = [this](const Twice& a, const Twice& b, const Twice& c) {
      return over_ * sum(a * a + b * b + c * c);
    };
    return {squares(c12_34_.x, c13_24_.x, c14_23_.x), squares(c12_34_.y, c13_24_.y, c14_23_.y),
            squares(c12_34_.z, c13_24_.z, c14_23_.z)};
  }
  /// ‖S⁺‖² (Frobenius norm), the sum of inverse_squares().
  [[nodiscard]] Scalar inverse_square() const noexcept {
    return over_ * sum(dot(c12_34_, c12_34_) + dot(c13_24_, c13_24_) + dot(c14_23_, c14_23_));
  }

 private:
  /// d_kl = c_kl·a.
  template <typename Value>
  struct Minors {
    Value d12, d13, d14, d23, d24, d34;
  };

  [[nodiscard]] static Minors<Scalar> apart(const Twice& d12_34, const Twice& d13_24, const Twice& d14_23) noexcept {
    return {d12_34.first(), d13_24.first(), d14_23.first(), d14_23.second(), d13_24.second(), d12_34.second()};
  }
  [[nodiscard]] Minors<Scalar> minors(const Three<Scalar>& a) const noexcept {
    const Three<Twice> both = repeated<Twice>(a);
    return apart(dot(c12_34_, both), dot(c13_24_, both), dot(c14_23_, both));
  }
  [[nodiscard]] Minors<Twice> minors(const Three<Twice>& a) const noexcept {
    const Three<Twice> one = repeated<Twice>(first(a));
    const Three<Twice> other = repeated<Twice>(second(a));
    const Twice d12_34 = dot(c12_34_, one), e12_34 = dot(c12_34_, other);
    const Twice d13_24 = dot(c13_24_, one), e13_24 = dot(c13_24_, other);
    const Twice d14_23 = dot(c14_23_, one), e14_23 = dot(c14_23_, other);
    return {firsts(d12_34, e12_34),  firsts(d13_24, e13_24),  firsts(d14_23, e14_23),
            seconds(d14_23, e14_23), seconds(d13_24, e13_24), seconds(d12_34, e12_34)};
  }

  /// y = D ṽ / |ṽ|², where
  ///
  ///   D = [0, −d₃₄, d₂₄, −d₂₃;  d₃₄, 0, −d₁₄, d₁₃;  −d₂₄, d₁₄, 0, −d₁₂;  d₂₃, −d₁₃, d₁₂, 0].
  template <typename Value>
  void combine(const Minors<Value>& d, Value (&y)[4]) const noexcept {
    const Value v1(over_ * v12_.first());
    const Value v2(over_ * v12_.second());
    const Value v3(over_ * v34_.first());
    const Value v4(over_ * v34_.second());
    y[0] = v3 * d.d24 - v2 * d.d34 - v4 * d.d23;
    y[1] = v1 * d.d34 - v3 * d.d14 + v4 * d.d13;
    y[2] = v2 * d.d14 - v1 * d.d24 - v4 * d.d12;
    y[3] = v1 * d.d23 - v2 * d.d13 + v3 * d.d12;
  }

  Three<Twice> c12_34_;
  Three<Twice> c13_24_;
  Three<Twice> c14_23_;
  Twice v12_;
  Twice v34_;
  Scalar square_;   ///< |ṽ|²
  Scalar over_;     ///< 1/|ṽ|²
  Scalar largest_;  ///< Product of the squared lengths of the rows of S.
};

}  // namespace fpbm
