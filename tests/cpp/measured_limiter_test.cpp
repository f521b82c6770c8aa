#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include "fpbm/realtime/detail/measured_limiter.hpp"
#include "support/random.hpp"

/// Limits of one joint whose state is measured with a delay.
namespace fpbm::test::measured_limiter_laws {
namespace {

/// One joint that is driven at random, or always toward a bound, with all delays, ticks and jerks. The age of the
/// measured state may change from tick to tick.
template <typename Scalar>
void expect_bounds_at_any_age(std::uint32_t seed, int delay, Scalar tick) {
  using Joints = Vector<2, Scalar>;
  const Matrix<2, 2, Scalar> J = Matrix<2, 2, Scalar>::Identity();
  Random random(seed);
  const auto any = [&](double low, double high) { return static_cast<Scalar>(random.uniform(low, high)); };
  const auto power = [&](double low, double high) {
    return static_cast<Scalar>(std::pow(10.0, random.uniform(low, high)));
  };
  const Scalar range = power(-1.0, 0.7);
  const Scalar acceleration = any(2.0, 20.0);
  auto bounds = JointLimits<2, Scalar>::none(2);  // The second joint is unbounded, and does not move.
  bounds.set(0, {-range, range, power(-2.0, 0.7), acceleration, JointBounds<Scalar>::kNone});
  if (seed % 4 != 0) bounds.jerk(0) = acceleration / (tick * power(0.3, 2.0));
  if (seed % 3 == 0) {
    bounds.velocity_offset(0) = acceleration * any(0.01, 0.03);
    bounds.deceleration(0) = acceleration * any(0.3, 1.5);
  }
  const Limits<Level::kAcceleration, 2, Scalar> limits(bounds, tick);
  const MeasuredLimiter<2, Scalar> limiter(limits, delay);
  const Scalar step = limits.bounds().jerk(0) * tick;
  const Scalar round_off = Scalar(64) * std::numeric_limits<Scalar>::epsilon();
  const bool jitter = seed % 2 == 0;
  const int age = static_cast<int>(seed / 2) % (delay + 1);
  State<2, Scalar> now{Joints::Zero(), Joints::Zero()};
  now.q(0) = any(-0.45, 0.45) * range;
  std::vector<State<2, Scalar>> past(static_cast<std::size_t>(delay + 1), now);
  Joints u = Joints::Zero();
  Joints desired = u;
  const int ticks = 3000;
  const int stop = seed % 5 == 0 ? ticks / 2 : ticks;
  for (int i = 0; i < ticks; ++i) {
    past[static_cast<std::size_t>(i % (delay + 1))] = now;
    const int old = std::min(i, jitter ? static_cast<int>(random.uniform(0.0, delay + 0.999)) : age);
    const State<2, Scalar>& seen = past[static_cast<std::size_t>((i - old) % (delay + 1))];
    if (i % 200 == 0) desired(0) = (random.uniform(0.0, 1.0) < 0.5 ? Scalar(1) : Scalar(-1)) * Scalar(1e6);
    const Joints before = u;
    u = i < stop ? limiter.motion(J, seen, desired, before, Rows<2, 0, Scalar>{}).u : limiter.brake(seen, before).u;
    ASSERT_LE(std::abs(u(0)), acceleration * (Scalar(1) + round_off));
    ASSERT_LE(std::abs(u(0) - before(0)), step * (Scalar(1) + round_off)) << "tick " << i;
    now.q += tick * (now.qd + tick / Scalar(2) * u);
    now.qd += tick * u;
    ASSERT_LE(std::abs(now.q(0)), limits.bounds().upper(0) * (Scalar(1) + round_off)) << "tick " << i;
    ASSERT_LE(std::abs(now.qd(0)), bounds.velocity(0) * (Scalar(1) + round_off)) << "tick " << i;
    ASSERT_LE(limits.bounds().deceleration(0) < acceleration * Scalar(100) ? now.qd(0) : Scalar(0),
              std::sqrt(std::max(Scalar(0), Scalar(2) * bounds.deceleration(0) * (range - now.q(0)))) + round_off);
  }
  if (stop < ticks && tick * static_cast<Scalar>(ticks - stop) > Scalar(1) + bounds.velocity(0) / acceleration) {
    EXPECT_LE(std::abs(u(0)), acceleration / Scalar(100));
  }
}
TEST(MeasuredLimiter, no_bound_is_exceeded_at_any_age) {
  std::uint32_t seed = 0;
  for (const int delay : {1, 2, 3, 5, 10, 30}) {
    for (int trial = 0; trial < trials(200); ++trial, ++seed) {
      SCOPED_TRACE(::testing::Message() << "delay " << delay << ", seed " << seed);
      expect_bounds_at_any_age<double>(seed, delay, seed % 7 == 0 ? 4e-3 : 1e-3);
      if (seed % 4 == 0) expect_bounds_at_any_age<float>(seed, delay, 1e-3F);
      if (HasFatalFailure()) return;
    }
  }
}

/// A loop on a joint whose state is measured with a delay: q̈ = α y − β q̇, where y = r − q is the distance to a bound,
/// or q̈ = −β q̇.
struct Loop {
  double position;      // α h²
  double velocity;      // β h
  double filter = 1.0;  // Fraction of a change of the result that is applied in a tick.

  struct Course {
    double last;    ///< Largest state in the last tenth of the ticks.
    double beyond;  ///< Largest distance beyond the bound.
  };

  /// From rest at y = 1, or with a velocity of 1. The accelerations are `gain` times the commanded accelerations.
  [[nodiscard]] Course run(double gain, int age, int ticks) const {
    const bool bound = position > 0.0;
    std::vector<double> y(static_cast<std::size_t>(ticks + 1), bound ? 1.0 : 0.0);
    std::vector<double> w(static_cast<std::size_t>(ticks + 1), bound ? 0.0 : 1.0);
    Course course{0.0, 0.0};
    double answer = 0.0;
    for (int i = 0; i < ticks; ++i) {
      const auto now = static_cast<std::size_t>(i);
      const auto old = static_cast<std::size_t>(std::max(i - age, 0));
      answer += filter * (position * y[old] - velocity * w[old] - answer);
      const double u = gain * answer;
      w[now + 1] = w[now] + u;
      y[now + 1] = bound ? y[now] - (w[now] + w[now + 1]) / 2.0 : 0.0;
      course.beyond = std::max(course.beyond, bound ? -y[now + 1] : -w[now + 1]);
      if (i >= ticks * 9 / 10) course.last = std::max(course.last, std::hypot(w[now + 1], y[now + 1]));
      if (!std::isfinite(w[now + 1])) return {w[now + 1], course.beyond};
    }
    return course;
  }
  [[nodiscard]] bool stable(double gain, int age) const { return run(gain, age, 6000).last < 0.5; }

  /// Largest gain ≥ 1 with which the loop is stable.
  [[nodiscard]] double gain_margin(int age) const {
    double low = 1.0;
    double high = 64.0;
    while (high > 1.001 * low) {
      const double gain = std::sqrt(low * high);
      (stable(gain, age) ? low : high) = gain;
    }
    return low;
  }
  /// Largest age with which the loop is stable [ticks].
  [[nodiscard]] int oldest() const {
    int age = 0;
    while (age < 400 && stable(1.0, age + 1)) ++age;
    return age;
  }
};

/// The table of docs/measured.md: gain margins at the declared age, and the largest stable age. Up to the declared age,
/// no loop overshoots except the filtered loop, even if the accelerations of the robot are 1.28 times the commanded
/// accelerations.
TEST(MeasuredLimiter, has_stability_margins) {
  constexpr double kMargin = 1.5;
  const double rest = 1.0 + std::sqrt(0.5);
  std::printf("%3s %6s %6s %6s %6s | %-17s | %-17s | %-17s | %-17s\n", "d", "g", "H/h", "D/h", "T/h", "brake",
              "brake, filtered", "velocity bound", "position bound");
  for (const int d : {1, 2, 3, 5, 10}) {
    const double g = std::pow(d, d) / std::pow(d + 1, d + 1);
    const double H = kMargin / g;
    const double D = rest * H;
    const double T = (1.0 + std::sqrt(2.0)) * H;
    const Loop loops[] = {{0.0, 1.0 / D},
                          {0.0, 1.0 / D, 2.0 / D},
                          {0.0, 1.0 / H},
                          {1.0 / (H * (T + H / 2.0)), (T + H) / (H * (T + H / 2.0))}};
    std::printf("%3d %6.4f %6.2f %6.2f %6.2f", d, g, H, D, T);
    for (const Loop& loop : loops) {
      std::printf(" | gain %4.1f, age %3d", loop.gain_margin(d), loop.oldest());
      EXPECT_GE(loop.gain_margin(d), 4.0);
      EXPECT_GE(loop.oldest(), 4 * d);
      for (int age = 0; age <= d; ++age) {
        for (const double gain : {1.0, 1.28}) {
          EXPECT_LE(loop.run(gain, age, 6000).beyond, loop.filter < 1.0 ? 0.2 : 1e-12) << d << " " << age;
        }
      }
    }
    std::printf("\n");
  }
}

}  // namespace
}  // namespace fpbm::test::measured_limiter_laws
