#include "fpbm/bound/detail/distance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "support/random.hpp"

/// Distances of shapes of all sizes: in general position, parallel, crossing, touching, one inside the other, or
/// points.
namespace fpbm::test::clearance_distance_laws {
namespace {

template <typename Scalar>
class Distances : public ::testing::Test {
 protected:
  using Vector3 = Vector<3, Scalar>;
  static constexpr Scalar kEpsilon = std::numeric_limits<Scalar>::epsilon();

  Scalar uniform(double low, double high) { return static_cast<Scalar>(random_.uniform(low, high)); }
  bool chance(double share) { return random_.uniform(0.0, 1.0) < share; }
  Scalar size() { return static_cast<Scalar>(std::pow(10.0, random_.uniform(-3.0, 1.0))); }
  Vector3 vector() { return random_.uniform(3, -1.0, 1.0).cast<Scalar>(); }
  Vector3 direction() { return vector().normalized(); }
  /// Integers, so that results are often exactly zero.
  Vector3 whole() { return (Scalar(2) * vector()).array().round().matrix(); }

  Transform<Scalar> pose() {
    const Eigen::Vector3d turn = random_.uniform(3, -3.0, 3.0);
    return {vector(), rotation<double>(Vector<3>(turn)).template cast<Scalar>()};
  }

  Segment<Scalar> segment() {
    if (chance(0.2)) return {whole(), whole()};
    return {size() * vector(), chance(0.1) ? Vector3(Vector3::Zero()) : Vector3(size() * vector())};
  }

  /// A direction that is parallel or nearly parallel to `axis`.
  Vector3 near_parallel(const Vector3& axis) {
    const Scalar angle = chance(0.3) ? Scalar(0) : static_cast<Scalar>(std::pow(10.0, random_.uniform(-18.0, -1.0)));
    return uniform(-2, 2) * (axis + angle * axis.norm() * vector());
  }

  Scalar radius() { return chance(0.2) ? Scalar(0) : size(); }

  Capsule<Scalar> capsule(const Segment<Scalar>& core) { return {core.start, core.start + core.extent, radius()}; }

  /// A second segment: anywhere, nearly parallel, through a point of the first segment, or with an end at a point of
  /// the first segment.
  Segment<Scalar> other(const Segment<Scalar>& first) {
    Segment<Scalar> second = segment();
    if (chance(0.3)) second.extent = near_parallel(first.extent);
    const Scalar on_second = chance(0.5) ? std::round(uniform(0, 1)) : uniform(0, 1);
    const Scalar on_first = chance(0.5) ? std::round(uniform(0, 1)) : uniform(0, 1);
    if (chance(0.5)) second.start = first.at(on_first) - on_second * second.extent;
    // So near that the difference of the points has few significant digits.
    if (chance(0.5)) second.start += static_cast<Scalar>(std::pow(10.0, random_.uniform(-18.0, -2.0))) * direction();
    return second;
  }

  struct Pair {
    Capsule<Scalar> first;
    Capsule<Scalar> second;
  };
  Pair capsules() {
    const Segment<Scalar> first = segment();
    return {capsule(first), capsule(other(first))};
  }

  struct BoxPair {
    Capsule<Scalar> first;
    Cuboid<Scalar> second;
  };
  /// A box of any shape, possibly flat, and a segment anywhere, inside the box, through the box, or along an edge.
  BoxPair capsule_and_box() {
    Vector3 half{size(), size(), size()};
    if (chance(0.2)) half(0) = Scalar(0);
    if (chance(0.1)) half(1) = Scalar(0);
    Segment<Scalar> core = segment();
    const Vector3 corner = half.cwiseProduct(whole().cwiseMin(Scalar(1)).cwiseMax(Scalar(-1)));
    if (chance(0.6)) core = other({corner, half.cwiseProduct(vector())});
    if (chance(0.3)) core.extent = near_parallel(half.cwiseProduct(Vector3::Unit(chance(0.5) ? 1 : 2)));
    const Transform<Scalar> at = chance(0.3) ? Transform<Scalar>{} : pose();
    return {placed(capsule(core), at), {at, half}};
  }

  /// Gap between two shapes along a unit vector n.
  static Scalar gap(const Capsule<Scalar>& first, const Capsule<Scalar>& second, const Vector3& n) {
    const Scalar low = std::min(n.dot(first.a - second.a), n.dot(first.b - second.a));
    const Scalar high = std::max(Scalar(0), n.dot(second.b - second.a));
    return low - high - first.radius - second.radius;
  }
  static Scalar gap(const Capsule<Scalar>& first, const Cuboid<Scalar>& second, const Vector3& n) {
    const Vector3 across = second.pose.R.transpose() * n;
    return std::min(n.dot(first.a - second.pose.p), n.dot(first.b - second.pose.p)) -
           across.cwiseAbs().dot(second.half) - first.radius;
  }

  /// Signed distance of a point from a shape, positive outside.
  static Scalar from(const Capsule<Scalar>& shape, const Vector3& point) {
    const Vector3 segment = shape.b - shape.a;
    const Scalar t = segment.isZero(0)
                         ? Scalar(0)
                         : std::clamp(Scalar(segment.stableNormalized().dot(point - shape.a) / segment.stableNorm()),
                                      Scalar(0), Scalar(1));
    return (point - shape.a - t * segment).stableNorm() - shape.radius;
  }
  static Scalar from(const Cuboid<Scalar>& shape, const Vector3& point) {
    const Vector3 beyond = (shape.pose.R.transpose() * (point - shape.pose.p)).cwiseAbs() - shape.half;
    const Scalar inside = std::min(beyond.maxCoeff(), Scalar(0));
    return beyond.cwiseMax(Scalar(0)).stableNorm() + inside;
  }
  static Scalar from(const HalfSpace<Scalar>& shape, const Vector3& point) {
    return shape.normal.dot(point) - shape.offset;
  }

  static Capsule<Scalar> moved(const Capsule<Scalar>& capsule, const Vector3& by) {
    return {capsule.a + by, capsule.b + by, capsule.radius};
  }
  static Cuboid<Scalar> moved(const Cuboid<Scalar>& box, const Transform<Scalar>& by) {
    return {by * box.pose, box.half};
  }

  static Scalar extent(const Capsule<Scalar>& capsule) { return capsule.a.norm() + capsule.b.norm() + capsule.radius; }
  static Scalar extent(const Cuboid<Scalar>& box) { return box.pose.p.norm() + Scalar(2) * box.half.norm(); }
  static Scalar extent(const HalfSpace<Scalar>& solid) { return std::abs(solid.offset); }

  /// Bound on the round-off error of a distance.
  template <typename Second>
  static Scalar slack(const Capsule<Scalar>& first, const Second& second) {
    return Scalar(32) * kEpsilon * (extent(first) + extent(second));
  }
  /// Bound on the error of a gap along the normal: the normal is accurate to three quarters of the digits of Scalar.
  template <typename Second>
  static Scalar slack_of_normal(const Capsule<Scalar>& first, const Second& second) {
    return slack(first, second) + Scalar(4) * std::pow(kEpsilon, Scalar(0.75)) * (extent(first) + extent(second));
  }

  /// The normal is a unit vector, the points are on both surfaces, and their difference equals distance · normal.
  template <typename Second>
  static void expect_consistent(const Nearest<Scalar>& found, const Capsule<Scalar>& first, const Second& second,
                                const std::string& where) {
    const Scalar tolerance = slack(first, second);
    ASSERT_NEAR(found.normal.norm(), Scalar(1), 8 * kEpsilon) << where;
    ASSERT_LE((found.on_first - found.on_second - found.distance * found.normal).norm(), tolerance) << where;
    ASSERT_NEAR((found.on_first - found.on_second).norm(), std::abs(found.distance), tolerance) << where;
    ASSERT_NEAR(from(first, found.on_first), Scalar(0), tolerance) << where;
    ASSERT_NEAR(from(second, found.on_second), Scalar(0), tolerance) << where;
  }

  /// The signed distance of convex shapes is the largest gap over all directions. If the distance of two points, one of
  /// each shape, equals the gap along the normal, the points and the normal are optimal.
  template <typename Second>
  void expect_widest_gap(const Nearest<Scalar>& found, const Capsule<Scalar>& first, const Second& second,
                         const std::string& where) {
    const Scalar tolerance = slack_of_normal(first, second);
    ASSERT_NEAR(gap(first, second, found.normal), found.distance, tolerance) << where;
    for (int k = 0; k < 40; ++k) {
      const auto share = static_cast<Scalar>(std::pow(10.0, random_.uniform(-6.0, 1.0)));
      const Vector3 n = (found.normal + share * vector()).normalized();
      ASSERT_LE(gap(first, second, n), found.distance + slack(first, second)) << where;
    }
  }

  /// Moving `first` by x along the normal changes the distance by x. Any other displacement changes the distance by at
  /// most its length, and at the rate normal · v.
  template <typename Second>
  void expect_slope(const Nearest<Scalar>& found, const Capsule<Scalar>& first, const Second& second,
                    const std::string& where) {
    const Scalar tolerance = slack(first, second);
    const Scalar displacement = size();
    const Vector3 v = direction();
    const Scalar away = nearest(moved(first, displacement * found.normal), second).distance;
    ASSERT_NEAR(away - found.distance, displacement, tolerance + 32 * kEpsilon * displacement) << where;
    const Scalar moved_by = nearest(moved(first, displacement * v), second).distance - found.distance;
    ASSERT_LE(std::abs(moved_by), displacement + tolerance + 32 * kEpsilon * displacement) << where;
    const Scalar h = std::cbrt(kEpsilon) * (extent(first) + extent(second));
    const Nearest<Scalar> after = nearest(moved(first, h * v), second);
    const Nearest<Scalar> before = nearest(moved(first, -h * v), second);
    const Scalar turn = (after.normal - before.normal).norm();
    if (turn > Scalar(0.1)) return;  // At an edge, the normal is discontinuous.
    ++smooth_;
    const Scalar slope = (after.distance - before.distance) / (2 * h);
    ASSERT_NEAR(slope, found.normal.dot(v), turn + tolerance / h) << where;
  }

  Random random_{17};
  int smooth_ = 0;
};

using Scalars = ::testing::Types<float, double>;
TYPED_TEST_SUITE(Distances, Scalars, );

constexpr int kTrials = 40000;

std::string case_of(int i) {
  return "case " + std::to_string(i);
}

TYPED_TEST(Distances, of_capsules_are_proved_by_points_and_normal) {
  for (int i = 0; i < trials(kTrials); ++i) {
    const auto [first, second] = this->capsules();
    const auto found = nearest(first, second);
    ASSERT_NO_FATAL_FAILURE(this->expect_consistent(found, first, second, case_of(i)));
    ASSERT_NO_FATAL_FAILURE(this->expect_widest_gap(found, first, second, case_of(i)));
  }
}

TYPED_TEST(Distances, of_a_capsule_and_a_box_are_proved_by_points_and_normal) {
  for (int i = 0; i < trials(kTrials); ++i) {
    const auto [first, second] = this->capsule_and_box();
    const auto found = nearest(first, second);
    ASSERT_NO_FATAL_FAILURE(this->expect_consistent(found, first, second, case_of(i)));
    ASSERT_NO_FATAL_FAILURE(this->expect_widest_gap(found, first, second, case_of(i)));
  }
}

TYPED_TEST(Distances, of_a_capsule_and_a_half_space_are_those_of_the_lowest_point) {
  using Scalar = TypeParam;
  for (int i = 0; i < trials(kTrials); ++i) {
    const auto first = this->capsule(this->segment());
    const HalfSpace<Scalar> second{this->chance(0.3) ? Vector<3, Scalar>::UnitZ() : this->direction(),
                                   this->size() * this->uniform(-1, 1)};
    const auto found = nearest(first, second);
    const Scalar lowest = std::min(this->from(second, first.a), this->from(second, first.b)) - first.radius;
    ASSERT_NO_FATAL_FAILURE(this->expect_consistent(found, first, second, case_of(i)));
    ASSERT_EQ(found.normal, second.normal) << i;
    ASSERT_NEAR(found.distance, lowest, this->slack(first, second)) << i;
    ASSERT_NO_FATAL_FAILURE(this->expect_slope(found, first, second, case_of(i)));
  }
}

/// Nested golden-section searches. The distance is convex in each parameter, so the result is the global minimum.
TYPED_TEST(Distances, of_capsules_are_the_least_over_both_cores) {
  using Scalar = TypeParam;
  const auto least = [](auto&& function) {
    constexpr auto kGolden = static_cast<Scalar>(0.6180339887498949);
    Scalar low(0);
    Scalar high(1);
    for (int k = 0; k < 50; ++k) {
      const Scalar left = high - kGolden * (high - low);
      const Scalar right = low + kGolden * (high - low);
      (function(left) < function(right) ? high : low) = function(left) < function(right) ? right : left;
    }
    return std::min({function(Scalar(0)), function(low), function(Scalar(1))});
  };
  for (int i = 0; i < trials(1000); ++i) {
    const auto [first, second] = this->capsules();
    const Segment<Scalar> core = first.core();
    const Capsule<Scalar> thin{second.a, second.b, Scalar(0)};
    const Scalar apart = least([&](Scalar s) { return this->from(thin, core.at(s)); });
    const Scalar distance = nearest(first, second).distance + first.radius + second.radius;
    // A search stops if the distance changes by no more than round-off error.
    ASSERT_NEAR(distance, apart, 4 * std::sqrt(this->kEpsilon) * (this->extent(first) + this->extent(second))) << i;
    ASSERT_LE(distance, apart + this->slack(first, second)) << i;
  }
}

TYPED_TEST(Distances, have_the_normal_as_their_gradient) {
  const int all = trials(kTrials);
  for (int i = 0; i < all; ++i) {
    const auto [first, second] = this->capsules();
    ASSERT_NO_FATAL_FAILURE(this->expect_slope(nearest(first, second), first, second, case_of(i)));
    const auto [capsule, box] = this->capsule_and_box();
    ASSERT_NO_FATAL_FAILURE(this->expect_slope(nearest(capsule, box), capsule, box, case_of(i)));
  }
  EXPECT_GT(this->smooth_, all / 2);
}

TYPED_TEST(Distances, are_the_same_from_both_sides) {
  for (int i = 0; i < trials(kTrials); ++i) {
    const auto [first, second] = this->capsules();
    const Capsule<TypeParam> turned{second.b, second.a, second.radius};
    const TypeParam distance = nearest(first, second).distance;
    ASSERT_NEAR(nearest(second, first).distance, distance, this->slack(first, second)) << i;
    ASSERT_NEAR(nearest(first, turned).distance, distance, this->slack(first, second)) << i;
  }
}

TYPED_TEST(Distances, stay_in_a_common_motion) {
  for (int i = 0; i < trials(kTrials); ++i) {
    const auto by = this->pose();
    const auto [first, second] = this->capsules();
    const TypeParam between = nearest(placed(first, by), placed(second, by)).distance;
    ASSERT_NEAR(between, nearest(first, second).distance, this->slack(first, second) + 32 * this->kEpsilon) << i;
    const auto [capsule, box] = this->capsule_and_box();
    const TypeParam to_box = nearest(placed(capsule, by), this->moved(box, by)).distance;
    ASSERT_NEAR(to_box, nearest(capsule, box).distance, this->slack(capsule, box) + 32 * this->kEpsilon) << i;
  }
}

/// All pairs of segments, and of a segment and a box, with integer coordinates: includes all coincidences.
TYPED_TEST(Distances, on_a_grid_are_proved_by_points_and_normal) {
  using Scalar = TypeParam;
  std::vector<Vector<3, Scalar>> grid;
  for (int i = 0; i < 27; ++i) grid.emplace_back(Scalar(i % 3 - 1), Scalar(i / 3 % 3 - 1), Scalar(i / 9 - 1));
  const Vector<3, Scalar> zero = Vector<3, Scalar>::Zero();
  for (const auto& a : grid) {
    for (const auto& b : grid) {
      const Capsule<Scalar> first{a, b, Scalar(0.5)};
      for (const auto& c : grid) {
        const Capsule<Scalar> second{zero, c, Scalar(0)};
        ASSERT_NO_FATAL_FAILURE(this->expect_consistent(nearest(first, second), first, second, "segments"));
        ASSERT_NO_FATAL_FAILURE(this->expect_widest_gap(nearest(first, second), first, second, "segments"));
        const Cuboid<Scalar> box{{}, Vector<3, Scalar>(c.cwiseAbs())};
        ASSERT_NO_FATAL_FAILURE(this->expect_consistent(nearest(first, box), first, box, "box"));
        ASSERT_NO_FATAL_FAILURE(this->expect_widest_gap(nearest(first, box), first, box, "box"));
      }
    }
  }
}

/// Sizes far below and far above the size of any robot: squares underflow, but the normal is a unit vector.
TYPED_TEST(Distances, have_a_unit_normal_at_every_size) {
  using Scalar = TypeParam;
  const Scalar least = std::numeric_limits<Scalar>::denorm_min();
  for (Scalar size = least; size < Scalar(1e12); size *= Scalar(3)) {
    for (int i = 0; i < trials(100); ++i) {
      const Vector<3, Scalar> a = size * this->vector();
      const Vector<3, Scalar> b = this->chance(0.2) ? a : Vector<3, Scalar>(size * this->vector());
      const Capsule<Scalar> first{a, b, Scalar(0)};
      const Capsule<Scalar> second{this->chance(0.2) ? a : Vector<3, Scalar>(size * this->vector()),
                                   this->chance(0.2) ? b : Vector<3, Scalar>(size * this->vector()), Scalar(0)};
      const Cuboid<Scalar> box{{}, size * this->vector().cwiseAbs()};
      for (const auto& found : {nearest(first, second), nearest(first, box)}) {
        ASSERT_NEAR(found.normal.norm(), Scalar(1), 8 * this->kEpsilon) << size;
        ASSERT_LE(std::abs(found.distance), Scalar(8) * size) << size;
        ASSERT_TRUE(found.on_first.allFinite() && found.on_second.allFinite()) << size;
      }
    }
  }
}

}  // namespace
}  // namespace fpbm::test::clearance_distance_laws
