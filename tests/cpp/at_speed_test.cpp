#include "fpbm/path/at_speed.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

#include "fpbm/path/placed.hpp"
#include "fpbm/path/polyline.hpp"
#include "fpbm/path/waypoints.hpp"
#include "support/random.hpp"

/// Constant tool speed: exact derivatives, the speed and its ramps, stops, and the geometry of the given path.
namespace fpbm::test::at_speed_laws {
namespace {

using Plane = Vector<2>;

template <typename Path>
auto linear(const Path& path, double t) {
  using Space = typename Path::Space;
  const Vector<Space::kRows> xd = path.sample(static_cast<typename Path::Scalar>(t)).xd.template cast<double>();
  return Vector<Space::kRows - Space::kTurns>(xd.template head<Space::kRows - Space::kTurns>());
}

template <typename Path>
double speed(const Path& path, double t) {
  return linear(path, t).norm();
}

/// All laws of a path with a bound on jerk. stops: the expected number of stops between the ends.
template <typename Path>
void expect_constant_speed(const std::string& name, const Path& path, int stops, double v = 0.1, double a = 0.5,
                           double j = 10.0) {
  SCOPED_TRACE(name);
  using Space = typename Path::Space;
  const AtSpeed<Path> run(path, v, a, j);
  const double T = run.duration();
  EXPECT_NEAR(100 * T, std::round(100 * T), 1e-6);
  const double ramp = v / a + a / j + 0.01;
  constexpr double kStep = 1e-5;
  std::vector<double> rests;
  double before = 1.0;
  for (int k = 0; k <= std::lround(1000 * T); ++k) {
    const double here = speed(run, k * 1e-3);
    EXPECT_LE(here, v * (1 + 1e-12));
    if (here < 1e-9 && before >= 1e-9) rests.push_back(k * 1e-3);
    before = here;
  }
  ASSERT_EQ(rests.size(), static_cast<std::size_t>(stops + 2));
  EXPECT_EQ(rests.front(), 0.0);
  EXPECT_NEAR(rests.back(), T, 1e-9);
  const int count = trials(2000);
  for (int k = 1; k < count; ++k) {
    const double t = T * k / count;
    SCOPED_TRACE("t = " + std::to_string(t));
    const auto here = run.sample(t);
    const auto earlier = run.sample(t - kStep);
    const auto later = run.sample(t + kStep);
    ASSERT_TRUE(here.xd.allFinite() && here.xdd.allFinite());
    double rest = T;
    for (const double each : rests) rest = std::min(rest, std::abs(t - each));
    if (rest > ramp) {
      EXPECT_NEAR(here.xd.template head<(Space::kRows - Space::kTurns)>().norm(), v, 1e-9 * v);
    }
    if (rest < 0.02) continue;  // Beside a cusp, the curvature is unbounded.
    const double scale = 1.0 + here.xdd.norm();
    EXPECT_LE((Space::template difference<double>(later.x, earlier.x) / (2 * kStep) - here.xd).norm(), 2e-7 * scale);
    EXPECT_LE(((later.xd - earlier.xd) / (2 * kStep) - here.xdd).norm(), 2e-5 * scale);
  }
  // The ramps: differences of the speed along the path.
  constexpr double kRamp = 1e-3;
  for (int k = 1; k + 1 < std::lround(T / kRamp); ++k) {
    const double low = speed(run, (k - 1) * kRamp);
    const double middle = speed(run, k * kRamp);
    const double high = speed(run, (k + 1) * kRamp);
    EXPECT_LE(std::abs(high - low) / (2 * kRamp), a * (1 + 1e-6));
    if (middle > 1e-9) {
      EXPECT_LE(std::abs(high - 2 * middle + low) / (kRamp * kRamp), j * (1 + 1e-6));
    }
  }
}

std::vector<Plane> square(double side) {
  return {{0.0, 0.0}, {side, 0.0}, {side, side}, {0.0, side}, {0.0, 0.0}};
}

template <typename Law>
void expect_constant_speed_of_shapes(const std::string& law) {
  const auto shaped = [](const auto& shape) { return Path<std::decay_t<decltype(shape)>, Law>(shape, 3.0); };
  expect_constant_speed("circle " + law, shaped(Circle<>(0.1)), 0);
  expect_constant_speed("line " + law, shaped(Line<3>({0.3, 0.1, -0.4})), 0);
  expect_constant_speed("lissajous " + law, shaped(Lissajous<>({0.2, 0.1}, {2, 3}, 0.75)), 0);
  expect_constant_speed("tricuspid " + law, shaped(Tricuspid<>(0.05)), 2);
  expect_constant_speed("blended square " + law, shaped(Polyline<Position<2>>(square(0.2), 0.03)), 0);
  expect_constant_speed("square " + law, shaped(Polyline<Position<2>>(square(0.2))), 3);
  const auto line = shaped(Line<2>({0.2, 0.0}));
  const Sequence corner(shaped(Circle<>(0.05)), Sequence(line, shaped(Line<2>({0.0, 0.3}))));
  expect_constant_speed("sequence " + law, corner, 2);
  expect_constant_speed("sequence in space " + law, InPlane(corner, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}), 2);
  expect_constant_speed("sequence of unequal parts " + law,
                        Sequence(Path<Line<2>, Law>(Line<2>({0.1, 0.2}), 0.0125), shaped(Circle<>(0.1))), 1);
  expect_constant_speed("turned circle " + law,
                        WithRotation(InPlane(shaped(Circle<>(0.1)), {0, 1, 0}, {0, 0, 1}), {0.3, -0.2, 0.5}, Law{}), 0);
}

TEST(AtSpeed, keeps_the_speed_along_shapes_of_every_time_law) {
  expect_constant_speed_of_shapes<SinSquared>("sin_squared");
  expect_constant_speed_of_shapes<Quintic>("quintic");
  expect_constant_speed_of_shapes<ConstantSpeed>("constant_speed");
}

TEST(AtSpeed, keeps_the_speed_along_waypoints) {
  Random random(3);
  for (int k = 0; k < trials(5); ++k) {
    std::vector<Vector<3>> points;
    std::vector<Transform<>> poses;
    for (int i = 0; i < 5; ++i) {
      points.emplace_back(random.uniform(3, -0.3, 0.3));
      poses.push_back({points.back(), rotation(Vector<3>(random.uniform(3, -1.0, 1.0)))});
    }
    expect_constant_speed("points", Waypoints<Position<3>>::lasting(points, 3.0), 0);
    expect_constant_speed("poses", Waypoints<Pose>::lasting(poses, 3.0), 0);
  }
  // A spline along a line and back stops where it turns.
  expect_constant_speed("back", Waypoints<Position<2>>::lasting({{0.0, 0.0}, {0.2, 0.0}, {0.0, 0.0}}, 3.0), 1);
}

TEST(AtSpeed, follows_a_circle_by_its_arc_length) {
  const double r = 0.1;
  const double v = 0.125;
  const AtSpeed<Path<Circle<>>> run(Path<Circle<>>(Circle<>(r), 5.0), v, 0.5);
  const double T = run.duration();
  const double length = kTwoPi * r;
  const double ramp = T - length / v;
  EXPECT_NEAR(ramp, 0.25, 0.01);
  for (int k = 0; k <= 1000; ++k) {
    const double t = T * k / 1000;
    const double u = std::min(t, T - t);
    const double begun = u < ramp ? v * u * u / (2 * ramp) : v * (u - ramp / 2);
    const double phi = (2 * t > T ? length - begun : begun) / r;
    const auto at = run.sample(t);
    EXPECT_LE((at.x - Plane(r * (std::cos(phi) - 1), r * std::sin(phi))).norm(), 1e-12);
    const Plane tangent(-std::sin(phi), std::cos(phi));
    const Plane normal(-std::cos(phi), -std::sin(phi));
    const double now = std::min(v, v * u / ramp);
    const double along = u < ramp ? (2 * t > T ? -v : v) / ramp : 0.0;
    if (std::abs(u - ramp) > 1e-9) {
      EXPECT_LE((at.xdd - along * tangent - now * now / r * normal).norm(), 1e-8);
    }
  }
}

TEST(AtSpeed, has_the_duration_of_its_profile) {
  const Path<Line<2>> line(Line<2>({1.0, 0.0}), 3.0);
  EXPECT_NEAR((AtSpeed<Path<Line<2>>>(line, 0.1, 0.5).duration()), 10.2, 1e-12);
  EXPECT_NEAR((AtSpeed<Path<Line<2>>>(line, 0.1, 0.5, 5.0).duration()), 10.3, 1e-12);
  EXPECT_NEAR((AtSpeed<Path<Line<2>>>(line, 10.0, 1.0).duration()), 2.0, 1e-12);                        // √4
  EXPECT_NEAR((AtSpeed<Path<Line<2>>>(line, 10.0, 1e9, 4.0).duration()), 4 * std::cbrt(0.125), 1e-12);  // ∛(32/4)
  // A short path does not reach the speed, and keeps the bounds.
  const Path<Line<2>> shorter(Line<2>({0.003, 0.004}), 3.0);
  for (const double jerk : {1.0, 30.0, 1e4, std::numeric_limits<double>::infinity()}) {
    const AtSpeed<Path<Line<2>>> run(shorter, 1.0, 0.7, jerk);
    double most = 0.0;
    for (double t = 1e-4; t < run.duration() - 1e-4; t += 1e-4) {
      most = std::max(most, std::abs(speed(run, t + 1e-4) - speed(run, t - 1e-4)) / 2e-4);
      const double turn = speed(run, t + 1e-4) - 2 * speed(run, t) + speed(run, t - 1e-4);
      EXPECT_LE(std::abs(turn) / 1e-8, jerk * (1 + 1e-4));
    }
    EXPECT_LE(most, 0.7 * (1 + 1e-9)) << jerk;
    EXPECT_LE((run.sample(run.duration()).x - Plane(0.003, 0.004)).norm(), 1e-15);
  }
}

TEST(AtSpeed, passes_corners_exactly_and_at_rest) {
  const Path<Polyline<Position<2>>, ConstantSpeed> path(Polyline<Position<2>>(square(0.2)), 1.0);
  const AtSpeed<Path<Polyline<Position<2>>, ConstantSpeed>> run(path, 0.1, 0.5);
  const auto corners = square(0.2);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const double t = run.duration() * static_cast<double>(i) / 4;
    EXPECT_LE((run.sample(t).x - corners[i]).norm(), 1e-9);
    EXPECT_LE(run.sample(t).xd.norm(), 1e-9);
    // A step before the corner, and a step after the corner.
    if (i > 0) {
      EXPECT_NEAR(run.sample(t, t - 1e-3).xdd.norm(), 0.5, 0.02);
    }
    if (i > 0) {
      EXPECT_LE((run.sample(t, t - 1e-3).xdd.normalized() - (corners[i - 1] - corners[i]) / 0.2).norm(), 1e-6);
    }
    if (i < 4) {
      EXPECT_LE((run.sample(t, t).xdd.normalized() - (corners[i + 1] - corners[i]) / 0.2).norm(), 1e-6);
    }
  }
  for (const double t : {-1.0, -1e-9, run.duration() + 1e-9, 1e6}) {
    EXPECT_EQ(run.sample(t).xd.norm() + run.sample(t).xdd.norm(), 0.0);
  }
}

TEST(AtSpeed, has_few_digits_in_float) {
  const Path<Circle<float>> circle(Circle<float>(0.1F), 5.0F);
  const AtSpeed<Path<Circle<float>>> run(circle, 0.1F, 0.5F, 5.0F);
  const AtSpeed<Path<Circle<>>> same(Path<Circle<>>(Circle<>(0.1), 5.0), 0.1, 0.5, 5.0);
  ASSERT_NEAR(run.duration(), same.duration(), 0.011);
  for (int k = 0; k <= 600; ++k) {
    EXPECT_TRUE(run.sample(0.01F * static_cast<float>(k)).xdd.allFinite());
    if (k > 40 && k < 600) {
      EXPECT_NEAR(speed(run, 0.01 * k), 0.1, 1e-5) << k;
    }
  }
}

TEST(AtSpeed, rejects_wrong_arguments) {
  const Path<Circle<>> circle(Circle<>(0.1), 5.0);
  using Run = AtSpeed<Path<Circle<>>>;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto name = [](const auto& make) -> std::string {
    try {
      make();
    } catch (const ParameterError& error) {
      return error.name();
    }
    return "";
  };
  for (const double wrong : {0.0, -1.0, nan, std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(name([&] { Run(circle, wrong, 1.0); }), "speed");
    EXPECT_EQ(name([&] { Run(circle, 1.0, wrong); }), "acceleration");
    if (wrong < 1.0 || std::isnan(wrong)) {
      EXPECT_EQ(name([&] { Run(circle, 1.0, 1.0, wrong); }), "jerk");
    }
  }
  const Path<Line<2>> nowhere(Line<2>({0.0, 0.0}), 1.0);
  EXPECT_EQ(name([&] { AtSpeed<Path<Line<2>>>(nowhere, 1.0, 1.0); }), "path");
  const Path<Line<2>> line(Line<2>({0.1, 0.0}), 1.0);
  using Posed = WithRotation<Path<Line<2>>>;
  const Sequence<Posed, Posed> turning(Posed(line), Posed(nowhere, Vector<1>(0.5)));
  EXPECT_EQ(name([&] { AtSpeed<std::decay_t<decltype(turning)>>(turning, 1.0, 1.0); }), "path");
  const Sequence pausing(line, Sequence(nowhere, line));
  EXPECT_NEAR((AtSpeed<std::decay_t<decltype(pausing)>>(pausing, 0.1, 1.0).duration()), 2.2, 1e-9);
}

}  // namespace
}  // namespace fpbm::test::at_speed_laws
