#include "fpbm/target/target_filter.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "fpbm/model/planar_arm.hpp"
#include "fpbm/scheme/schemes.hpp"
#include "support/compiled_tracker.hpp"
#include "support/random.hpp"
#include "support/watched_filter.hpp"

/// The reference of a filter keeps every bound for all messages, and arrives at the target.
namespace fpbm::test::target_filter_laws {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr TargetBounds<> kBounds{0.5, 3.0, 100.0, 1.5, 8.0, 300.0};

template <typename Kind>
class TargetFilters : public ::testing::Test {};
TYPED_TEST_SUITE(TargetFilters, FilterKinds, );

/// From rest and from any motion, under any bounds, for all previous targets.
TYPED_TEST(TargetFilters, stop_on_the_last_target) {
  using Space = typename TypeParam::S;
  using Scalar = typename TypeParam::T;
  Random random(41);
  for (int i = 0; i < trials(60); ++i) {
    SCOPED_TRACE("trial " + std::to_string(i));
    const auto bounds = random_bounds<Space, Scalar>(random);
    WatchedFilter<Space, Scalar> watched(random_point<Space, Scalar>(random, 1.0), bounds);
    auto x = random_point<Space, Scalar>(random, 1.0);
    for (int target = 0; target < 5; ++target) {
      x = random_point<Space, Scalar>(random, std::pow(10.0, random.uniform(-5.0, 0.0)));
      ASSERT_TRUE(watched.filter.push(x));
      const int ticks = target < 4 ? static_cast<int>(random.uniform(201.0, 800.0)) : 0;
      for (int k = 0; k < ticks; ++k) ASSERT_NO_FATAL_FAILURE(watched.advance());
    }
    ASSERT_LT(watched.reach(x, 100000), 100000);
    for (int k = 0; k < 100; ++k) {
      watched.advance();
      ASSERT_TRUE(watched.at(x));
      ASSERT_TRUE(watched.filter.reference().xd.isZero(0));
    }
  }
}

/// Invalid messages of all types do not violate the bounds, and the next valid target is reached.
TYPED_TEST(TargetFilters, keep_their_bounds_for_any_targets) {
  using Space = typename TypeParam::S;
  using Scalar = typename TypeParam::T;
  Random random(42);
  for (int i = 0; i < trials(30); ++i) {
    SCOPED_TRACE("trial " + std::to_string(i));
    TargetFilterOptions<Scalar> options;
    if (i % 3 == 0) options.start = 100.0;
    WatchedFilter<Space, Scalar> watched(random_point<Space, Scalar>(random, 1.0), random_bounds<Space, Scalar>(random),
                                         options);
    double stamp = 100.0;
    for (int k = 0; k < 3000; ++k) {
      stamp += 1e-3;
      if (random.uniform(0.0, 1.0) < 0.05) {
        auto x = random_point<Space, Scalar>(random, random.uniform(0.0, 1.0) < 0.1 ? 1e6 : 1.0);
        double when = stamp + random.uniform(-0.1, 0.1);
        const double what = random.uniform(0.0, 1.0);
        if (what < 0.1) when = what < 0.05 ? kNaN : stamp - 1e6;
        if (what > 0.9) {
          if constexpr (std::is_same_v<Space, Pose>) {
            what > 0.95 ? x.R.setZero() : x.R.setConstant(Scalar(kNaN));
          } else {
            x.setConstant(static_cast<Scalar>(what > 0.95 ? kNaN : std::numeric_limits<double>::infinity()));
          }
          ASSERT_FALSE(watched.filter.push(x, when));
        } else if (what > 0.8) {
          (void)watched.filter.push(x);
        } else if (what > 0.7) {
          (void)watched.filter.push_twist(random.uniform(Space::kRows, -5.0, 5.0).template cast<Scalar>(), when);
        } else {
          (void)watched.filter.push(x, when);
          ASSERT_FALSE(watched.filter.push(x, when));
        }
      }
      ASSERT_NO_FATAL_FAILURE(watched.advance()) << k;
    }
    for (int k = 0; k < 500; ++k) watched.advance();
    const auto x = random_point<Space, Scalar>(random, 1.0);
    ASSERT_TRUE(watched.filter.push(x));
    ASSERT_LT(watched.reach(x, 200000), 200000);
  }
}

/// A target with constant velocity, seen at 30 Hz with a delay of at most 20 ms. One message in ten is lost.
TYPED_TEST(TargetFilters, do_not_lag_behind_a_stream) {
  using Space = typename TypeParam::S;
  using Scalar = typename TypeParam::T;
  using Twist = Vector<Space::kRows, Scalar>;
  Random random(43);
  for (int i = 0; i < trials(20); ++i) {
    SCOPED_TRACE("trial " + std::to_string(i));
    TargetFilterOptions<Scalar> options;
    // The clock of the camera is estimated. The first stamp is not delayed, so that the time of every message is known.
    const double epoch = i % 2 == 0 ? 5000.0 : 0.0;
    if (i % 2 != 0) options.start = 0.0;
    const auto x0 = random_point<Space, Scalar>(random, 1.0);
    WatchedFilter<Space, Scalar> watched(x0, {Scalar(0.5), Scalar(3), Scalar(100), Scalar(1.5), Scalar(8), Scalar(300)},
                                         options);
    Twist v = random.uniform(Space::kRows, -0.4, 0.4).template cast<Scalar>();
    const auto target = [&](double t) { return Space::template displace<Scalar>(x0, static_cast<Scalar>(t) * v); };
    const auto lag = [&](double t) {
      return Space::template difference<Scalar>(target(t), watched.filter.reference().x).cwiseAbs().maxCoeff();
    };
    std::vector<std::pair<double, double>> seen;  // Arrival time and stamp.
    for (int k = 0; k < 120; ++k) {
      if (k == 0 || random.uniform(0.0, 1.0) >= 0.1)
        seen.emplace_back(k / 30.0 + (k == 0 ? 0.0 : random.uniform(0.0, 0.02)), k / 30.0);
    }
    std::size_t next = 0;
    int ticks = 0;
    for (; next < seen.size(); ++ticks) {
      for (; next < seen.size() && seen[next].first <= ticks * 1e-3; ++next) {
        ASSERT_TRUE(watched.filter.push(target(seen[next].second), epoch + seen[next].second));
      }
      const Scalar most = ticks > 2000 ? v.cwiseAbs().maxCoeff() * Scalar(1e-3) : Scalar(10);
      ASSERT_LE(lag(ticks * 1e-3), most) << ticks;
      ASSERT_NO_FATAL_FAILURE(watched.advance());
    }
    // The filter is at rest within its stopping time after the timeout, and never reverses.
    const double last = seen.back().second + 0.2;
    const Scalar slowest = Scalar(0.4) / 3 + Scalar(3) / 100;  // v/A + A/J
    const Twist onward = watched.filter.reference().xd;
    for (; ticks * 1e-3 < last + slowest + 2e-3; ++ticks) {
      watched.advance();
      for (int axis = 0; axis < Space::kRows; ++axis) {
        ASSERT_GE(watched.filter.reference().xd(axis) * onward(axis), -Scalar(1e-6) * onward(axis) * onward(axis));
      }
    }
    ASSERT_TRUE(watched.filter.reference().xd.template head<Space::kRows - Space::kTurns>().isZero(0));
    const auto there = watched.filter.reference().x;
    for (int k = 0; k < 1000; ++k) watched.advance();
    ASSERT_TRUE(watched.filter.reference().xd.isZero(0));
    ASSERT_LE((Space::template difference<Scalar>(watched.filter.reference().x, there).norm()), Scalar(1e-3));
  }
}

/// A joystick: the velocity is reached as fast as the bounds admit, and reduced to zero after the timeout.
TYPED_TEST(TargetFilters, move_at_a_velocity_until_the_timeout) {
  using Space = typename TypeParam::S;
  using Scalar = typename TypeParam::T;
  using Twist = Vector<Space::kRows, Scalar>;
  Random random(44);
  const auto x0 = random_point<Space, Scalar>(random, 1.0);
  WatchedFilter<Space, Scalar> watched(x0, {Scalar(0.5), Scalar(3), Scalar(100), Scalar(1.5), Scalar(8), Scalar(300)});
  Twist v = Twist::Constant(Scalar(0.3));
  v(0) = Scalar(-9);
  for (int k = 0; k < 1000; ++k) {
    ASSERT_TRUE(watched.filter.push_twist(v));
    ASSERT_NO_FATAL_FAILURE(watched.advance());
  }
  v(0) = Scalar(-0.5);
  EXPECT_EQ(watched.filter.reference().xd, v);
  EXPECT_TRUE(watched.filter.reference().xdd.isZero(0));
  ASSERT_FALSE(watched.filter.push_twist(Twist::Constant(Scalar(kNaN))));
  for (int k = 0; k < 195; ++k) watched.advance();
  EXPECT_EQ(watched.filter.reference().xd, v);
  for (int k = 0; k < 210; ++k) ASSERT_NO_FATAL_FAILURE(watched.advance());
  EXPECT_TRUE(watched.filter.reference().xd.isZero(0));
  const auto there = watched.filter.reference().x;
  for (int k = 0; k < 1000; ++k) watched.advance();
  EXPECT_TRUE(watched.at(there));
  ASSERT_TRUE(watched.filter.push(x0));
  EXPECT_LT(watched.reach(x0, 10000), 10000);
}

/// Displacements per tick below the last bit of the point accumulate, up to errors of one last bit in each tick of
/// either sign: √ticks last bits.
TYPED_TEST(TargetFilters, move_slower_than_a_bit_per_tick) {
  using Space = typename TypeParam::S;
  using Scalar = typename TypeParam::T;
  Random random(47);
  for (const double size : {1.0, 1.0, 1.0, 1.0, 7.0, 50.0}) {
    const auto x0 = random_point<Space, Scalar>(random, size);
    TargetFilter<Space, Scalar> filter(x0, {Scalar(0.5), Scalar(3), Scalar(100), Scalar(1.5), Scalar(8), Scalar(300)});
    const Scalar slow = std::numeric_limits<Scalar>::epsilon() * static_cast<Scalar>(100 * size);
    const auto v = (slow * random.uniform(Space::kRows, -1.0, 1.0).template cast<Scalar>()).eval();
    for (int k = 0; k < 20000; ++k) {
      ASSERT_TRUE(filter.push_twist(v));
      filter.advance();
    }
    const auto displacement = Space::template difference<Scalar>(filter.reference().x, x0);
    EXPECT_LE((displacement - 20 * v).cwiseAbs().maxCoeff(), slow / 100 * std::sqrt(Scalar(20000))) << size;
  }
}

/// In float, round-off errors do not accumulate to a matrix that is not a rotation.
TEST(TargetFilter, turns_for_minutes) {
  TargetFilter<Pose, float> filter({}, {0.5F, 3.0F, 100.0F, 1.5F, 8.0F, 300.0F});
  for (int k = 0; k < trials(300000); ++k) {
    ASSERT_TRUE(filter.push_twist(Vector<6, float>(0.0F, 0.0F, 0.0F, 0.3F, -0.5F, 0.9F)));
    filter.advance();
  }
  const Matrix<3, 3, float> R = filter.reference().x.R;
  EXPECT_LE((R.transpose() * R - Matrix<3, 3, float>::Identity()).cwiseAbs().maxCoeff(), 1e-6F);
}

/// Within a tick, the reference is the motion from which the next tick continues.
TYPED_TEST(TargetFilters, have_references_within_the_tick) {
  using Space = typename TypeParam::S;
  using Scalar = typename TypeParam::T;
  Random random(45);
  const auto bounds = random_bounds<Space, Scalar>(random);
  TargetFilterOptions<Scalar> options;
  options.dt = Scalar(1e-2);
  options.timeout = Scalar(1);
  TargetFilter<Space, Scalar> filter(random_point<Space, Scalar>(random, 1.0), bounds, options);
  const Scalar jerk = std::max(bounds.jerk, bounds.angular_jerk);
  for (int k = 0; k < 500; ++k) {
    if (k % 40 == 0) filter.push(random_point<Space, Scalar>(random, 0.1));
    const auto start = filter.reference();
    const auto middle = filter.ahead(options.dt / 2);
    const auto end = filter.ahead(options.dt);
    EXPECT_EQ(filter.ahead(Scalar(0)).xd, start.xd);
    filter.advance();
    EXPECT_EQ(filter.reference().xdd, end.xdd);
    // Simpson's rule: the change of the jerk within the tick is its only error.
    const auto displacement = Space::template difference<Scalar>(end.x, start.x);
    const auto simpson = (options.dt / 6 * (start.xd + 4 * middle.xd + end.xd)).eval();
    const Scalar slack =
        jerk * options.dt * options.dt * options.dt / 100 + 1000 * std::numeric_limits<Scalar>::epsilon();
    EXPECT_LE((displacement - simpson).cwiseAbs().maxCoeff(), slack) << k;
  }
}

TYPED_TEST(TargetFilters, give_the_same_bits_for_the_same_targets) {
  using Space = typename TypeParam::S;
  using Scalar = typename TypeParam::T;
  const auto run = [] {
    Random random(46);
    TargetFilter<Space, Scalar> filter(random_point<Space, Scalar>(random, 1.0), random_bounds<Space, Scalar>(random));
    for (int k = 0; k < 1000; ++k) {
      if (k % 33 == 0) filter.push(random_point<Space, Scalar>(random, 0.1), 1e-3 * k);
      filter.advance();
    }
    return filter.reference();
  };
  const auto one = run();
  const auto other = run();
  EXPECT_EQ(one.xd, other.xd);
  EXPECT_EQ(one.xdd, other.xdd);
  Scalar bits[2][Space::kSize];
  Space::store(one.x, bits[0]);
  Space::store(other.x, bits[1]);
  EXPECT_TRUE(std::equal(bits[0], bits[0] + Space::kSize, bits[1]));
}

TYPED_TEST(TargetFilters, are_noexcept) {
  using Filter = TargetFilter<typename TypeParam::S, typename TypeParam::T>;
  using Point = typename Filter::Point;
  using Twist = typename Filter::Twist;
  static_assert(noexcept(std::declval<Filter&>().push(std::declval<Point>(), 0.0)));
  static_assert(noexcept(std::declval<Filter&>().push(std::declval<Point>())));
  static_assert(noexcept(std::declval<Filter&>().push_twist(std::declval<Twist>(), 0.0)));
  static_assert(noexcept(std::declval<Filter&>().push_twist(std::declval<Twist>())));
  static_assert(noexcept(std::declval<Filter&>().ahead(typename TypeParam::T(0))));
  static_assert(noexcept(std::declval<Filter&>().advance()));
  static_assert(noexcept(std::declval<Filter&>().reset(std::declval<Point>())));
}

/// From rest to a target at rest: no overshoot, and third differences of the position are within the bound on jerk.
TEST(TargetFilter, does_not_overshoot) {
  Random random(47);
  for (int i = 0; i < trials(300); ++i) {
    const auto bounds = random_bounds<Position<2>, double>(random);
    WatchedFilter<Position<2>, double> watched({0.0, 0.0}, bounds);
    const double x = std::pow(10.0, random.uniform(-8.0, 0.0));
    watched.filter.push({x, -x});
    std::vector<double> path{0.0, 0.0, 0.0};
    while (path.size() < 100000 && !watched.at({x, -x})) {
      ASSERT_NO_FATAL_FAILURE(watched.advance());
      path.push_back(watched.filter.reference().x(0));
      ASSERT_LE(path.back(), x * (1 + 1e-15));
    }
    for (std::size_t k = 3; k < path.size(); ++k) {
      const double third = path[k] - 3 * path[k - 1] + 3 * path[k - 2] - path[k - 3];
      ASSERT_LE(std::abs(third), bounds.jerk * 1e-9 * (1 + 1e-5) + 1e-15 * x) << i << ", tick " << k;
    }
  }
}

/// Half a turn and more: each rotation is in the shorter direction.
TEST(TargetFilter, turns_in_the_shorter_direction) {
  WatchedFilter<PlanarPose, double> planar({0.0, 0.0, 3.0}, kBounds);
  planar.filter.push({0.0, 0.0, -3.0});
  for (int k = 0; k < 1000; ++k) {
    ASSERT_NO_FATAL_FAILURE(planar.advance());
    ASSERT_GE(planar.filter.reference().xd(2), 0.0);
  }
  EXPECT_NEAR(planar.filter.reference().x(2), kTwoPi - 3.0, 1e-15);

  WatchedFilter<Pose, double> spatial({}, kBounds);
  const Transform<> turned{Vector<3>::Zero(), rotation(Vector<3>(0.0, kTwoPi / 2, 0.0))};
  spatial.filter.push(turned);
  EXPECT_LT(spatial.reach(turned, 3000), 3000);
}

/// A jump of the target does not count as a velocity. Three points of a motion with constant velocity are sufficient.
TEST(TargetFilter, does_not_treat_a_jump_as_a_velocity) {
  StreamedTarget<Position<2>, double> target({0.0, 0.0}, 5e-4, 0.2, {1.0, 1.0});
  const auto push = [&](double x, double elapsed) {
    target.push({x, 0.0}, elapsed);
    return target.velocity()(0);
  };
  EXPECT_EQ(push(0.0, 9.0), 0.0);
  EXPECT_EQ(push(0.0, 0.03), 0.0);
  EXPECT_EQ(push(0.5, 0.03), 0.0);               // A jump.
  EXPECT_EQ(push(0.5, 0.03), 0.0);               // At rest again.
  EXPECT_EQ(push(0.503, 0.03), 0.0);             // The target starts to move,
  EXPECT_NEAR(push(0.505, 0.02), 0.1, 1e-12);    // with constant velocity.
  EXPECT_NEAR(push(0.506, 0.0001), 0.1, 1e-12);  // Too soon for a difference quotient.
  EXPECT_NEAR(push(0.508, 0.0299), 0.1, 1e-12);
  EXPECT_EQ(push(0.505, 0.03), 0.0);  // The target reverses,
  EXPECT_NEAR(push(0.415, 0.03), -0.1, 1e-12);
  EXPECT_NEAR(push(-0.415, 0.03), -1.0, 1e-12);  // and is too fast.
  EXPECT_EQ(push(-0.8, 0.3), 0.0);               // A message after a long pause.
}

/// A learnt clock treats the least delayed stamp as not delayed, and follows a clock that drifts. The error of the
/// clock is at most 0.2 ms.
TEST(StampClock, estimates_the_offset_from_the_least_delayed_stamp) {
  Random random(48);
  for (const double drift : {-5e-5, 0.0, 5e-5}) {
    StampClock<double> clock(1e-3, 0.2, {});
    const auto now = [&](int tick) { return 1e6 + tick * 1e-3 * (1.0 + drift); };
    double newest = 0.0;
    double worst = 0.0;
    for (int k = 0; k < 600000; ++k) {
      if (k % 33 == 0) {
        const double stamp = now(k) - (k % 330 == 0 ? 0.0 : random.uniform(0.0, 0.02));
        if (clock.accept(stamp)) newest = stamp;
      }
      if (k > 1000) worst = std::max(worst, std::abs(newest + clock.age() - now(k)));
      clock.advance();
    }
    EXPECT_LE(worst, 2e-4) << drift;
  }
}

TEST(StampClock, accepts_only_newer_stamps) {
  StampClock<double> clock(1e-3, 0.2, {});
  EXPECT_TRUE(clock.accept(50.0));
  EXPECT_FALSE(clock.accept(50.0));
  EXPECT_FALSE(clock.accept(49.9));
  EXPECT_FALSE(clock.accept(kNaN));
  EXPECT_FALSE(clock.accept(std::numeric_limits<double>::infinity()));
  for (int k = 0; k < 100; ++k) clock.advance();
  EXPECT_NEAR(clock.age(), 0.1, 1.1e-5);
  EXPECT_NEAR(clock.accept(50.06).value(), 0.06, 1e-12);  // 40 ms late.
  EXPECT_NEAR(clock.age(), 0.04, 1.1e-5);
  clock.reset();
  EXPECT_TRUE(clock.accept(0.0));

  StampClock<double> known(1e-3, 0.2, 7.0);
  EXPECT_TRUE(known.accept(6.9));
  EXPECT_NEAR(known.age(), 0.1, 1e-12);
  EXPECT_FALSE(known.accept(7.3));  // From the future.
  EXPECT_TRUE(known.accept(7.1));
  EXPECT_NEAR(known.age(), -0.1, 1e-12);
}

TEST(TargetFilter, rejects_invalid_numbers_by_name) {
  const auto refusal = [](const TargetBounds<>& bounds, const TargetFilterOptions<>& options,
                          double x0) -> std::string {
    try {
      TargetFilter<PlanarPose>({x0, 0.0, 0.0}, bounds, options);
    } catch (const std::invalid_argument& refused) {
      return refused.what();
    }
    return "accepted";
  };
  EXPECT_EQ(refusal(kBounds, {}, 0.0), "accepted");
  EXPECT_EQ(refusal(kBounds, {}, kNaN), "x0: must be finite, with a rotation R");
  EXPECT_EQ(refusal({0.5, 3.0, 0.0}, {}, 0.0), "jerk = 0: must be positive and finite");
  EXPECT_EQ(refusal({0.5, 3.0, 1.0}, {}, 0.0), "angular_velocity = 0: must be positive and finite");
  EXPECT_EQ(refusal({-0.5, 3.0, 1.0}, {}, 0.0), "velocity = -0.5: must be positive and finite");
  EXPECT_EQ(refusal(kBounds, {0.0, 0.2, {}}, 0.0), "dt = 0: must be positive and finite");
  EXPECT_EQ(refusal(kBounds, {1e-3, kNaN, {}}, 0.0), "timeout = nan: must be positive and finite");
  EXPECT_EQ(refusal(kBounds, {1e-3, 0.2, kNaN}, 0.0), "start = nan: must be finite");
  EXPECT_NO_THROW(TargetFilter<Position<2>>({0.0, 0.0}, TargetBounds<>{0.5, 3.0, 1.0}));
}

/// An arm follows the reference of the filter after a jump of the target.
TEST(TargetFilter, is_followed_by_a_tracker) {
  const PlanarArm<4> arm({1, 1, 1, 1});
  const auto scheme = FPBM<4>(0.6, Vector<4>(Vector<4>::Ones()), 10.0, 25.0, NullSpace<4>{}.with_damping(2.0));
  CompiledTracker tracker(arm, Position<2>{}, scheme, Vector<4>(0.26, 0.26, 0.21, 0.21));
  const Vector<2> start = tracker.tip();
  TargetFilter<Position<2>> filter(start, kBounds);
  const Vector<2> target = start - Vector<2>(0.3, 0.2);
  filter.push(target);
  double worst = 0.0;
  for (int k = 0; k < 3000; ++k) worst = std::max(worst, tracker.tick(filter).error.norm());
  EXPECT_LE(worst, 1e-7);  // The jerk of the filter jumps.
  EXPECT_LE((tracker.tip() - target).norm(), 1e-9);
  tracker.stop();
  filter.push(start);
  for (int k = 0; k < 3000; ++k) tracker.tick(filter);
  EXPECT_EQ(filter.reference().x, start);  // The filter continues.
}

}  // namespace
}  // namespace fpbm::test::target_filter_laws
