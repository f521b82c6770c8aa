#include "fpbm/path/path.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <ostream>
#include <string>
#include <type_traits>
#include <vector>

#include "support/paper.hpp"

namespace fpbm::test::path_laws {
namespace {

using Sample2 = Reference<Position<2>>;

/// A type-erased shape with a time law, in the Scalar under test and in double.
struct ErasedPath {
  std::string name;
  bool closed;
  double epsilon;
  std::function<Sample2(double)> sample;
  std::function<Sample2(double)> sample_in_double;
};

void PrintTo(const ErasedPath& path, std::ostream* out) {
  *out << path.name;
}

constexpr double kT = 7.0;

template <typename Shape, typename Law>
std::function<Sample2(double)> sampler(const Shape& shape) {
  using Scalar = typename Shape::Scalar;
  const Path<Shape, Law> path(shape, static_cast<Scalar>(kT));
  return [path](double t) -> Sample2 {
    const auto at = path.sample(static_cast<Scalar>(t));
    return {at.x.template cast<double>(), at.xd.template cast<double>(), at.xdd.template cast<double>()};
  };
}

template <typename Scalar, typename Law>
void add_shapes(const std::string& law, std::vector<ErasedPath>& paths) {
  const auto add = [&](const char* shape_name, bool closed, auto make) {
    const bool is_float = std::is_same_v<Scalar, float>;
    paths.push_back({std::string(shape_name) + "_" + law + (is_float ? "_float" : ""), closed,
                     static_cast<double>(std::numeric_limits<Scalar>::epsilon()),
                     sampler<decltype(make(Scalar())), Law>(make(Scalar())),
                     sampler<decltype(make(double())), Law>(make(double()))});
  };
  add("circle", true, [](auto zero) { return Circle<decltype(zero)>(decltype(zero)(0.5)); });
  add("lissajous", true, [](auto zero) {
    using S = decltype(zero);
    return Lissajous<S>({S(0.5), S(0.25)}, {2, 3}, S(0.75));
  });
  add("tricuspid", true, [](auto zero) { return Tricuspid<decltype(zero)>(decltype(zero)(0.25)); });
  add("line", false, [](auto zero) {
    using S = decltype(zero);
    return Line<2, S>({S(0.5), S(-1.25)});
  });
}

std::vector<ErasedPath> paths() {
  std::vector<ErasedPath> all;
  add_shapes<double, SinSquared>("sin_squared", all);
  add_shapes<double, Quintic>("quintic", all);
  add_shapes<double, ConstantSpeed>("constant_speed", all);
  add_shapes<float, SinSquared>("sin_squared", all);
  add_shapes<float, Quintic>("quintic", all);
  add_shapes<float, ConstantSpeed>("constant_speed", all);
  return all;
}

class Paths : public ::testing::TestWithParam<ErasedPath> {
 protected:
  static constexpr double kSteep = 20.0;  ///< Upper bound on the slopes of the shapes above with respect to s [m].
};

TEST_P(Paths, have_xd_and_xdd_as_derivatives) {
  const auto& sample = GetParam().sample_in_double;
  constexpr double kStep = 1e-5;
  for (double t = 0.01; t < kT; t += 0.0937) {
    const Sample2 at = sample(t);
    EXPECT_LE((at.xd - (sample(t + kStep).x - sample(t - kStep).x) / (2.0 * kStep)).norm(), 1e-8) << "t = " << t;
    EXPECT_LE((at.xdd - (sample(t + kStep).xd - sample(t - kStep).xd) / (2.0 * kStep)).norm(), 1e-8) << "t = " << t;
  }
}

TEST_P(Paths, are_the_same_in_every_scalar) {
  for (double t = -1.0; t < kT + 1.0; t += 0.125) {
    const Sample2 at = GetParam().sample(t);
    const Sample2 expected = GetParam().sample_in_double(t);
    const double round_off = 16.0 * GetParam().epsilon;
    // The round-off error of s is the largest, and each derivative of a shape is steeper than the previous derivative.
    EXPECT_LE((at.x - expected.x).norm(), round_off * kSteep) << "t = " << t;
    EXPECT_LE((at.xd - expected.xd).norm(), round_off * kSteep) << "t = " << t;
    EXPECT_LE((at.xdd - expected.xdd).norm(), round_off * kSteep * kSteep / kT) << "t = " << t;
  }
}

TEST_P(Paths, start_where_the_tip_is) {
  EXPECT_LE(GetParam().sample(0.0).x.norm(), 4.0 * GetParam().epsilon);
}

TEST_P(Paths, close_if_their_shape_does) {
  const double displacement = GetParam().sample(kT).x.norm();
  if (GetParam().closed) {
    EXPECT_LE(displacement, 32.0 * GetParam().epsilon);
  } else {
    EXPECT_NEAR(displacement, std::hypot(0.5, 1.25), 4.0 * GetParam().epsilon);
  }
}

TEST_P(Paths, hold_at_rest_outside_their_time) {
  const Vector<2> end = GetParam().sample(kT).x;
  for (const double t : {kT * 1.0001, kT + 1.0, 1e6}) {
    const Sample2 at = GetParam().sample(t);
    EXPECT_LE((at.x - end).norm(), 8.0 * GetParam().epsilon) << "t = " << t;
    EXPECT_EQ(at.xd, Vector<2>::Zero()) << "t = " << t;
    EXPECT_EQ(at.xdd, Vector<2>::Zero()) << "t = " << t;
  }
  for (const double t : {-1e-6, -1.0}) {
    const Sample2 at = GetParam().sample(t);
    EXPECT_EQ(at.x, GetParam().sample(0.0).x) << "t = " << t;
    EXPECT_EQ(at.xd, Vector<2>::Zero()) << "t = " << t;
    EXPECT_EQ(at.xdd, Vector<2>::Zero()) << "t = " << t;
  }
}

INSTANTIATE_TEST_SUITE_P(every, Paths, ::testing::ValuesIn(paths()), [](const auto& each) { return each.param.name; });

/// The paths as printed in the paper, with φ(t) = 2π sin²(πt / 2T).
TEST(PaperPaths, are_the_papers_formulas) {
  for (double t = 0.0; t <= kDuration; t += 0.0625) {
    const double phi = 2.0 * kPi * std::pow(std::sin(kPi * t / (2.0 * kDuration)), 2);
    const Vector<2> circle(0.45 * (std::cos(phi) - 1.0), 0.45 * std::sin(phi));
    const Vector<2> lissajous(0.4 * (std::cos(2.0 * phi + kPi / 6.0) - std::cos(kPi / 6.0)),
                              0.4 * (std::sin(phi + kPi / 6.0) - std::sin(kPi / 6.0)));
    const Vector<2> tricuspid(0.3 * (2.0 * std::cos(phi) + std::cos(2.0 * phi) - 3.0),
                              0.3 * (2.0 * std::sin(phi) - std::sin(2.0 * phi)));
    EXPECT_LE((paper_circle().sample(t).x - circle).norm(), 2e-15) << "t = " << t;
    EXPECT_LE((paper_lissajous().sample(t).x - lissajous).norm(), 2e-15) << "t = " << t;
    EXPECT_LE((paper_tricuspid().sample(t).x - tricuspid).norm(), 4e-15) << "t = " << t;
  }
}

template <typename Law>
void expect_ends(double speed, double first_acceleration, double last_acceleration) {
  const Phase<double> first = Law::at(0.0);
  const Phase<double> last = Law::at(1.0);
  EXPECT_NEAR(first.s, 0.0, 1e-16);
  EXPECT_NEAR(last.s, 1.0, 1e-15);
  EXPECT_NEAR(first.sd, speed, 1e-15);
  EXPECT_NEAR(last.sd, speed, 1e-15);
  EXPECT_NEAR(first.sdd, first_acceleration, 1e-14);
  EXPECT_NEAR(last.sdd, last_acceleration, 1e-14);
}

TEST(TimeLaws, have_their_documented_end_derivatives) {
  expect_ends<SinSquared>(0.0, kPi * kPi / 2.0, -kPi * kPi / 2.0);
  expect_ends<Quintic>(0.0, 0.0, 0.0);
  expect_ends<ConstantSpeed>(1.0, 0.0, 0.0);
}

}  // namespace
}  // namespace fpbm::test::path_laws
