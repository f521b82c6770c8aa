#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "fpbm/target/target_filter.hpp"
#include "support/random.hpp"

/// Time in which a TargetFilter changes the orientation, compared with the largest angle alone.
namespace fpbm::test::target_turn_laws {
namespace {

struct Case {
  const char* name;
  double velocity;
  double acceleration;
  double jerk;
  double dt;
};
constexpr Case kCases[] = {{"documented", 1.5, 8.0, 300.0, 1e-3}, {"fast", 10.0, 20.0, 1000.0, 1e-3},
                           {"low jerk", 1.5, 8.0, 5.0, 1e-3},     {"low jerk and acceleration", 3.0, 3.0, 10.0, 1e-3},
                           {"slow", 0.1, 8.0, 300.0, 4e-3},       {"long ticks", 1.5, 8.0, 300.0, 8e-3}};

template <typename Scalar>
TargetBounds<Scalar> bounds_of(const Case& c) {
  return {Scalar(0.5),
          Scalar(3),
          Scalar(100),
          static_cast<Scalar>(c.velocity),
          Scalar(c.acceleration),
          static_cast<Scalar>(c.jerk)};
}

/// Ticks from rest to rest for one angle alone.
int ticks_alone(double angle, const Case& c) {
  TargetFilter<Position<2>> filter({0.0, 0.0}, {c.velocity, c.acceleration, c.jerk}, {c.dt, 0.2, {}});
  filter.push({angle, 0.0});
  for (int k = 0; k < 200000; ++k) {
    filter.advance();
    if (filter.reference().x(0) == angle && filter.reference().xd(0) == 0.0) return k + 1;
  }
  return 200000;
}

/// From rest, an orientation rotates about a fixed axis, in the time of its largest angle alone, up to π.
template <typename Scalar>
void expect_least_time(const Case& c, int seeds) {
  const auto bounds = bounds_of<Scalar>(c);
  const double ranges[][2] = {{1e-3, 0.1}, {0.1, 1.0}, {1.0, 3.0}, {3.138, 3.14159}, {kTwoPi / 2, kTwoPi / 2}};
  int late = 0;
  double largest = 0.0;
  Random random(51);
  for (const auto& range : ranges) {
    for (int trial = 0; trial < seeds; ++trial) {
      const double angle = random.uniform(range[0], range[1]);
      const Vector<3> axis = random.uniform(3, -1.0, 1.0).normalized();
      Transform<> start;
      start.R = rotation(Vector<3>(random.uniform(3, -3.0, 3.0)));
      const Transform<> end{start.p, Matrix<3, 3>(rotation(Vector<3>(angle * axis)) * start.R)};
      TargetFilter<Pose, Scalar> filter(start.template cast<Scalar>(), bounds,
                                        {static_cast<Scalar>(c.dt), Scalar(0.2), {}});
      const Transform<Scalar> x = orthonormalised(end.template cast<Scalar>());
      ASSERT_TRUE(filter.push(x));
      const auto turn = Pose::difference<Scalar>(x, filter.reference().x);
      const int alone = ticks_alone(static_cast<double>(turn.cwiseAbs().maxCoeff()), c);
      int ticks = 0;
      Vector<6, Scalar> before = Vector<6, Scalar>::Zero();
      constexpr Scalar kEpsilon = std::numeric_limits<Scalar>::epsilon();
      do {
        if (trial % 2 == 1 && ticks % 33 == 32) {  // A stream of the same orientation.
          ASSERT_TRUE(filter.push(end.template cast<Scalar>(), 1e5 + c.dt * ticks));
        }
        filter.advance();
        const auto& now = filter.reference();
        ASSERT_LE(now.xd.cwiseAbs().maxCoeff(), bounds.angular_velocity * (1 + 64 * kEpsilon));
        ASSERT_LE(now.xdd.cwiseAbs().maxCoeff(), bounds.angular_acceleration * (1 + 64 * kEpsilon));
        ASSERT_LE((now.xdd - before).cwiseAbs().maxCoeff(),
                  bounds.angular_jerk * static_cast<Scalar>(c.dt) * (1 + 64 * kEpsilon) +
                      64 * kEpsilon * bounds.angular_acceleration);
        before = now.xdd;
      } while (++ticks < 2 * alone + 100 &&
               !(filter.reference().x.R == x.R && filter.reference().xd.isZero(0) && filter.reference().xdd.isZero(0)));
      largest = std::max(largest, static_cast<double>(ticks) / alone);
      late = std::max(late, ticks - alone);
      // The round-off error of the orientation is corrected at the end, from rest to rest within the bound on jerk.
      const double round_off = 8.0 * static_cast<double>(kEpsilon) * (1.0 + kTwoPi / 2);
      const int correction = static_cast<int>(4.0 * std::cbrt(round_off / (2.0 * c.jerk)) / c.dt);
      EXPECT_LE(ticks, alone + 1 + correction) << c.name << ", " << angle << " about " << axis.transpose();
    }
  }
  std::printf("%s (%zu bytes): at most %.4f of the largest angle's time alone, %d ticks more\n", c.name, sizeof(Scalar),
              largest, late);
}

TEST(TargetTurn, from_rest_takes_the_largest_angles_time) {
  for (const Case& c : kCases) {
    expect_least_time<double>(c, trials(20));
    expect_least_time<float>(c, trials(10));
  }
}

/// Ticks in which one moving angle stops at a target.
int ticks_alone(AxisState<double> state, double target, const Case& c) {
  const TimeOptimalAxis<double> axis{c.velocity, {c.acceleration, c.jerk}};
  for (int k = 0; k < 200000; ++k) {
    state = axis.approach(state, target, 0.0, c.dt, axis.tolerance(state, 1.0, c.dt));
    if (state.q == target && state.v == 0.0 && state.a == 0.0) return k + 1;
  }
  return 200000;
}

/// From a motion, up to 1.5 rad: compared with the slowest of the three angles alone from the same motion.
TEST(TargetTurn, from_a_motion) {
  for (const Case& c : kCases) {
    for (const double most : {0.3, 1.5}) {
      Random random(52);
      double largest = 0.0;
      double mean = 0.0;
      const int count = trials(100);
      for (int trial = 0; trial < count; ++trial) {
        TargetFilter<Pose> filter({}, bounds_of<double>(c), {c.dt, 0.2, {}});
        const auto turned = [&](double angle) {
          const Vector<3> r = angle * random.uniform(3, -1.0, 1.0).normalized();
          Transform<> x = filter.reference().x;
          x.R = orthonormal(Matrix<3, 3>(rotation(r) * x.R));
          return x;
        };
        for (int target = 0; target < 3; ++target) {
          ASSERT_TRUE(filter.push(turned(random.uniform(0.0, most))));
          const int ticks = static_cast<int>(random.uniform(0.21, 0.6) / c.dt);  // Not a stream: exceeds the timeout.
          for (int k = 0; k < ticks; ++k) filter.advance();
        }
        const Transform<> x = turned(random.uniform(0.1 * most, most));
        ASSERT_TRUE(filter.push(x));
        const auto turn = Pose::difference<double>(x, filter.reference().x);
        int alone = 0;
        for (int i = 3; i < 6; ++i) {
          alone = std::max(alone, ticks_alone({0.0, filter.reference().xd(i), filter.reference().xdd(i)}, turn(i), c));
        }
        int ticks = 0;
        do filter.advance();
        while (++ticks < 3 * alone + 1000 &&
               !(filter.reference().x.R == x.R && filter.reference().xd.isZero(0) && filter.reference().xdd.isZero(0)));
        largest = std::max(largest, static_cast<double>(ticks) / alone);
        mean += static_cast<double>(ticks) / alone / count;
      }
      std::printf("%s, up to %.1f rad from a motion: at most %.3f of the slowest angle's time alone, mean %.3f\n",
                  c.name, most, largest, mean);
      EXPECT_LE(largest, c.acceleration / c.jerk > 0.1 ? 1.4 : 1.2) << c.name;
    }
  }
}

}  // namespace
}  // namespace fpbm::test::target_turn_laws
