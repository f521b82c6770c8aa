#include "fpbm/path/path_follower.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "fpbm/path/path.hpp"
#include "support/random.hpp"

/// The clock of a path follower follows the path time, for all sequences of pauses and resumes.
namespace fpbm::test::path_follower_laws {
namespace {

template <typename Scalar>
using Road = Path<Line<2, Scalar>, ConstantSpeed>;

/// A straight line at 1 m/s: x is the path time, xd the rate of the clock, and xdd the derivative of the rate.
template <typename Scalar>
PathFollower<Road<Scalar>> follower(Scalar ramp) {
  constexpr auto kLong = Scalar(256);  // A power of two: no round-off.
  return {Road<Scalar>(Line<2, Scalar>({kLong, Scalar(0)}), kLong), Vector<2, Scalar>::Zero(), ramp};
}

struct Clock {
  double p;
  double r;
  double rd;
};

template <typename Follower>
Clock clock_of(const Follower& follower, double seconds = 0.0) {
  const auto at = follower.ahead(static_cast<typename Follower::Scalar>(seconds));
  return {static_cast<double>(at.x(0)), static_cast<double>(at.xd(0)), static_cast<double>(at.xdd(0))};
}

template <typename Scalar>
class PathFollowers : public ::testing::Test {
 protected:
  static constexpr auto kEpsilon = static_cast<double>(std::numeric_limits<Scalar>::epsilon());
};

using Scalars = ::testing::Types<float, double>;
TYPED_TEST_SUITE(PathFollowers, Scalars, );

/// Random calls, more often within a ramp than after it. The rate stays between 0 and 1, and neither the rate nor its
/// derivative jumps: |ṙ| ≤ 4/3/ramp and |r̈| ≤ 16/3/ramp² for all calls.
TYPED_TEST(PathFollowers, keep_their_rate_within_0_and_1) {
  Random random(11);
  for (const double ramp : {0.01, 0.125, 0.5, 2.0}) {
    const double slope = 4.0 / 3.0 / ramp;
    const double bend = 16.0 / 3.0 / (ramp * ramp);
    const double dt = ramp / 128.0;
    for (int sequence = 0; sequence < trials(100); ++sequence) {
      auto one = follower(static_cast<TypeParam>(ramp));
      Clock before = clock_of(one);
      const double often = random.uniform(0.01, 0.3);
      for (int i = 0; i < 1500; ++i) {
        const std::string where =
            "ramp " + std::to_string(ramp) + ", sequence " + std::to_string(sequence) + ", tick " + std::to_string(i);
        if (random.uniform(0.0, 1.0) < often) {
          const double choice = random.uniform(0.0, 1.0);
          if (choice < 0.4) one.set_speed(static_cast<TypeParam>(random.uniform(0.01, 1.0)));
          choice < 0.7 ? one.resume() : one.pause();
          const Clock after = clock_of(one);
          ASSERT_EQ(after.p, before.p) << where;
          ASSERT_NEAR(after.r, before.r, 4.0 * this->kEpsilon) << where;
          ASSERT_NEAR(after.rd, before.rd, 8.0 * this->kEpsilon * slope) << where;
        }
        const Clock expected = clock_of(one, dt);
        one.advance(static_cast<TypeParam>(dt));
        const Clock now = clock_of(one);
        const double round_off = 4.0 * this->kEpsilon * (1.0 + now.p);
        ASSERT_GE(now.r, 0.0) << where;
        ASSERT_LE(now.r, 1.0) << where;
        ASSERT_LE(std::abs(now.rd), slope * (1.0 + 8.0 * this->kEpsilon)) << where;
        ASSERT_GE(now.p, before.p) << where;
        ASSERT_NEAR(now.p, expected.p, round_off) << where;
        // The change in a tick by the mean value theorem, and the path time by the trapezoidal rule.
        ASSERT_NEAR(now.r, before.r + dt * before.rd, bend * dt * dt / 2.0 + 64.0 * this->kEpsilon) << where;
        ASSERT_NEAR(now.rd, before.rd, (bend * dt) * (1.0 + 1e-4) + 64.0 * this->kEpsilon * slope) << where;
        ASSERT_NEAR(now.p, before.p + dt * (before.r + now.r) / 2.0, bend * dt * dt * dt / 8.0 + round_off) << where;
        before = now;
      }
    }
  }
}

/// Repeated calls have no effect: bitwise the same motion.
TYPED_TEST(PathFollowers, do_nothing_when_called_again) {
  Random random(12);
  for (int sequence = 0; sequence < trials(200); ++sequence) {
    const auto ramp = static_cast<TypeParam>(random.uniform(0.05, 1.0));
    auto once = follower(ramp);
    auto often = follower(ramp);
    bool paused = false;
    for (int i = 0; i < 1000; ++i) {
      if (random.uniform(0.0, 1.0) < 0.01) {
        paused = !paused;
        paused ? once.pause() : once.resume();
        paused ? often.pause() : often.resume();
      }
      if (random.uniform(0.0, 1.0) < 0.2) paused ? often.pause() : often.resume();
      const Clock expected = clock_of(once);
      const Clock at = clock_of(often);
      ASSERT_EQ(at.p, expected.p) << sequence << ", tick " << i;
      ASSERT_EQ(at.r, expected.r) << sequence << ", tick " << i;
      ASSERT_EQ(at.rd, expected.rd) << sequence << ", tick " << i;
      once.advance(TypeParam(2e-3));
      often.advance(TypeParam(2e-3));
    }
  }
}

/// A transition takes one ramp from rest or full speed, and up to 1.25 ramps if it reverses another transition.
TYPED_TEST(PathFollowers, complete_transitions_within_1_25_ramps) {
  const auto arrives = [this](const auto& follower, double within, double rate) {
    const double grace = 1.0 + 64.0 * this->kEpsilon;
    EXPECT_EQ(clock_of(follower, within * grace).r, rate);
    EXPECT_EQ(clock_of(follower, within * grace).rd, 0.0);
  };
  Random random(13);
  for (const double ramp : {0.01, 0.5, 2.0}) {
    for (int sequence = 0; sequence < trials(500); ++sequence) {
      auto one = follower(static_cast<TypeParam>(ramp));
      one.pause();
      arrives(one, ramp, 0.0);
      double target = 0.0;
      for (int call = 0; call < 20; ++call) {
        one.advance(static_cast<TypeParam>(random.uniform(0.0, 1.0) * random.uniform(0.0, 1.0) * ramp));
        target = 1.0 - target;
        target == 1.0 ? one.resume() : one.pause();
        arrives(one, 1.25 * ramp, target);
      }
      one.advance(static_cast<TypeParam>(2.0 * ramp));
      const double there = clock_of(one).p;
      one.advance(TypeParam(1));
      EXPECT_NEAR(clock_of(one).p - there, target, 64.0 * this->kEpsilon);
    }
  }
}

/// The clock runs at the fraction of set_speed() after a ramp; a pause keeps the fraction, and invalid fractions have
/// no effect.
TYPED_TEST(PathFollowers, run_at_a_fraction_of_their_speed) {
  auto one = follower(TypeParam(0.5));
  for (const double fraction : {0.25, 1.0, 0.5, 0.125}) {
    EXPECT_TRUE(one.set_speed(static_cast<TypeParam>(fraction)));
    for (const double wrong : {0.0, -1.0, 1.5, std::nan("")})
      EXPECT_FALSE(one.set_speed(static_cast<TypeParam>(wrong)));
    EXPECT_EQ(static_cast<double>(one.speed()), fraction);
    one.advance(TypeParam(0.5));
    EXPECT_EQ(clock_of(one).r, fraction);
    one.pause();
    one.advance(TypeParam(0.5));
    EXPECT_EQ(clock_of(one).r, 0.0);
    one.set_speed(TypeParam(1));
    one.set_speed(static_cast<TypeParam>(fraction));
    one.advance(TypeParam(0.5));
    EXPECT_EQ(clock_of(one).r, 0.0) << "paused";
    one.resume();
    one.advance(TypeParam(0.5));
    EXPECT_EQ(clock_of(one).r, fraction);
  }
}

/// From full speed to rest and back: during each ramp, the path time advances by half a ramp.
TYPED_TEST(PathFollowers, stop_in_half_a_ramp_of_path_time) {
  for (const double ramp : {0.01, 0.5, 2.0}) {
    auto one = follower(static_cast<TypeParam>(ramp));
    one.advance(TypeParam(1));
    one.pause();
    one.advance(static_cast<TypeParam>(ramp));
    one.advance(TypeParam(3));
    EXPECT_NEAR(clock_of(one).p, 1.0 + ramp / 2.0, 16.0 * this->kEpsilon);
    one.resume();
    one.advance(static_cast<TypeParam>(ramp));
    one.advance(TypeParam(3));
    EXPECT_NEAR(clock_of(one).p, 4.0 + ramp, 64.0 * this->kEpsilon);
  }
}

}  // namespace
}  // namespace fpbm::test::path_follower_laws
