#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "fpbm/path/waypoints.hpp"
#include "support/random.hpp"

/// Waypoints::within: no bound is exceeded between samples, and the path is as fast as documented.
namespace fpbm::test::waypoints_bounds_laws {
namespace {

/// Points at distances of millimetres to metres; orientations up to half a turn apart, one in four exactly.
template <typename Space, typename Scalar>
std::vector<typename Space::template Point<Scalar>> random_points(Random& random) {
  using Point = typename Space::template Point<Scalar>;
  std::vector<Point> points;
  Point x = Space::template origin<Scalar>();
  const int count = static_cast<int>(random.uniform(2.0, 7.0));
  for (int i = 0; i < count; ++i) {
    Vector<Space::kRows, Scalar> displacement =
        (random.uniform(Space::kRows, -1.0, 1.0) * std::pow(10.0, random.uniform(-3.0, 0.0))).template cast<Scalar>();
    if constexpr (Space::kTurns == 3) {
      const Vector<3> axis = random.uniform(3, -1.0, 1.0).normalized();
      const double angle = random.uniform(0.0, 1.0) < 0.25 ? kTwoPi / 2 : random.uniform(0.0, 3.1);
      displacement.template tail<3>() = (angle * axis).template cast<Scalar>();
    } else if constexpr (Space::kTurns == 1) {
      displacement(2) = static_cast<Scalar>(random.uniform(-3.0, 3.0));
    }
    x = Space::template displace<Scalar>(x, displacement);
    if constexpr (Space::kTurns == 3) x.R = orthonormal(x.R);
    points.push_back(x);
  }
  return points;
}

template <typename Scalar>
TipBounds<Scalar> random_bounds(Random& random, bool turns) {
  const auto power = [&](double low, double high) {
    return static_cast<Scalar>(std::pow(10.0, random.uniform(low, high)));
  };
  TipBounds<Scalar> bounds;
  bounds.velocity = power(-1.3, 0.3);
  if (random.uniform(0.0, 1.0) < 0.7) bounds.acceleration = power(-1.0, 1.0);
  // The jerk is tested by differences of accelerations, which have too few digits in float.
  const bool exact = sizeof(Scalar) == 8;
  if (exact && random.uniform(0.0, 1.0) < 0.5) bounds.jerk = power(-0.5, 2.0);
  if (turns) {
    if (exact && random.uniform(0.0, 1.0) < 0.5) bounds.angular_jerk = power(0.0, 2.5);
    bounds.angular_velocity = power(-1.0, 0.5);
    if (random.uniform(0.0, 1.0) < 0.7) bounds.angular_acceleration = power(-0.3, 1.3);
  }
  return bounds;
}

/// Largest fraction of a bound that a path uses, by dense samples and closer samples around the maximum. For
/// accelerations, the square root of the fraction, and for jerks, the cube root: they scale with time like the fraction
/// of a velocity.
template <typename Path, typename Scalar>
double largest_share(const Path& path, const TipBounds<Scalar>& bounds) {
  using Space = typename Path::Space;
  constexpr int kLinear = Space::kRows - Space::kTurns;
  const auto T = static_cast<double>(path.duration());
  const auto share = [&](double t) {
    const auto at = path.sample(static_cast<Scalar>(t));
    const double from = std::clamp(t - 1e-5 * T, 0.0, (1 - 1e-5) * T);
    const double to = std::clamp(t + 1e-5 * T, 1e-5 * T, T);
    const auto jerk = ((path.sample(static_cast<Scalar>(to)).xdd - path.sample(static_cast<Scalar>(from)).xdd) /
                       static_cast<Scalar>(to - from))
                          .eval();
    const Scalar linear = std::max({at.xd.template head<kLinear>().norm() / bounds.velocity,
                                    std::sqrt(at.xdd.template head<kLinear>().norm() / bounds.acceleration),
                                    std::cbrt(jerk.template head<kLinear>().norm() / bounds.jerk)});
    if constexpr (Space::kTurns == 0) return static_cast<double>(linear);
    const Scalar angular =
        std::max({at.xd.template tail<Space::kTurns>().norm() / bounds.angular_velocity,
                  std::sqrt(at.xdd.template tail<Space::kTurns>().norm() / bounds.angular_acceleration),
                  std::cbrt(jerk.template tail<Space::kTurns>().norm() / bounds.angular_jerk)});
    return static_cast<double>(std::max(linear, angular));
  };
  double most = 0.0;
  double where = 0.0;
  double step = T / 20000;
  for (int i = 0; i <= 20000; ++i) {
    const double here = share(i * step);
    if (here > most) where = i * step;
    most = std::max(most, here);
  }
  for (int round = 0; round < 3; ++round, step /= 50) {
    const double middle = where;
    for (int i = -50; i <= 50; ++i) {
      const double here = share(middle + i * step / 50);
      if (here > most) where = middle + i * step / 50;
      most = std::max(most, here);
    }
  }
  return most;
}

template <typename Space, typename Scalar>
void expect_bounds_between_samples(const char* name) {
  Random random(11);
  double worst = 0.0;
  double slowest = 0.0;  // Relative to the shortest duration, without the rounding up to 0.01 s.
  for (int trial = 0; trial < trials(200); ++trial) {
    const auto points = random_points<Space, Scalar>(random);
    const auto bounds = random_bounds<Scalar>(random, Space::kTurns > 0);
    const auto path = Waypoints<Space, Scalar>::within(points, bounds);
    const double share = largest_share(path, bounds);
    worst = std::max(worst, share);
    EXPECT_LE(share, 1 + 1e-9) << name << ", trial " << trial;
    const auto duration = static_cast<double>(path.duration());
    const double shortest = share * duration;
    slowest = std::max(slowest, (duration - 0.01) / shortest);
    EXPECT_LE(duration, 1.0101 * shortest + 0.0101) << name << ", trial " << trial;
    EXPECT_NEAR(duration * 100, std::round(duration * 100),
                1e-9 * std::max(1.0, duration) + (sizeof(Scalar) == 4 ? 1e-3 * duration : 0.0));
  }
  std::printf("%s: at most %.5f of a bound, at most %.4f of the shortest duration + 0.01 s\n", name, worst, slowest);
}

TEST(WaypointsBounds, hold_between_samples) {
  expect_bounds_between_samples<Position<2>, double>("Position<2>");
  expect_bounds_between_samples<Position<3>, double>("Position<3>");
  expect_bounds_between_samples<PlanarPose, double>("PlanarPose");
  expect_bounds_between_samples<Pose, double>("Pose");
  expect_bounds_between_samples<Pose, float>("Pose, float");
}

}  // namespace
}  // namespace fpbm::test::waypoints_bounds_laws
