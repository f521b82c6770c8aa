#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <type_traits>

#include "fpbm/core/detail/mask.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/linalg/detail/three_by_four.hpp"

namespace fpbm {

/// SelfMotion of a pose in space, by elimination of 3 × 3 blocks (docs/equations.md, Degree of redundancy 1). J = [B;
/// A] has linear rows B above angular rows A. Three joints T whose axes span space (the hand) keep the orientation of
/// the tip while the four other joints R move the tip:
///
///   K = A_T⁻¹,   X = K A_R,   S = B_R − B_T X   (3 × 4)
///   J y = b:   S y_R = b_v − B_T K b_w,   y_T = K b_w − X y_R;      J v = 0:   S ṽ = 0,   v = (−X ṽ, ṽ).
template <typename Scalar>
class SpatialSelfMotion {
 public:
  static constexpr int kKinds = 5;  ///< Number of hands: all triples of consecutive joints. The wrist is tried first.
  using Twice = Pair<Scalar>;

  [[nodiscard, gnu::noinline]] Mask<Scalar> factor(const Matrix<6, 7, Scalar>& J, int kind,
                                                   const Scalar& threshold = Scalar(kCertain<Scalar>)) noexcept {
    using std::abs;
    joint_ = kJoints[kind];
    const auto linear = [&](int i) { return J.data() + 6 * joint_[i]; };
    const auto angular = [&](int i) { return J.data() + 6 * joint_[i] + 3; };
    const Three<Scalar> a = three(angular(0)), b = three(angular(1)), c = three(angular(2));
    const Three<Scalar> ab = cross(a, b);
    const Scalar det = dot(ab, c);
    const Mask<Scalar> spans = abs(det) > Scalar(kSpans);
    if (none_of(spans)) return spans;

    const Scalar over = Scalar(1) / det;
    K_[0] = over * cross(b, c);
    K_[1] = over * cross(c, a);
    K_[2] = over * ab;
    B_ = {three(linear(0)), three(linear(1)), three(linear(2))};
    X12_ = hand(three(angular(3), angular(4)));
    X34_ = hand(three(angular(5), angular(6)));
    rest_.factor(left(three(linear(3), linear(4)), X12_), left(three(linear(5), linear(6)), X34_));
    return spans && rest_.is_regular(threshold);
  }

  [[nodiscard, gnu::always_inline]] Vector<7, Scalar> null() const noexcept {
    const Twice &v12 = rest_.null12(), &v34 = rest_.null34();
    const Three<Scalar> turns = turns_of_null();
    const Scalar v[7] = {turns.x, turns.y, turns.z, v12.first(), v12.second(), v34.first(), v34.second()};
    Vector<7, Scalar> result;
    for (int i = 0; i < 7; ++i) result.coeffRef(joint_[i]) = v[i];
    return result;
  }

  template <typename Value>
  [[nodiscard, gnu::noinline]] Vector<7, Value> solve(const Vector<6, Value>& b) const noexcept {
    const Three<Value> x = hand(three(b.data() + 3));
    Value y[4];
    rest_.solve(left(three(b.data()), x), y);
    const auto row = [&](const Value& x0, const Twice& x12, const Twice& x34) {
      return (x0 - (Value(x12.first()) * y[0] + Value(x12.second()) * y[1])) -
             (Value(x34.first()) * y[2] + Value(x34.second()) * y[3]);
    };
    Vector<7, Value> result;
    result.coeffRef(joint_[0]) = row(x.x, X12_.x, X34_.x);
    result.coeffRef(joint_[1]) = row(x.y, X12_.y, X34_.y);
    result.coeffRef(joint_[2]) = row(x.z, X12_.z, X34_.z);
    for (int i = 0; i < 4; ++i) result.coeffRef(joint_[3 + i]) = y[i];
    return result;
  }

  /// gᵀs for a solution s of J s = t: g_T·K t_w + (g_R − Xᵀg_T)·S⁺(t_v − B_T K t_w).
  [[nodiscard, gnu::noinline]] Scalar along(const Vector<6, Scalar>& t, const Vector<7, Scalar>& g) const noexcept {
    const auto at = [&](int i) -> const Scalar& { return g.coeffRef(joint_[i]); };
    const Three<Scalar> hands = {at(0), at(1), at(2)};
    const Three<Twice> both = repeated<Twice>(hands);
    const Three<Scalar> x = hand(three(t.data() + 3));
    return rest_.along(left(three(t.data()), x), Twice(at(3), at(4)) - dot(both, X12_),
                       Twice(at(5), at(6)) - dot(both, X34_)) +
           dot(hands, x);
  }

  /// ‖P‖² + (‖P‖ ‖G‖ + ‖K‖)²/length², with Frobenius norms: an upper bound on the squared norm of
  /// H = [P, ((K, 0) − P G)/length], a right inverse of DJ, where P = (−X S⁺, S⁺) and G = B_T K. Hence
  /// 1/σ²_min(DJ) ≤ ‖H‖² (docs/equations.md, Degree of redundancy 1, Damping).
  [[nodiscard, gnu::noinline]] Scalar inverse_square(const Scalar& length) const noexcept {
    using std::sqrt;
    Twice s12[3], s34[3];
    rest_.inverse(s12, s34);
    const Scalar P = rest_.inverse_square() + squares(hand(s12, s34));
    const Scalar G = squares(lever());
    const Scalar K = squares(K_);
    return P + (P * G + K + Scalar(2) * sqrt(P * G * K)) / (length * length);
  }

  /// inverse_square() with the bounds ‖P‖² ≤ ‖S⁺‖² (1 + ‖X‖²), ‖G‖ ≤ ‖B_T‖ ‖K‖ and (a + b)² ≤ 2 (a² + b²).
  [[nodiscard, gnu::always_inline]] Scalar rough_inverse_square(const Scalar& length) const noexcept {
    const Scalar X = sum(dot(X12_, X12_) + dot(X34_, X34_));
    const Scalar P = rest_.inverse_square() * (Scalar(1) + X);
    return P + Scalar(2) * (P * squares(B_) + Scalar(1)) * squares(K_) / (length * length);
  }

 private:
  /// Joints of the hand T, then the other joints R.
  static constexpr int kJoints[kKinds][7] = {{4, 5, 6, 0, 1, 2, 3},
                                             {2, 3, 4, 0, 1, 5, 6},
                                             {3, 4, 5, 0, 1, 2, 6},
                                             {1, 2, 3, 0, 4, 5, 6},
                                             {0, 1, 2, 3, 4, 5, 6}};
  /// Joints are a hand if |det A_T| is larger than this value (docs/equations.md, Degree of redundancy 1). Of 10,000
  /// random postures of each preset with seven joints, at most one has no hand. With 0.6, up to 93 have no hand. With
  /// 0.03, the round-off error of v is up to six times larger. `SelfMotions*` passes with 0.03 to 0.6.
  static constexpr auto kSpans = 0.3F;

  using Rows = std::array<Three<Scalar>, 3>;

  [[nodiscard]] static Scalar squares(const Rows& rows) noexcept {
    return dot(rows[0], rows[0]) + dot(rows[1], rows[1]) + dot(rows[2], rows[2]);
  }
  /// −X ṽ, the self-motion of the hand.
  [[nodiscard, gnu::always_inline]] Three<Scalar> turns_of_null() const noexcept {
    const Twice &v12 = rest_.null12(), &v34 = rest_.null34();
    const auto row = [&](const Twice& x12, const Twice& x34) { return -sum(x12 * v12 + x34 * v34); };
    return {row(X12_.x, X34_.x), row(X12_.y, X34_.y), row(X12_.z, X34_.z)};
  }
  /// −X S⁺, with S⁺ from ThreeByFour::inverse().
  [[nodiscard]] Rows hand(const Twice (&s12)[3], const Twice (&s34)[3]) const noexcept {
    const auto row = [&](const Twice& x12, const Twice& x34) {
      const auto entry = [&](int j) {
        const Twice both = x12 * s12[j] + x34 * s34[j];
        return both.second() - both.first();
      };
      return Three<Scalar>{entry(0), entry(1), entry(2)};
    };
    return {row(X12_.x, X34_.x), row(X12_.y, X34_.y), row(X12_.z, X34_.z)};
  }
  /// G = B_T K.
  [[nodiscard]] Rows lever() const noexcept {
    const auto row = [&](const Scalar& a, const Scalar& b, const Scalar& c) {
      return (a * K_[0] + b * K_[1]) + c * K_[2];
    };
    return {row(B_[0].x, B_[1].x, B_[2].x), row(B_[0].y, B_[1].y, B_[2].y), row(B_[0].z, B_[1].z, B_[2].z)};
  }
  /// K a: motion of the hand that produces the angular velocity a.
  template <typename Value>
  [[nodiscard, gnu::always_inline]] Three<Value> hand(const Three<Value>& a) const noexcept {
    return {dot(repeated<Value>(K_[0]), a), dot(repeated<Value>(K_[1]), a), dot(repeated<Value>(K_[2]), a)};
  }
  /// b − B_T x: the linear rows b minus the effect of the motion x of the hand.
  template <typename Value>
  [[nodiscard, gnu::always_inline]] Three<Value> left(const Three<Value>& b, const Three<Value>& x) const noexcept {
    return {(b.x - Value(B_[0].x) * x.x) - (Value(B_[1].x) * x.y + Value(B_[2].x) * x.z),
            (b.y - Value(B_[0].y) * x.x) - (Value(B_[1].y) * x.y + Value(B_[2].y) * x.z),
            (b.z - Value(B_[0].z) * x.x) - (Value(B_[1].z) * x.y + Value(B_[2].z) * x.z)};
  }

  const int* joint_;
  Rows K_;            ///< Rows of K.
  Rows B_;            ///< Columns of B_T.
  Three<Twice> X12_;  ///< Columns of X.
  Three<Twice> X34_;
  ThreeByFour<Scalar> rest_;  ///< S
};

}  // namespace fpbm
