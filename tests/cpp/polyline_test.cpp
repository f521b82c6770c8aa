#include "fpbm/path/polyline.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

#include "support/random.hpp"

/// Polylines: exact derivatives, two continuous derivatives, blends inside the corners, stops without blends.
namespace fpbm::test::polyline_laws {
namespace {

template <typename Space>
std::vector<typename Space::template Point<double>> random_points(Random& random) {
  std::vector<typename Space::template Point<double>> points;
  for (int i = 0; i < 6; ++i) {
    if constexpr (std::is_same_v<Space, Pose>) {
      points.push_back({Vector<3>(random.uniform(3, -0.5, 0.5)), rotation(Vector<3>(random.uniform(3, -1.5, 1.5)))});
    } else {
      points.emplace_back(random.uniform(Space::kRows, -1.0, 1.0));
    }
  }
  return points;
}

template <typename Space>
void expect_smooth(double blend) {
  Random random(5);
  for (int trial = 0; trial < trials(20); ++trial) {
    const auto points = random_points<Space>(random);
    const Polyline<Space> shape(points, blend);
    constexpr double kStep = 1e-7;
    for (int k = 1; k < 2000; ++k) {
      const double s = k / 2000.0;
      const auto before = shape.at(s - kStep);
      const auto here = shape.at(s);
      const auto after = shape.at(s + kStep);
      // d2 is continuous with kinks: its slope is at most 6 L³/r² with a blend, and 60 N³ L without blends.
      const double scale = 1.0 + here.d1.norm() + here.d2.norm();
      EXPECT_LE((Space::template difference<double>(after.d, before.d) / (2 * kStep) - here.d1).norm(), 1e-6 * scale);
      EXPECT_LE(((after.d1 - before.d1) / (2 * kStep) - here.d2).norm(), 1e-3 * scale);
      EXPECT_LE((after.d2 - here.d2).norm(), 0.1 * scale) << s;
    }
    // Differences from the first point.
    const auto end = Space::template compose<double>(points.front(), shape.at(1.0).d);
    EXPECT_LE(Space::template difference<double>(end, points.back()).norm(), 1e-12);
    EXPECT_LE(Space::template difference<double>(shape.at(0.0).d, Space::template origin<double>()).norm(), 1e-15);
  }
}

TEST(Polyline, has_two_continuous_derivatives) {
  expect_smooth<Position<2>>(0.05);
  expect_smooth<Position<3>>(0.1);
  expect_smooth<PlanarPose>(0.1);
  expect_smooth<Pose>(0.1);
  expect_smooth<Pose>(1e9);  // Half of the shorter segment.
  expect_smooth<Position<3>>(0.0);
  expect_smooth<Pose>(0.0);
}

using Plane = Vector<2>;

TEST(Polyline, stays_inside_its_corners) {
  Random random(9);
  for (int trial = 0; trial < trials(200); ++trial) {
    std::vector<Plane> points{{0.0, 0.0}, {1.0, 0.0}};
    const double angle = random.uniform(-3.1, 3.1);
    const double length = random.uniform(0.2, 2.0);
    points.push_back(points[1] + length * Plane(std::cos(angle), std::sin(angle)));
    const double blend = random.uniform(0.01, 1.0);
    const double radius = std::min({blend, 0.5, length / 2});
    const Polyline<Position<2>> shape(points, blend);
    const auto outside = [](const Plane& from, const Plane& to, const Plane& x, double side) {
      const Plane along = (to - from).normalized();
      return -side * (along(0) * (x - from)(1) - along(1) * (x - from)(0));
    };
    const double side = angle > 0.0 ? 1.0 : -1.0;
    for (int k = 0; k <= 1000; ++k) {
      const double s = k / 1000.0;
      const Plane x = shape.at(s).d;
      EXPECT_LE(outside(points[0], points[1], x, side), 1e-12);
      EXPECT_LE(outside(points[1], points[2], x, side), 1e-12);
      EXPECT_LE(outside(points[2], points[0], x, side), 1e-12);
      // Outside of the blend: on the segments, by their length.
      const double distance = s * (1.0 + length);
      if (std::abs(distance - 1.0) < radius) {
        EXPECT_LE((x - points[1]).norm(), radius + 1e-12);
      } else if (distance < 1.0) {
        EXPECT_LE((x - Plane(distance, 0.0)).norm(), 1e-12);
      } else {
        EXPECT_LE((x - points[1] - (distance - 1.0) * (points[2] - points[1]) / length).norm(), 1e-12);
      }
    }
  }
}

TEST(Polyline, rotates_in_proportion_to_the_distance) {
  const Vector<3> turn{0.3, -0.4, 0.5};
  const Matrix<3, 3> first = rotation(Vector<3>(0.1, 0.2, 0.3));
  const std::vector<Transform<>> points{{Vector<3>(1.0, 2.0, 3.0), first},
                                        {Vector<3>(1.0, 2.0, 4.0), rotation(turn) * first}};
  const Polyline<Pose> shape(points, 0.1);
  for (const double s : {0.0, 0.25, 0.5, 1.0}) {
    EXPECT_LE((shape.at(s).d.p - Vector<3>(0.0, 0.0, s)).norm(), 1e-15);
    EXPECT_LE((shape.at(s).d.R - rotation(Vector<3>(s * turn))).norm(), 1e-15);
    EXPECT_LE((shape.at(s).d1.tail<3>() - turn).norm(), 1e-15);
  }
}

TEST(Polyline, stops_at_its_corners_without_blends) {
  const Polyline<Position<2>> shape({{0.0, 0.0}, {0.3, 0.0}, {0.3, 0.1}, {0.0, 0.1}});
  for (const double s : {0.0, 3.0 / 7, 4.0 / 7, 1.0}) {
    EXPECT_LE(shape.at(s).d1.norm() + shape.at(s).d2.norm(), 1e-12);
  }
  EXPECT_LE((shape.at(3.0 / 7).d - Plane(0.3, 0.0)).norm(), 1e-15);
  EXPECT_LE((shape.at(4.0 / 7).d - Plane(0.3, 0.1)).norm(), 1e-15);
}

TEST(Polyline, rejects_wrong_arguments) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto words = [](const std::vector<Plane>& points, double blend) -> std::string {
    try {
      (void)Polyline<Position<2>>(points, blend);
    } catch (const ParameterError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(words({{0, 0}, {1, 0}}, 0.1), "");
  EXPECT_EQ(words({{0, 0}}, 0.1), "points has 1 entries: must have at least 2");
  EXPECT_EQ(words({{0, 0}, {1, nan}}, 0.1), "points[1][1] = nan: must be finite");
  EXPECT_EQ(words({{0, 0}, {1, 0}, {1, 0}}, 0.1), "points[2]: must have another position than the previous point");
  for (const double wrong : {-0.1, nan, std::numeric_limits<double>::infinity()}) {
    EXPECT_NE(words({{0, 0}, {1, 0}}, wrong).find("blend = "), std::string::npos) << wrong;
  }
}

}  // namespace
}  // namespace fpbm::test::polyline_laws
