#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <ostream>
#include <stdexcept>
#include <string>
#include <vector>

#include "fpbm/fpbm.hpp"
#include "support/random.hpp"

/// Paths in space, paths of poses, waypoints and sequences.
namespace fpbm::test::space_path_laws {
namespace {

constexpr double kPi = kTwoPi / 2;

Transform<> random_pose(Random& random) {
  return {Vector<3>(random.uniform(3, -0.5, 0.5)), rotation(Vector<3>(random.uniform(3, -1.5, 1.5)))};
}

template <typename Space>
std::vector<typename Space::template Point<double>> random_points(Random& random, int count) {
  std::vector<typename Space::template Point<double>> points;
  for (int i = 0; i < count; ++i) {
    if constexpr (std::is_same_v<Space, Pose>) {
      points.push_back(random_pose(random));
    } else {
      points.emplace_back(random.uniform(Space::kRows, -1.0, 1.0));
    }
  }
  return points;
}

/// xd is the derivative of x by ⊖, and xdd the derivative of xd, except at steps of xdd.
template <typename Path>
void expect_exact_derivatives(const Path& path, const std::vector<double>& steps_at = {}) {
  using Space = typename Path::Space;
  constexpr double kStep = 1e-5;
  for (int i = 0; i <= 200; ++i) {
    const double t = -0.1 + (path.duration() + 0.2) * i / 200.0;
    bool at_step = std::abs(t) < 2 * kStep || std::abs(t - path.duration()) < 2 * kStep;
    for (const double step : steps_at) at_step = at_step || std::abs(t - step) < 2 * kStep;
    if (at_step) continue;
    SCOPED_TRACE("t = " + std::to_string(t));
    const auto before = path.sample(t - kStep);
    const auto here = path.sample(t);
    const auto after = path.sample(t + kStep);
    const double scale = 1.0 + here.xdd.norm();
    EXPECT_LE((Space::template difference<double>(after.x, before.x) / (2 * kStep) - here.xd).norm(), 1e-8 * scale);
    EXPECT_LE(((after.xd - before.xd) / (2 * kStep) - here.xdd).norm(), 1e-7 * scale);
  }
}

/// The path starts at the origin, is at rest at both ends and outside, and has no step of xdd.
template <typename Path>
void expect_smooth_ends(const Path& path) {
  using Space = typename Path::Space;
  const double T = path.duration();
  EXPECT_LE(Space::template difference<double>(path.sample(0).x, Space::template origin<double>()).norm(), 1e-14);
  for (const double t : {-1.0, 0.0, T, T + 1.0}) {
    EXPECT_LE(path.sample(t).xd.norm(), 1e-11);
    EXPECT_LE(path.sample(t).xdd.norm(), 1e-10);
  }
}

TEST(InPlane, is_the_path_along_the_axes) {
  const Path circle(Circle(0.3), 5.0);
  const InPlane laid(circle, Vector<3>(0, 2, 0), Vector<3>(-0.5, 0, 0.5));
  expect_exact_derivatives(laid);
  const auto flat = circle.sample(1.3);
  const auto at = laid.sample(1.3);
  const Vector<3> v = Vector<3>(-1, 0, 1) / std::sqrt(2.0);
  EXPECT_LE((at.x - flat.x(0) * Vector<3>(0, 1, 0) - flat.x(1) * v).norm(), 1e-15);
  EXPECT_LE((at.xd - flat.xd(0) * Vector<3>(0, 1, 0) - flat.xd(1) * v).norm(), 1e-15);
}

TEST(WithRotation, turns_from_rest_to_rest) {
  const Vector<3> turn(0.3, -1.0, 2.0);
  const WithRotation path(InPlane(Path(Circle(0.3), 5.0), Vector<3>::UnitY(), Vector<3>::UnitZ()), turn);
  expect_exact_derivatives(path);
  const auto end = path.sample(5.0);
  EXPECT_LE((rotation_vector(end.x.R) - turn).norm(), 1e-14);
  EXPECT_LE(end.xd.tail<3>().norm() + end.xdd.tail<3>().norm(), 1e-13);
  EXPECT_LE((rotation_vector(path.sample(6.0).x.R) - turn).norm(), 1e-14);
  EXPECT_EQ(path.sample(6.0).xdd.norm(), 0.0);

  const WithRotation held(Path(Line<3>({0.1, 0.2, 0.3}), 2.0));
  EXPECT_LE((held.sample(1.2).x.R - Matrix<3, 3>::Identity()).norm(), 1e-15);
  EXPECT_EQ(held.sample(1.2).xd.tail<3>().norm(), 0.0);

  const WithRotation planar(Path(Circle(0.3), 5.0), Vector<1>(-4.0), SinSquared{});
  expect_exact_derivatives(planar);
  EXPECT_NEAR(planar.sample(5.0).x(2), -4.0, 1e-14);
}

template <typename Space>
void expect_waypoints() {
  Random random(1);
  for (int count = 2; count < 30; count += 3) {
    const auto points = random_points<Space>(random, count);
    std::vector<double> times(points.size(), 0.0);
    for (std::size_t i = 1; i < times.size(); ++i) times[i] = times[i - 1] + random.uniform(0.5, 1.5);
    const Waypoints<Space> timed(points, times);
    expect_smooth_ends(timed);
    expect_exact_derivatives(timed);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto here = timed.sample(times[i]);
      const auto expected = Space::template difference<double>(points[i], points[0]);
      const auto displacement = Space::template difference<double>(here.x, Space::template origin<double>());
      if constexpr (std::is_same_v<Space, Pose>) {
        EXPECT_LE((here.x.R * points[0].R - points[i].R).norm(), 1e-12);
        EXPECT_LE((displacement - expected).template head<3>().norm(), 1e-12);
      } else {
        EXPECT_LE((displacement - expected).norm(), 1e-12);
      }
      // C² across the knot.
      constexpr double kNear = 1e-9;
      EXPECT_LE((timed.sample(times[i] + kNear).xdd - timed.sample(times[i] - kNear).xdd).norm(),
                1e-6 * (1 + here.xdd.norm()));
    }
  }
}

TEST(Waypoints, pass_every_point_on_time) {
  expect_waypoints<Position<2>>();
  expect_waypoints<Position<3>>();
  expect_waypoints<Pose>();
}

/// A minimum-jerk spline has continuous jerk and snap: one-sided differences of the acceleration agree across each
/// knot.
TEST(Spline, has_four_continuous_derivatives) {
  Random random(6);
  std::vector<Vector<2>> points;
  std::vector<double> times;
  for (int i = 0; i < 6; ++i) {
    points.emplace_back(random.uniform(2, -1.0, 1.0));
    times.push_back(i == 0 ? 0.0 : times.back() + random.uniform(0.5, 1.5));
  }
  const Spline<2> spline(points, times);
  for (std::size_t i = 1; i + 1 < times.size(); ++i) {
    constexpr double kStep = 1e-3;
    const auto at = [&](int steps) { return Vector<2>(spline.at(times[i] + steps * kStep).xdd); };
    // Within a piece, the acceleration is a cubic, which four points determine.
    const auto jerk = [&](int direction) {
      return Vector<2>((-11 * at(0) + 18 * at(direction) - 9 * at(2 * direction) + 2 * at(3 * direction)) /
                       (6 * direction * kStep));
    };
    const auto snap = [&](int direction) {
      return Vector<2>((2 * at(0) - 5 * at(direction) + 4 * at(2 * direction) - at(3 * direction)) / (kStep * kStep));
    };
    EXPECT_LE((jerk(1) - jerk(-1)).norm(), 1e-8 * (1 + jerk(1).norm()));
    EXPECT_LE((snap(1) - snap(-1)).norm(), 1e-6 * (1 + snap(1).norm()));
  }
}

TEST(Waypoints, of_two_points_are_the_quintic_law) {
  const auto line = Waypoints<Position<3>>::lasting({{0, 0, 0}, {0.3, 0.1, -0.2}}, 2.5);
  const Path expected(Line<3>({0.3, 0.1, -0.2}), 2.5, Quintic{});
  for (double t = 0.0; t < 2.5; t += 0.1) {
    EXPECT_LE((line.sample(t).x - expected.sample(t).x).norm(), 1e-15);
    EXPECT_LE((line.sample(t).xdd - expected.sample(t).xdd).norm(), 1e-14);
  }
}

TEST(Waypoints, turn_through_more_than_half_a_turn) {
  std::vector<Transform<>> points;
  for (int i = 0; i <= 8; ++i) points.push_back({Vector<3>(0.1 * i, 0, 0), rotation(Vector<3>(0, 0, kPi / 2 * i))});
  const auto path = Waypoints<Pose>::lasting(points, 8.0);
  double turned = 0.0;
  for (int i = 0; i < 8000; ++i) turned += 1e-3 * path.sample(1e-3 * (i + 0.5)).xd(5);
  EXPECT_NEAR(turned, 4 * kPi, 1e-4);
}

/// The fastest path within the bounds exceeds no bound and nearly reaches one.
TEST(Waypoints, keep_their_bounds) {
  Random random(2);
  for (int trial = 0; trial < 20; ++trial) {
    const auto points = random_points<Pose>(random, 2 + trial);
    const TipBounds<> bounds{random.uniform(0.1, 1.0), random.uniform(0.5, 5.0), random.uniform(0.3, 3.0),
                             random.uniform(1.0, 10.0)};
    const auto path = Waypoints<Pose>::within(points, bounds);
    double most = 0.0;
    for (double t = 0.0; t < path.duration(); t += 1e-3) {
      const auto at = path.sample(t);
      most = std::max({most, at.xd.head<3>().norm() / bounds.velocity, at.xd.tail<3>().norm() / bounds.angular_velocity,
                       std::sqrt(at.xdd.head<3>().norm() / bounds.acceleration),
                       std::sqrt(at.xdd.tail<3>().norm() / bounds.angular_acceleration)});
    }
    EXPECT_LE(most, 1.0);
    EXPECT_GE(most, 1.0 / (1.005 + 0.012 / path.duration()));
    EXPECT_NEAR(path.duration() * 100, std::round(path.duration() * 100), 1e-9);
  }
}

TEST(Sequence, is_one_path_and_then_the_other) {
  const WithRotation first(Path(Line<3>({0.1, 0.2, 0.3}), 2.0), Vector<3>(0, 0, 1.0));
  const WithRotation second(Path(Line<3>({0.0, -0.2, 0.0}), 1.0, Quintic{}), Vector<3>(0.5, 0, 0));
  const Sequence both(first, second);
  const Sequence three(both, first);
  EXPECT_EQ(three.duration(), 5.0);
  expect_exact_derivatives(both, {2.0});
  expect_exact_derivatives(three, {2.0, 3.0});
  EXPECT_LE((both.sample(3.0).x.p - Vector<3>(0.1, 0.0, 0.3)).norm(), 1e-15);
  const Matrix<3, 3> turned = rotation(Vector<3>(0.5, 0, 0)) * rotation(Vector<3>(0, 0, 1.0));
  EXPECT_LE((both.sample(3.0).x.R - turned).norm(), 1e-14);
  // At a step of xdd, a step of an integrator stays within its piece.
  EXPECT_LE((both.sample(2.0, 1.99).xdd - first.sample(2.0).xdd).norm(), 0.0);
  EXPECT_LE((both.sample(2.0, 2.0).xdd - second.sample(0.0).xdd).norm(), 0.0);
  EXPECT_GT((first.sample(2.0).xdd - second.sample(0.0).xdd).norm(), 0.1);
}

/// MAN has no feedback, and tracks a sequence to round-off although its acceleration steps: no step of RK4 contains the
/// transition between the pieces.
TEST(Sequence, is_integrated_piece_by_piece) {
  const PlanarArm<4> arm({1.0, 1.0, 1.0, 1.0});
  const Path circle(Circle(0.2), 2.0);
  const Sequence twice(circle, circle);
  const State<4> start{{0.3, 0.4, 0.5, 0.3}, Vector<4>::Zero()};
  double worst = 0.0;
  const auto run = rollout(arm, twice, MAN<4>(), start, TimeGrid<>(4.0, 1e-3),
                           [&](const auto& sample) noexcept { worst = std::max(worst, sample.error.norm()); });
  EXPECT_EQ(run.status, Status::kOk);
  EXPECT_LE(worst, 1e-10);
}

/// A step of the reference velocity, within the path or at its end, is not reported as a lost task.
TEST(Sequence, may_step_in_velocity) {
  const PlanarArm<4> arm({1.0, 1.0, 1.0, 1.0});
  const Path circle(Circle(0.2), 4.0, ConstantSpeed{});
  const Path line(Line<2>({-0.2, 0.1}), 1.0, ConstantSpeed{});
  const State<4> start{{0.3, 0.4, 0.5, 0.3}, Vector<4>::Zero()};
  const auto scheme = FPBM<4>(0.6, DiagonalWeights<4>({1, 2, 3, 4}), 10.0, 25.0, NullSpace<4>{}.with_damping(2.0));
  const auto status = [&](const auto& path, const auto& by) {
    return rollout(arm, path, by, start, TimeGrid<>(path.duration(), 1e-3, 2.0), [](const auto&) noexcept {}).status;
  };
  EXPECT_EQ(status(circle, scheme), Status::kOk);
  EXPECT_EQ(status(Sequence(circle, line), scheme), Status::kOk);
  EXPECT_EQ(status(Sequence(circle, line), MVN<4>(5.0)), Status::kOk);
}

template <typename Make>
std::string refusal(Make&& make) {
  try {
    (void)make();
  } catch (const std::invalid_argument& refused) {
    return refused.what();
  }
  return "accepted";
}

TEST(SpacePaths, invalid_paths_are_rejected) {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  const Path circle(Circle(0.3), 5.0);
  EXPECT_EQ(refusal([&] { return InPlane(circle, Vector<3>(1, 0, 0), Vector<3>(0, 0, 0)); }),
            "u and v: must both be nonzero");
  EXPECT_EQ(refusal([&] { return InPlane(circle, Vector<3>(1, 0, 0), Vector<3>(1, 0, 1)); }).substr(0, 25),
            "u v / |u| |v| = 0.7071067");
  EXPECT_EQ(refusal([&] { return InPlane(circle, Vector<3>(1, kInf, 0), Vector<3>(1, 0, 1)); }),
            "u[1] = inf: must be finite");
  EXPECT_EQ(refusal([&] { return WithRotation(circle, Vector<1>(kInf)); }), "rotation[0] = inf: must be finite");

  using PlanarWaypoints = Waypoints<Position<2>>;
  const std::vector<Vector<2>> points{{0, 0}, {1, 0}, {1, 1}};
  EXPECT_EQ(refusal([&] { return PlanarWaypoints({{0, 0}}, {0.0}); }), "points has 1 entries: must have at least 2");
  EXPECT_EQ(refusal([&] {
              return PlanarWaypoints(points, {0.0, 1.0});
            }),
            "times has 2 entries: must have 3, one per point");
  EXPECT_EQ(refusal([&] { return PlanarWaypoints(points, {0.5, 1.0, 2.0}); }), "times[0] = 0.5: must be 0");
  EXPECT_EQ(refusal([&] {
              return PlanarWaypoints(points, {0.0, 1.0, 1.0});
            }),
            "times[2] = 1: must be finite and later than the previous time");
  EXPECT_EQ(refusal([&] {
              return PlanarWaypoints({{0, 0}, {1, kInf}}, {0.0, 1.0});
            }),
            "points[1][1] = inf: must be finite");
  EXPECT_EQ(refusal([&] { return PlanarWaypoints::lasting(points, -1.0); }),
            "duration = -1: must be positive and finite");
  EXPECT_EQ(refusal([&] {
              return PlanarWaypoints::lasting({{0, 0}, {0, 0}}, 1.0);
            }),
            "points[1]: must differ from the previous point");
  EXPECT_EQ(refusal([&] { return PlanarWaypoints::within(points, {}); }),
            "bounds: at least one bound must limit the tip: give a bound on velocity, acceleration or jerk");
  EXPECT_EQ(refusal([&] { return PlanarWaypoints::within(points, {0.0}); }), "velocity = 0: must be positive");
}

}  // namespace
}  // namespace fpbm::test::space_path_laws
