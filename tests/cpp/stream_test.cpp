#include "fpbm/target/stream.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "fpbm/model/presets.hpp"
#include "fpbm/model/serial_arm.hpp"
#include "fpbm/realtime/stack_tracker.hpp"
#include "fpbm/scheme/schemes.hpp"
#include "fpbm/task/posture_task.hpp"
#include "support/expect_refused.hpp"
#include "support/random.hpp"
#include "support/watched_filter.hpp"

/// Chunks of points, and points one by one, that a Stream joins within its bounds.
namespace fpbm::test::stream_laws {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kTick = 1e-3;
constexpr double kPi = 3.14159265358979;
constexpr TargetBounds<> kBounds{0.5, 3.0, 100.0, 1.5, 8.0, 300.0};

/// Bounds of six axes as TargetBounds or as limits of six joints.
template <typename Space, typename Scalar>
typename AxesOf<Space, Scalar>::Bounds random_limits(Random& random) {
  const auto bounds = random_bounds<Space, Scalar>(random);
  if constexpr (kIsJointSpace<Space>) {
    auto limits = JointLimits<Space::kRows, Scalar>::none(Space::kRows);
    for (int i = 0; i < Space::kRows; ++i) {
      if (i != 1) limits.lower(i) = static_cast<Scalar>(-random.uniform(1.0, 1.5));
      if (i != 2) limits.upper(i) = static_cast<Scalar>(random.uniform(1.0, 1.5));
      limits.velocity(i) = bounds.velocity * static_cast<Scalar>(random.uniform(0.5, 1.0));
      limits.acceleration(i) = bounds.acceleration * static_cast<Scalar>(random.uniform(0.5, 1.0));
      if (i != 3) limits.jerk(i) = bounds.jerk;
      if (i > 3) {
        limits.velocity_offset(i) = static_cast<Scalar>(random.uniform(0.0, 0.3));
        limits.deceleration(i) = static_cast<Scalar>(random.uniform(1.0, 10.0));
      }
    }
    return limits;
  } else {
    return bounds;
  }
}

template <typename Space, typename Scalar>
using Chunk = std::vector<TimedPoint<Space, Scalar>>;

/// A chunk of a policy: a random walk, smooth or rough, with gaps between its points of 1 to 100 ms.
template <typename Space, typename Scalar>
Chunk<Space, Scalar> random_chunk(Random& random, const typename Space::template Point<Scalar>& from) {
  Chunk<Space, Scalar> chunk;
  auto x = from;
  const double size = std::pow(10.0, random.uniform(-4.0, -0.5));
  auto time = static_cast<Scalar>(random.uniform(-0.3, 0.3));
  const auto period = static_cast<Scalar>(random.uniform(0.005, 0.1));
  const bool even = random.uniform(0.0, 1.0) < 0.7;
  Vector<Space::kRows, Scalar> step = random.uniform(Space::kRows, -size, size).template cast<Scalar>();
  const auto count = static_cast<int>(random.uniform(1.0, 60.0));
  for (int k = 0; k < count; ++k) {
    chunk.push_back({time, x, {}, {}});
    const auto rates = [&](double most) {
      const double wild = random.uniform(0.0, 1.0) < 0.01 ? std::pow(10.0, random.uniform(0.0, 30.0)) : 1.0;
      return Vector<Space::kRows, Scalar>((wild * random.uniform(Space::kRows, -most, most)).template cast<Scalar>());
    };
    if (random.uniform(0.0, 1.0) < 0.1) chunk.back().xd = rates(1.0);
    if (random.uniform(0.0, 1.0) < 0.1) chunk.back().xdd = rates(5.0);
    time += even ? period : static_cast<Scalar>(random.uniform(0.001, 0.1));
    step += (random.uniform(Space::kRows, -size, size) * 0.3).template cast<Scalar>();
    x = Space::template displace<Scalar>(x, step);
    if constexpr (kIsJointSpace<Space>) x = x.cwiseMax(Scalar(-0.95)).cwiseMin(Scalar(0.95));
  }
  return chunk;
}

using StreamKinds = ::testing::Types<FilterKind<JointSpace<6>, double>, FilterKind<JointSpace<2>, float>,
                                     FilterKind<Position<3>, double>, FilterKind<PlanarPose, double>,
                                     FilterKind<Pose, double>, FilterKind<Pose, float>>;
template <typename Kind>
class Streams : public ::testing::Test {};
TYPED_TEST_SUITE(Streams, StreamKinds, );

/// Chunks and points of all kinds, late, early, overlapping and invalid, do not violate the bounds and the ranges of
/// joints, and the reference then reaches the last point of a chunk and rests there.
TYPED_TEST(Streams, keep_their_bounds_for_any_chunks) {
  using Space = typename TypeParam::S;
  using Scalar = typename TypeParam::T;
  Random random(51);
  for (int trial = 0; trial < trials(40); ++trial) {
    SCOPED_TRACE("trial " + std::to_string(trial));
    const auto x0 = random_point<Space, Scalar>(random, 0.9);
    const auto limits = random_limits<Space, Scalar>(random);
    StreamOptions<Scalar> options;
    const double tick = std::array{1e-3, 1e-3, 4e-3, 2e-2}[static_cast<std::size_t>(trial / 4 % 4)];
    options.dt = static_cast<Scalar>(tick);
    if (trial % 3 == 0) options.start = 100.0;
    if (trial % 2 == 0) options.delay = static_cast<Scalar>(random.uniform(0.0, 0.1));
    if (trial % 4 > 1) options.blend = static_cast<Scalar>(random.uniform(0.0, 0.3));
    WatchedFilter<Space, Scalar, Stream<Space, Scalar, 64>> watched(x0, limits, options);
    auto& stream = watched.filter;
    double stamp = 100.0;
    const auto advance = [&]() {
      watched.advance();
      stamp += tick;
      if constexpr (kIsJointSpace<Space>) {
        constexpr Scalar kRound = 64 * std::numeric_limits<Scalar>::epsilon();
        ASSERT_LE((stream.reference().x - limits.upper).maxCoeff(), kRound);
        ASSERT_LE((limits.lower - stream.reference().x).maxCoeff(), kRound);
        for (int i = 0; i < Space::kRows; ++i) {
          if (!std::isfinite(limits.deceleration(i))) continue;
          const auto [x, xd, xdd] = stream.reference();
          const Scalar distance = xd(i) > Scalar(0) ? limits.upper(i) - x(i) : x(i) - limits.lower(i);
          const Scalar envelope =
              std::sqrt(Scalar(2) * limits.deceleration(i) * std::max(distance, Scalar(0))) - limits.velocity_offset(i);
          ASSERT_LE(std::abs(xd(i)), std::max(envelope, Scalar(0)) + Scalar(1e-6)) << i;
        }
      }
    };
    for (int k = 0; k < 3000; ++k) {
      ASSERT_NO_FATAL_FAILURE(advance()) << k;
      if (random.uniform(0.0, 1.0) > 0.01) continue;
      auto chunk = random_chunk<Space, Scalar>(
          random, random.uniform(0.0, 1.0) < 0.5 ? stream.reference().x : random_point<Space, Scalar>(random, 0.9));
      const auto count = static_cast<int>(chunk.size());
      const double when = stamp + random.uniform(-0.05, 0.05);
      const double what = random.uniform(0.0, 1.0);
      if (random.uniform(0.0, 1.0) < 0.1) {
        ASSERT_TRUE(stream.set_speed(static_cast<Scalar>(random.uniform(0.01, 1.0))));
      }
      if (what < 0.1) {
        chunk[chunk.size() / 2].time = static_cast<Scalar>(kNaN);
        ASSERT_FALSE(stream.push_chunk(chunk.data(), count, when));
      } else if (what < 0.2) {
        if (count > 1) {
          chunk.back().time = chunk.front().time;
          ASSERT_FALSE(stream.push_chunk(chunk.data(), count, when));
        }
        ASSERT_FALSE(stream.push_chunk(chunk.data(), 0, when));
      } else if (what < 0.5) {
        for (int n = 0; n < 10; ++n) {
          (void)stream.push(chunk[static_cast<std::size_t>(n % count)].x, stamp);
          for (int i = 0; i < 20; ++i) ASSERT_NO_FATAL_FAILURE(advance()) << k;
        }
      } else {
        (void)stream.push_chunk(chunk.data(), count, when);
        ASSERT_FALSE(stream.push_chunk(chunk.data(), count, when));
      }
    }
    ASSERT_TRUE(stream.set_speed(Scalar(1)));
    const auto last = random_chunk<Space, Scalar>(random, random_point<Space, Scalar>(random, 0.9));
    ASSERT_TRUE(stream.push_chunk(last.data(), static_cast<int>(last.size())));
    const auto x = orthonormalised(last.back().x);
    ASSERT_LT(watched.reach(x, 200000), 200000);
  }
}

/// From rest and from a motion, the reference does not pass the last point of a chunk of one coordinate.
TEST(Stream, does_not_overshoot) {
  Random random(52);
  for (int trial = 0; trial < trials(300); ++trial) {
    Stream<Position<3>> stream(Vector<3>::Zero(), kBounds);
    for (int chunk = 0; chunk < 3; ++chunk) {
      // Points that move in one direction, and stop without warning.
      std::vector<TimedPoint<Position<3>>> points;
      Vector<3> x = stream.reference().x + 0.05 * random.uniform(3, -1.0, 1.0);
      const Vector<3> step = random.uniform(3, -0.01, 0.01);
      const auto period = random.uniform(0.01, 0.05);
      for (int k = 0; k < 12; ++k) points.push_back({k * period, x += step, {}, {}});
      ASSERT_TRUE(stream.push_chunk(points.data(), 12));
      const auto start = stream.reference();
      const QuickestStop<double> stop{kBounds.acceleration, kBounds.jerk};
      Vector<3> low = points.front().x.cwiseMin(points.back().x);
      Vector<3> high = points.front().x.cwiseMax(points.back().x);
      for (int i = 0; i < 3; ++i) {
        for (int k = 0; k < 2000; ++k) {
          const double q = stop.ahead({start.x(i), start.xd(i), start.xdd(i)}, k * kTick).q;
          low(i) = std::min(low(i), q);
          high(i) = std::max(high(i), q);
        }
      }
      const auto ticks = static_cast<int>((chunk < 2 ? random.uniform(0.0, 12.0) : 100.0) * period / kTick);
      for (int k = 0; k < ticks; ++k) {
        stream.advance();
        ASSERT_GE((stream.reference().x - low).minCoeff(), -1e-9) << k;
        ASSERT_LE((stream.reference().x - high).maxCoeff(), 1e-9) << k;
      }
      if (chunk < 2) continue;
      EXPECT_EQ(stream.reference().x, points.back().x);
    }
  }
}

Vector<7> posture(double seconds) {
  Vector<7> q{0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785};
  for (int i = 0; i < 7; ++i) q(i) += 0.2 * (1.0 - std::cos(kPi * seconds + 0.3 * i)) - 0.2 * (1.0 - std::cos(0.3 * i));
  return q;
}
double acceleration(double seconds, int i) {
  return 0.2 * kPi * kPi * std::cos(kPi * seconds + 0.3 * i);
}

const SerialArm<7>& panda() {
  static const SerialArm<7> arm(presets::panda());
  return arm;
}

/// Largest deviations of a reference from posture() while overlapping chunks arrive, each 100 ms after its first point.
struct Deviation {
  double lag = 0.0;     ///< [rad]
  double ripple = 0.0;  ///< Error of the acceleration, relative to its amplitude.
};
Deviation follow_chunks(double period, double tick, const StreamOptions<>& given, const Vector<7>& jump) {
  StreamOptions<> options = given;
  options.start = 0.0;
  options.dt = tick;
  JointStream<7> stream(posture(0.0), panda().limits(), options);
  Deviation most;
  const auto between = static_cast<int>(15 * period / tick);
  Vector<7> offset = Vector<7>::Zero();
  for (int k = 0; k * tick < 6.0 + 60.0 * period; ++k) {
    if (k % between == 0) {
      Chunk<JointSpace<7>, double> chunk;
      const double stamp = k * tick - 0.1;
      for (int n = 0; n < 40; ++n) chunk.push_back({period * n, posture(stamp + period * n) + offset, {}, {}});
      EXPECT_TRUE(stream.push_chunk(chunk.data(), 40, stamp));
      offset = jump - offset;
    }
    stream.advance();
    const double now = (k + 1) * tick;
    if (now < 1.0) continue;
    most.lag = std::max(most.lag, (stream.reference().x - posture(now)).cwiseAbs().maxCoeff());
    for (int i = 0; i < 7; ++i) {
      const double off = std::abs(stream.reference().xdd(i) - acceleration(now, i));
      most.ripple = std::max(most.ripple, off / (0.2 * kPi * kPi));
    }
  }
  return most;
}

/// Overlapping chunks of a smooth motion: the reference has no lag, and its acceleration is that of the motion, within
/// 1 % for 50 points a second, and within 10 % for 5 points a second.
TEST(Stream, follows_overlapping_chunks) {
  for (const double tick : {1e-3, 4e-3, 0.01}) {
    for (const auto& [period, ripple] : {std::pair{0.02, 0.01}, {0.05, 0.01}, {0.1, 0.03}, {0.2, 0.1}}) {
      const Deviation most = follow_chunks(period, tick, {}, Vector<7>::Zero());
      std::printf("%g Hz: lag %.2g rad, ripple %.2g of the acceleration\n", 1.0 / period, most.lag, most.ripple);
      EXPECT_LE(most.lag, 0.1 * ripple * period);
      EXPECT_LE(most.ripple, ripple);
    }
  }
}

/// Chunks that are alternately 2 mrad apart: with a blend, the target changes smoothly from one to the other. Without,
/// the reference joins each chunk with the largest acceleration.
TEST(Stream, blends_chunks) {
  StreamOptions<> options;
  const Vector<7> jump = Vector<7>::Constant(2e-3);
  const Deviation sudden = follow_chunks(0.02, kTick, options, jump);
  options.blend = 0.2;
  const Deviation blended = follow_chunks(0.02, kTick, options, jump);
  const double scale = 0.2 * kPi * kPi;
  std::printf("acceleration off by %.2g rad/s^2 without a blend, by %.2g rad/s^2 with\n", scale * sudden.ripple,
              scale * blended.ripple);
  EXPECT_LE(blended.lag, 2.01e-3);
  // The largest acceleration of a polynomial of degree 5 that moves by d in a time T is 10/sqrt(3) d/T^2.
  EXPECT_LE(scale * blended.ripple, 1.2 * 10.0 / std::sqrt(3.0) * 2e-3 / (0.2 * 0.2));
  EXPECT_GE(sudden.ripple, 10.0 * blended.ripple);
}

/// A chunk at 10 Hz with turning points between its points: the reference stays on the smooth motion of the chunk.
TEST(Stream, follows_turning_points_between_points) {
  constexpr double kRate = 1.5;
  for (const double phase : {0.0, 0.1, 0.25, 0.444, 0.5}) {
    const auto at = [&](double t) { return Vector<7>::Constant(0.2 * std::cos(kRate * (t + 0.1 * phase))); };
    auto limits = JointLimits<7>::none(7);
    limits.velocity.setConstant(2.0);
    limits.acceleration.setConstant(10.0);
    limits.jerk.setConstant(5000.0);
    StreamOptions<> options;
    options.start = 0.0;
    JointStream<7> stream(at(0.0), limits, options);
    std::vector<TimedPoint<JointSpace<7>>> points;
    for (int k = 0; k < 60; ++k) points.push_back({0.1 * k, at(0.1 * k), {}, {}});
    ASSERT_TRUE(stream.push_chunk(points.data(), 60, 0.0));
    double ripple = 0.0;
    for (int tick = 0; tick < 5500; ++tick) {
      stream.advance();
      const double own = -kRate * kRate * at((tick + 1) * kTick)(0);
      if (tick > 500) ripple = std::max(ripple, std::abs(stream.reference().xdd(0) - own));
    }
    EXPECT_LE(ripple, 0.02 * 0.2 * kRate * kRate) << phase;
  }
}

/// Points one by one, 50 a second and up to 15 ms late: the reference passes the points after the delay. Without a
/// delay, the reference follows a prediction.
TEST(Stream, passes_points_after_the_delay) {
  for (const auto& [delay, error, deviation] : {std::tuple{0.04, 1e-5, 0.02}, {0.0, 1e-3, 0.6}}) {
    Random random(53);
    StreamOptions<> options;
    options.start = 0.0;
    options.delay = delay;
    JointStream<7> stream(posture(0.0), panda().limits(), options);
    double lag = 0.0;
    double ripple = 0.0;
    int next = 0;
    int arrival = 0;
    for (int tick = 0; tick < 6000; ++tick) {
      if (tick == arrival) {
        ASSERT_TRUE(stream.push(posture(0.02 * next), 0.02 * next));
        ++next;
        arrival = std::max(tick + 1, 20 * next + static_cast<int>(random.uniform(0.0, 15.0)));
      }
      stream.advance();
      if (tick < 1000) continue;
      const double now = (tick + 1) * kTick - options.delay;
      lag = std::max(lag, (stream.reference().x - posture(now)).cwiseAbs().maxCoeff());
      for (int i = 0; i < 7; ++i) ripple = std::max(ripple, std::abs(stream.reference().xdd(i) - acceleration(now, i)));
    }
    std::printf("delay %g s: lag beyond the delay %.2g rad, ripple %.2g of the acceleration\n", delay, lag,
                ripple / (0.2 * kPi * kPi));
    EXPECT_LE(lag, error);
    EXPECT_LE(ripple, deviation * 0.2 * kPi * kPi);
  }
}

/// After a jump of the target, each joint needs the minimum time, at most one tick longer.
TEST(Stream, rejoins_in_minimum_time) {
  const auto& limits = panda().limits();
  for (const double jump : {0.02, 0.07, 0.5}) {
    for (const double speed : {0.0, 0.3}) {
      StreamOptions<> options;
      options.start = 0.0;
      JointStream<7> stream(posture(0.0), limits, options);
      std::vector<TimedPoint<JointSpace<7>>> points;
      for (int k = 0; k < 100; ++k) {
        Vector<7> q = posture(0.0);
        q(0) += jump + speed * 0.02 * k;
        points.push_back({0.02 * k, q, {}, {}});
      }
      ASSERT_TRUE(stream.push_chunk(points.data(), 100, 0.0));
      const TimeOptimalAxis<double> axis{limits.velocity(0), {limits.acceleration(0), limits.jerk(0)}};
      AxisState<double> alone{0.0, -speed, 0.0};
      int least = 0;
      for (; alone.q != jump || alone.v != 0.0; ++least) {
        alone = axis.approach(alone, jump, speed, kTick, 1e-12);
        ASSERT_LT(least, 5000);
      }
      int ticks = 0;
      for (; std::abs(stream.gap()(0)) > 1e-12; ++ticks) {
        stream.advance();
        ASSERT_LT(ticks, 5000);
      }
      EXPECT_LE(ticks, least + 1) << jump << ' ' << speed;
    }
  }
}

/// A tracker with a task for its posture follows a stream whose bounds on accelerations and jerks are 5 % smaller.
TEST(Stream, is_followed_by_a_tracker) {
  const Robot<7> robot(presets::panda());
  const TaskGains<> gains(40.0, 400.0);
  const Stack stack(PostureTask<7>{gains});
  StreamOptions<> options;
  options.start = 0.0;
  auto tracker = stack_tracker(robot, stack, FPBM<7>(0.6, UnitWeights{}, 0.0, 0.0), posture(0.0));
  auto limits = panda().limits();
  limits.acceleration *= 0.95;
  limits.jerk *= 0.95;
  JointStream<7> stream(posture(0.0), limits, options);
  double error = 0.0;
  for (int tick = 0; tick < 3000; ++tick) {
    if (tick % 400 == 0) {
      Chunk<JointSpace<7>, double> chunk;
      for (int k = 0; k < 40; ++k) chunk.push_back({0.02 * k, posture(tick * kTick + 0.02 * k), {}, {}});
      if (tick == 1600) chunk.front().x(0) += 0.05;
      ASSERT_TRUE(stream.push_chunk(chunk.data(), 40, tick * kTick));
    }
    const auto result = tracker.tick(stream);
    ASSERT_LE(result.status, Status::kSlowed);
    error = std::max(error, (result.q - stream.reference().x).cwiseAbs().maxCoeff());
  }
  std::printf("error of the tracker %.2g rad\n", error);
  EXPECT_LE(error, 5e-5);
}

/// Without new points, points one by one continue until the timeout, and then stop. reset() and set_speed().
TEST(Stream, stops_after_the_timeout) {
  Stream<Position<2>> stream(Vector<2>::Zero(), kBounds);
  for (int k = 0; k < 20; ++k) {
    ASSERT_TRUE(stream.push({0.01 * k, 0.0}));
    for (int i = 0; i < 30; ++i) stream.advance();
  }
  EXPECT_GT(stream.reference().xd(0), 0.3);
  EXPECT_NEAR(stream.age(), 0.03, 1e-5);  // The estimated clock is slow by 1e-4.
  for (int i = 0; i < 600; ++i) stream.advance();
  EXPECT_EQ(stream.reference().xd(0), 0.0);
  EXPECT_EQ(stream.gap()(0), 0.0);
  EXPECT_TRUE(stream.set_speed(0.5));
  EXPECT_FALSE(stream.set_speed(kNaN));
  ASSERT_TRUE(stream.push({2.0, 0.0}));
  for (int i = 0; i < 800; ++i) stream.advance();
  EXPECT_LE(stream.reference().xd(0), 0.25);
  EXPECT_TRUE(stream.reset({1.0, 1.0}));
  EXPECT_EQ(stream.reference().x(0), 1.0);
  EXPECT_TRUE(stream.reference().xd.isZero(0));
}

TEST(Stream, rejects_postures_far_outside_the_ranges) {
  JointStream<7> stream(posture(0.0), panda().limits());
  Vector<7> q = posture(0.0);
  q(3) = 0.1;  // Beyond −0.0698, by less than a tenth of the range.
  EXPECT_TRUE(stream.push(q));
  for (int k = 0; k < 3000; ++k) stream.advance();
  EXPECT_EQ(stream.reference().x(3), panda().limits().upper(3));
  q(3) = -45.0;  // Degrees.
  EXPECT_FALSE(stream.push(q));
  TimedPoint<JointSpace<7>> point{0.0, q, {}, {}};
  EXPECT_FALSE(stream.push_chunk(&point, 1));
}

TEST(Stream, refuses_bad_arguments) {
  auto limits = panda().limits();
  limits.acceleration(2) = std::numeric_limits<double>::infinity();
  expect_refused([&] { JointStream<7>(posture(0.0), limits); },
                 "limits.acceleration[2] = inf: must be positive and finite");
  expect_refused([&] { JointStream<7>(Vector<7>::Constant(4.0), panda().limits()); },
                 "x0[0] = 4: must be from -2.8973 to 2.8973");
  StreamOptions<> options;
  options.delay = -1.0;
  expect_refused([&] { JointStream<7>(posture(0.0), panda().limits(), options); }, "delay = -1: must be");
  options.delay = 0.0;
  options.blend = kNaN;
  expect_refused([&] { JointStream<7>(posture(0.0), panda().limits(), options); }, "blend = nan: must be");
}

}  // namespace
}  // namespace fpbm::test::stream_laws
