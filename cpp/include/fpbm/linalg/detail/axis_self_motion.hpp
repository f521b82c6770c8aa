#pragma once

#include "fpbm/core/detail/mask.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/linalg/detail/three_by_four.hpp"

namespace fpbm {

/// SelfMotion of a position and an axis, by block elimination (docs/equations.md, Degree of redundancy 1). J = [B; A]
/// has three linear rows B above two angular rows A. Two joints T (the hand) keep the direction of the axis while the
/// four other joints R move the tip:
///
///   K = A_T⁻¹ (2 × 2),   X = K A_R (2 × 4),   S = B_R − B_T X (3 × 4)
///   J y = b:   S y_R = b_v − B_T K b_w,   y_T = K b_w − X y_R;      J v = 0:   S ṽ = 0,   v = (−X ṽ, ṽ).
///
/// The elimination is also valid for rows with any other meaning and unit. With RowFactor instead, `make count` prints
/// 4,327 instead of 3,839 instructions for step/ur5e/torch/fpbm_damped.
template <typename Scalar>
class AxisSelfMotion {
 public:
  static constexpr int kKinds = 15;  ///< Number of hands: all pairs of joints. Pairs with wrist joints are tried first.
  using Twice = Pair<Scalar>;

  [[nodiscard, gnu::noinline]] Mask<Scalar> factor(const Matrix<5, 6, Scalar>& J, int kind,
                                                   const Scalar& threshold = Scalar(kCertain<Scalar>)) noexcept {
    joint_ = kJoints[kind];
    const auto linear = [&](int i) { return J.data() + 5 * joint_[i]; };
    const auto angular = [&](int row, int i) -> const Scalar& { return J.coeffRef(3 + row, joint_[i]); };
    const auto both = [&](int row, int i) { return Twice(angular(row, i), angular(row, i + 1)); };
    const Twice hand0 = both(0, 0), hand1 = both(1, 0);
    const Twice a12[2] = {both(0, 2), both(1, 2)};
    const Twice a34[2] = {both(0, 4), both(1, 4)};
    const auto product = [](const Twice& x, const Twice& y, const Twice(&u)[2], const Twice(&v)[2], int i, int j) {
      return sum(x * y + u[i] * u[j] + v[i] * v[j]);
    };
    const Scalar square0 = product(hand0, hand0, a12, a34, 0, 0);
    const Scalar square1 = product(hand1, hand1, a12, a34, 1, 1);
    const Scalar along = product(hand0, hand1, a12, a34, 0, 1);
    const Scalar gram = square0 * square1 - along * along;  // det AAᵀ
    const Scalar det = hand0.first() * hand1.second() - hand0.second() * hand1.first();
    const Mask<Scalar> spans = Scalar(kSpans) * det * det > gram && gram > threshold * square0 * square1;
    if (none_of(spans)) return spans;

    const Twice over(Scalar(1) / det);
    K_[0] = over * Twice(hand1.second(), -hand0.second());
    K_[1] = over * Twice(-hand1.first(), hand0.first());
    for (int i = 0; i < 2; ++i) {
      B_[i] = three(linear(i));
      X12_[i] = Twice(K_[i].first()) * a12[0] + Twice(K_[i].second()) * a12[1];
      X34_[i] = Twice(K_[i].first()) * a34[0] + Twice(K_[i].second()) * a34[1];
    }
    rest_.factor(left(three(linear(2), linear(3)), X12_), left(three(linear(4), linear(5)), X34_));
    return spans && rest_.is_regular(threshold);
  }

  [[nodiscard, gnu::always_inline]] Vector<6, Scalar> null() const noexcept {
    const Twice &v12 = rest_.null12(), &v34 = rest_.null34();
    Vector<6, Scalar> result;
    for (int i = 0; i < 2; ++i) result.coeffRef(joint_[i]) = -sum(X12_[i] * v12 + X34_[i] * v34);
    result.coeffRef(joint_[2]) = v12.first();
    result.coeffRef(joint_[3]) = v12.second();
    result.coeffRef(joint_[4]) = v34.first();
    result.coeffRef(joint_[5]) = v34.second();
    return result;
  }

  template <typename Value>
  [[nodiscard, gnu::noinline]] Vector<6, Value> solve(const Vector<5, Value>& b) const noexcept {
    const Value x[2] = {hand(0, b), hand(1, b)};
    Value y[4];
    rest_.solve(left(three(b.data()), x), y);
    Vector<6, Value> result;
    for (int i = 0; i < 2; ++i) {
      result.coeffRef(joint_[i]) = (x[i] - (Value(X12_[i].first()) * y[0] + Value(X12_[i].second()) * y[1])) -
                                   (Value(X34_[i].first()) * y[2] + Value(X34_[i].second()) * y[3]);
    }
    for (int i = 0; i < 4; ++i) result.coeffRef(joint_[2 + i]) = y[i];
    return result;
  }

  /// gᵀs for a solution s of J s = t: g_T·K t_w + (g_R − Xᵀg_T)·S⁺(t_v − B_T K t_w).
  [[nodiscard, gnu::noinline]] Scalar along(const Vector<5, Scalar>& t, const Vector<6, Scalar>& g) const noexcept {
    const auto at = [&](int i) -> const Scalar& { return g.coeffRef(joint_[i]); };
    const Scalar x[2] = {hand(0, t), hand(1, t)};
    const Twice first(at(0)), second(at(1));
    return rest_.along(left(three(t.data()), x), Twice(at(2), at(3)) - (first * X12_[0] + second * X12_[1]),
                       Twice(at(4), at(5)) - (first * X34_[0] + second * X34_[1])) +
           (at(0) * x[0] + at(1) * x[1]);
  }

  /// See SpatialSelfMotion::rough_inverse_square().
  [[nodiscard, gnu::always_inline]] Scalar rough_inverse_square(const Scalar& length) const noexcept {
    const auto squares = [](const Twice(&a)[2], const Twice(&b)[2]) {
      return sum((a[0] * a[0] + b[0] * b[0]) + (a[1] * a[1] + b[1] * b[1]));
    };
    const Scalar P = rest_.inverse_square() * (Scalar(1) + squares(X12_, X34_));
    const Scalar K = sum(K_[0] * K_[0] + K_[1] * K_[1]);
    const Scalar B = dot(B_[0], B_[0]) + dot(B_[1], B_[1]);
    return P + Scalar(2) * (P * B + Scalar(1)) * K / (length * length);
  }
  [[nodiscard]] Scalar inverse_square(const Scalar& length) const noexcept { return rough_inverse_square(length); }

 private:
  /// Joints of the hand T, then the other joints R.
  static constexpr int kJoints[kKinds][6] = {
      {3, 4, 0, 1, 2, 5}, {2, 4, 0, 1, 3, 5}, {1, 4, 0, 2, 3, 5}, {0, 4, 1, 2, 3, 5}, {4, 5, 0, 1, 2, 3},
      {3, 5, 0, 1, 2, 4}, {2, 3, 0, 1, 4, 5}, {1, 3, 0, 2, 4, 5}, {0, 3, 1, 2, 4, 5}, {2, 5, 0, 1, 3, 4},
      {1, 5, 0, 2, 3, 4}, {0, 5, 1, 2, 3, 4}, {1, 2, 0, 3, 4, 5}, {0, 2, 1, 3, 4, 5}, {0, 1, 2, 3, 4, 5}};
  /// A pair is a hand if det² A_T is more than 1/kSpans of det AAᵀ, the sum of det² of all 15 pairs. At least one pair
  /// has at least 1/15 of the sum (docs/equations.md, Degree of redundancy 1). The value 20 leaves a margin for
  /// round-off.
  static constexpr auto kSpans = 20.0F;

  /// Entry i of K b_w: motion of joint i of the hand that produces the angular rows b_w.
  template <typename Value>
  [[nodiscard, gnu::always_inline]] Value hand(int i, const Vector<5, Value>& b) const noexcept {
    return Value(K_[i].first()) * b.coeff(3) + Value(K_[i].second()) * b.coeff(4);
  }
  /// b − B_T x: the linear rows b minus the effect of the motion x of the hand.
  template <typename Value>
  [[nodiscard, gnu::always_inline]] Three<Value> left(const Three<Value>& b, const Value (&x)[2]) const noexcept {
    return {b.x - (Value(B_[0].x) * x[0] + Value(B_[1].x) * x[1]),
            b.y - (Value(B_[0].y) * x[0] + Value(B_[1].y) * x[1]),
            b.z - (Value(B_[0].z) * x[0] + Value(B_[1].z) * x[1])};
  }

  const int* joint_;
  Twice K_[2];          ///< Rows of K.
  Three<Scalar> B_[2];  ///< Columns of B_T.
  Twice X12_[2];        ///< Rows of X.
  Twice X34_[2];
  ThreeByFour<Scalar> rest_;  ///< S
};

}  // namespace fpbm
