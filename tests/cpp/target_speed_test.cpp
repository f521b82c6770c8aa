#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "fpbm/target/target_filter.hpp"
#include "support/random.hpp"
#include "support/watched_filter.hpp"

/// TargetFilter::set_speed(): the velocity bounds become a fraction of the given bounds, at any moment of any motion.
namespace fpbm::test::target_speed_laws {
namespace {

template <typename Scalar>
TargetBounds<Scalar> bounds() {
  return {Scalar(0.5), Scalar(3), Scalar(100), Scalar(1.5), Scalar(8), Scalar(300)};
}

/// A watched filter. In addition to the bounds, advance() checks the velocity against the quickest change to the
/// reduced bound from the motion at the last change of the speed.
template <typename Space, typename Scalar>
class SlowedFilter : public WatchedFilter<Space, Scalar> {
 public:
  using Base = WatchedFilter<Space, Scalar>;
  using Axis = TimeOptimalAxis<Scalar>;

  SlowedFilter(const typename Base::Filter::Point& x0, const TargetBounds<Scalar>& given,
               const TargetFilterOptions<Scalar>& options = {})
      : Base(x0, given, options), lengths_(given.lengths()), angles_(lengths_), dt_(options.dt) {
    if constexpr (Space::kTurns > 0) angles_ = given.angles();
    set_speed(Scalar(1));
  }

  void set_speed(Scalar fraction) {
    const Reference<Space, Scalar> before = this->filter.reference();
    ASSERT_TRUE(this->filter.set_speed(fraction));
    ASSERT_EQ(this->filter.speed(), fraction);
    const auto& [x, xd, xdd] = this->filter.reference();
    ASSERT_TRUE(xd == before.xd && xdd == before.xdd);
    for (int i = 0; i < Space::kRows; ++i) {
      change_[i][0] = {Scalar(0), xd(i), xdd(i)};
      change_[i][1] = {Scalar(0), -xd(i), -xdd(i)};
    }
  }

  /// The reduced bound on a velocity.
  [[nodiscard]] Scalar bound(int i) const { return this->filter.speed() * axis(i).velocity; }

  void advance() {
    ASSERT_NO_FATAL_FAILURE(Base::advance());
    Scalar fastest_turn{0};
    for (int i = 0; i < Space::kRows; ++i) {
      for (auto& state : change_[i]) state = axis(i).change(state, bound(i), dt_);
      if (turns(i)) fastest_turn = std::max({fastest_turn, change_[i][0].v, change_[i][1].v});
    }
    for (int i = 0; i < Space::kRows; ++i) {
      const Scalar round_off = 256 * std::numeric_limits<Scalar>::epsilon() * axis(i).velocity;
      for (const int sign : {0, 1}) {
        // About a fixed axis, the largest angle decelerates in minimum time, and the other angles in proportion.
        const Scalar most = std::max(Space::kTurns == 3 && turns(i) ? fastest_turn : change_[i][sign].v, bound(i));
        const Scalar v = this->filter.reference().xd(i);
        ASSERT_LE(sign == 0 ? v : -v, most + round_off) << i;
      }
    }
  }

 private:
  [[nodiscard]] static bool turns(int i) { return i >= Space::kRows - Space::kTurns; }
  [[nodiscard]] const Axis& axis(int i) const { return turns(i) ? angles_ : lengths_; }

  Axis lengths_;
  Axis angles_;
  Scalar dt_;
  AxisState<Scalar> change_[Space::kRows][2];  ///< In the positive and negative direction.
};

template <typename Kind>
class TargetSpeeds : public ::testing::Test {};
TYPED_TEST_SUITE(TargetSpeeds, FilterKinds, );

/// Random messages and random changes of the speed, from 1e-6 to 1, in the middle of motions.
TYPED_TEST(TargetSpeeds, keep_the_bounds) {
  using Space = typename TypeParam::S;
  using Scalar = typename TypeParam::T;
  Random random(61);
  for (int i = 0; i < trials(60); ++i) {
    SCOPED_TRACE("trial " + std::to_string(i));
    SlowedFilter<Space, Scalar> slowed(random_point<Space, Scalar>(random, 1.0), random_bounds<Space, Scalar>(random));
    for (int k = 0; k < 3000; ++k) {
      const double what = random.uniform(0.0, 1.0);
      if (what < 0.01) {
        slowed.set_speed(static_cast<Scalar>(std::pow(10.0, random.uniform(i % 2 == 0 ? -1.0 : -6.0, 0.0))));
      } else if (what < 0.03) {
        const auto v = random.uniform(Space::kRows, -5.0, 5.0).template cast<Scalar>().eval();
        (void)slowed.filter.push_twist(v, 1e-3 * k);
      } else if (what < 0.07) {
        (void)slowed.filter.push(random_point<Space, Scalar>(random, what < 0.05 ? 1.0 : 0.1), 1e-3 * k);
      }
      ASSERT_NO_FATAL_FAILURE(slowed.advance()) << k;
    }
    slowed.set_speed(Scalar(1));
    for (int k = 0; k < 500; ++k) ASSERT_NO_FATAL_FAILURE(slowed.advance());
    const auto x = random_point<Space, Scalar>(random, 1.0);
    ASSERT_TRUE(slowed.filter.push(x));
    ASSERT_LT(slowed.reach(x, 200000), 200000);
  }
}

/// From rest to a target at rest, the reference does not overshoot the target for any changes of the speed.
TYPED_TEST(TargetSpeeds, stop_on_the_target_without_overshoot) {
  using Space = typename TypeParam::S;
  using Scalar = typename TypeParam::T;
  Random random(62);
  for (int i = 0; i < trials(60); ++i) {
    SCOPED_TRACE("trial " + std::to_string(i));
    const auto x0 = random_point<Space, Scalar>(random, 1.0);
    SlowedFilter<Space, Scalar> slowed(x0, random_bounds<Space, Scalar>(random));
    const auto x =
        Space::template displace<Scalar>(x0, random.uniform(Space::kRows, -1.0, 1.0).template cast<Scalar>());
    ASSERT_TRUE(slowed.filter.push(x));
    const Scalar round_off = 64 * std::numeric_limits<Scalar>::epsilon() * (extent(x) + 1);
    const auto start = Space::template difference<Scalar>(slowed.filter.ahead(Scalar(0)).x, x);
    int ticks = 0;
    for (; ticks < 300000 && !(slowed.at(x) && slowed.filter.reference().xd.isZero(0)); ++ticks) {
      if (random.uniform(0.0, 1.0) < 0.01) slowed.set_speed(static_cast<Scalar>(random.uniform(0.02, 1.0)));
      ASSERT_NO_FATAL_FAILURE(slowed.advance()) << ticks;
      const auto left = Space::template difference<Scalar>(slowed.filter.reference().x, x);
      for (int axis = 0; axis < Space::kRows; ++axis) {
        ASSERT_GE(start(axis) > 0 ? left(axis) : -left(axis), -round_off) << axis << ", tick " << ticks;
      }
    }
    ASSERT_LT(ticks, 300000);
  }
}

/// After the least time of the deceleration, the velocity is the reduced bound. With the fraction 1, the motion is fast
/// again. Twists that were pushed before a change are also limited.
TYPED_TEST(TargetSpeeds, limit_twists_before_and_after_a_change) {
  using Space = typename TypeParam::S;
  using Scalar = typename TypeParam::T;
  using Twist = Vector<Space::kRows, Scalar>;
  TargetFilterOptions<Scalar> options;
  options.timeout = Scalar(10);
  Random random(63);
  SlowedFilter<Space, Scalar> slowed(random_point<Space, Scalar>(random, 1.0), bounds<Scalar>(), options);
  const auto fastest = [&] {
    Twist v;
    for (int i = 0; i < Space::kRows; ++i) v(i) = i % 2 == 0 ? slowed.bound(i) : -slowed.bound(i);
    return v;
  };
  Twist large = Twist::Constant(std::numeric_limits<Scalar>::max());
  for (int i = 1; i < Space::kRows; i += 2) large(i) *= Scalar(-1);
  slowed.set_speed(Scalar(0.2));
  ASSERT_TRUE(slowed.filter.push_twist(large));
  for (const double fraction : {0.3, 1.0, 0.1, 0.5}) {
    slowed.set_speed(static_cast<Scalar>(fraction));
    for (int k = 0; k < 300; ++k) ASSERT_NO_FATAL_FAILURE(slowed.advance());
    EXPECT_EQ(slowed.filter.reference().xd, fastest()) << fraction;
    EXPECT_TRUE(slowed.filter.reference().xdd.isZero(0)) << fraction;
  }
  ASSERT_TRUE(slowed.filter.push_twist(fastest() / 2));  // Below the bound.
  for (int k = 0; k < 300; ++k) ASSERT_NO_FATAL_FAILURE(slowed.advance());
  EXPECT_EQ(slowed.filter.reference().xd, Twist(fastest() / 2));
}

/// A target that is faster than the reduced bound is followed at the bound, with a lag. At full speed, the lag
/// vanishes.
TYPED_TEST(TargetSpeeds, follow_a_faster_target_with_a_lag) {
  using Space = typename TypeParam::S;
  using Scalar = typename TypeParam::T;
  using Twist = Vector<Space::kRows, Scalar>;
  SlowedFilter<Space, Scalar> slowed(Space::template origin<Scalar>(), bounds<Scalar>());
  const Twist v = Twist::Unit(0) * Scalar(0.4);
  const auto target = [&](int tick) {
    return Space::template displace<Scalar>(Space::template origin<Scalar>(),
                                            Scalar(1e-3) * static_cast<Scalar>(tick) * v);
  };
  int tick = 0;
  const auto run = [&](int until) {
    for (; tick < until; ++tick) {
      if (tick % 33 == 0) {
        ASSERT_TRUE(slowed.filter.push(target(tick), 1e-3 * tick));
      }
      ASSERT_NO_FATAL_FAILURE(slowed.advance());
    }
  };
  const auto lag = [&] { return Space::template difference<Scalar>(target(tick), slowed.filter.reference().x)(0); };
  run(2000);
  EXPECT_LE(std::abs(lag()), Scalar(1e-4));
  slowed.set_speed(Scalar(0.5));
  run(4000);
  EXPECT_EQ(slowed.filter.reference().xd(0), Scalar(0.25));
  EXPECT_NEAR(lag(), 0.15 * 2.0, 0.02);  // The deceleration takes 0.08 s.
  slowed.set_speed(Scalar(1));
  run(9000);
  EXPECT_LE(std::abs(lag()), Scalar(1e-4));
  EXPECT_NEAR(slowed.filter.reference().xd(0), Scalar(0.4), Scalar(1e-4));
}

/// A target that is faster than the reduced bound does not displace the reference if it overtakes the reference exactly
/// at the start of a tick.
TYPED_TEST(TargetSpeeds, stay_within_the_bound_when_a_target_overtakes) {
  using Space = typename TypeParam::S;
  using Scalar = typename TypeParam::T;
  using Twist = Vector<Space::kRows, Scalar>;
  TargetFilterOptions<Scalar> options;
  options.start = 0.0;
  options.timeout = Scalar(10);
  SlowedFilter<Space, Scalar> slowed(Space::template origin<Scalar>(), bounds<Scalar>(), options);
  slowed.set_speed(Scalar(0.5));
  const Twist v = Twist::Unit(0) * Scalar(0.25);
  ASSERT_TRUE(slowed.filter.push_twist(v, 0.0));
  for (int k = 0; k < 1000; ++k) ASSERT_NO_FATAL_FAILURE(slowed.advance());
  const auto x = slowed.filter.reference().x;
  for (const double before : {0.02, 0.01, 0.0}) {
    ASSERT_TRUE(
        slowed.filter.push(Space::template displace<Scalar>(x, static_cast<Scalar>(-1.6 * before) * v), 1.0 - before));
  }
  for (int k = 0; k < 100; ++k) ASSERT_NO_FATAL_FAILURE(slowed.advance()) << k;
  EXPECT_EQ(slowed.filter.reference().xd(0), Scalar(0.25));
}

/// A change of the speed that is undone before the next tick changes no bit, and invalid fractions have no effect.
TYPED_TEST(TargetSpeeds, reject_invalid_fractions) {
  using Space = typename TypeParam::S;
  using Scalar = typename TypeParam::T;
  using Filter = TargetFilter<Space, Scalar>;
  static_assert(noexcept(std::declval<Filter&>().set_speed(Scalar(1))));
  Random random(64);
  const auto x0 = random_point<Space, Scalar>(random, 1.0);
  Filter one(x0, bounds<Scalar>());
  Filter other(x0, bounds<Scalar>());
  for (int k = 0; k < 2000; ++k) {
    if (k % 500 == 0) {
      const auto x = random_point<Space, Scalar>(random, 1.0);
      ASSERT_TRUE(one.push(x) && other.push(x));
      ASSERT_TRUE(other.set_speed(Scalar(0.2)) && other.set_speed(Scalar(1)));
    }
    constexpr Scalar kInfinity = std::numeric_limits<Scalar>::infinity();
    for (const Scalar wrong : {Scalar(0), Scalar(-0.5), Scalar(1.001), kInfinity, -kInfinity, kInfinity - kInfinity}) {
      ASSERT_FALSE(other.set_speed(wrong));
    }
    ASSERT_EQ(other.speed(), Scalar(1));
    one.advance();
    other.advance();
    ASSERT_EQ(one.reference().xd, other.reference().xd);
    ASSERT_EQ(one.reference().xdd, other.reference().xdd);
  }
  ASSERT_TRUE(one.set_speed(Scalar(0.25)) && one.reset(x0));
  EXPECT_EQ(one.speed(), Scalar(0.25));
}

}  // namespace
}  // namespace fpbm::test::target_speed_laws
