#include "fpbm/geometry/detail/sincos.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "support/random.hpp"

namespace fpbm::test::sincos_laws {
namespace {

constexpr long double kHalfPi = 1.57079632679489661923132169163975144L;

/// Sine and cosine of the angle minus k quarter turns, with π/2 in three parts, because the long double functions of
/// some systems (mingw-w64) lose digits at large angles. The first two parts are doubles of 33 bits, which are exact in
/// every long double, also multiplied by k.
SinCos<long double> reference(double angle) {
  const auto k = static_cast<long double>(std::lround(angle / static_cast<double>(kHalfPi)));
  const long double r =
      ((angle - k * 1.57079632673412561417e+00) - k * 6.07710050630396597660e-11) - k * 2.02226624879595063154e-21L;
  const long double sine = std::sin(r);
  const long double cosine = std::cos(r);
  switch (static_cast<int>(k) & 3) {
    case 0: return {sine, cosine};
    case 1: return {cosine, -sine};
    case 2: return {-sine, -cosine};
    default: return {-cosine, sine};
  }
}

/// Largest absolute error of the sine and cosine of an angle, alone and as the first entry of a vector.
double error_at(double angle) {
  const SinCos<double> alone = sincos(angle);
  const Vector<3> angles(angle, 0.5, -1.0);
  Vector<3> sines;
  Vector<3> cosines;
  sincos(angles, sines, cosines);
  EXPECT_EQ(alone.sin, sines(0));
  EXPECT_EQ(alone.cos, cosines(0));
  const long double exact = angle;
  const auto [sine, cosine] = std::abs(angle) <= ReducedSinCos::kReach
                                  ? reference(angle)
                                  : SinCos<long double>{std::sin(exact), std::cos(exact)};
  return static_cast<double>(std::max(std::abs(sine - alone.sin), std::abs(cosine - alone.cos)));
}

double worst_over(double range, int samples) {
  Random random(7);
  double worst = 0.0;
  for (int i = 0; i < samples; ++i) {
    // Two random numbers: Random returns floats, whose 24 bits would leave the low bits of an angle zero.
    const double angle = random.uniform(-range, range) + random.uniform(-1.0, 1.0) * 1e-7 * range;
    worst = std::max(worst, error_at(std::clamp(angle, -range, range)));
  }
  return worst;
}

TEST(SinCos, is_exact_to_round_off_within_its_range) {
  for (const double range : {1e-8, 0.1, 0.8, 1.6, 4.0, 10.0, 1e3, 1e5, ReducedSinCos::kReach}) {
    EXPECT_LE(worst_over(range, 50000), 2e-16) << "range " << range;
  }
  for (const double angle : {0.0, -0.0, 5e-324, 1e-300, ReducedSinCos::kReach, -ReducedSinCos::kReach}) {
    EXPECT_LE(error_at(angle), 2e-16) << angle;
  }
}

/// At these angles, the reduction has the largest cancellation, and the quadrant changes.
TEST(SinCos, is_exact_at_multiples_of_a_quarter_turn) {
  double worst = 0.0;
  for (int k = -318000; k <= 318000; k += 7) {
    for (const long double offset : {-0.5L, 0.0L, 0.5L}) {
      const auto angle = static_cast<double>((k + offset) * kHalfPi);
      const double above = std::nextafter(angle, 1e9);
      worst = std::max({worst, error_at(angle), error_at(above)});
    }
  }
  EXPECT_LE(worst, 2e-16);
}

TEST(SinCos, uses_the_standard_functions_beyond_its_range) {
  for (const double angle : {std::nextafter(ReducedSinCos::kReach, 1e9), 1e6, -1e9, 1e15, 1e300}) {
    EXPECT_LE(error_at(angle), 2e-16) << angle;
  }
  // If one angle is out of range, the slow code computes the whole vector, with the same round-off error.
  const Vector<3> angles(1.0, 1e9, -2.0);
  Vector<3> sines;
  Vector<3> cosines;
  sincos(angles, sines, cosines);
  for (Eigen::Index i = 0; i < 3; ++i) {
    EXPECT_NEAR(sines(i), std::sin(angles(i)), 2e-16);
    EXPECT_NEAR(cosines(i), std::cos(angles(i)), 2e-16);
  }
}

template <typename Scalar>
void expect_nan_of(Scalar bad) {
  EXPECT_TRUE(std::isnan(sincos(bad).sin));
  EXPECT_TRUE(std::isnan(sincos(bad).cos));
  for (Eigen::Index at = 0; at < 4; ++at) {
    Vector<4, Scalar> angles(Scalar(0.1), Scalar(0.2), Scalar(0.3), Scalar(0.4));
    angles(at) = bad;
    Vector<4, Scalar> sines;
    Vector<4, Scalar> cosines;
    sincos(angles, sines, cosines);
    for (Eigen::Index i = 0; i < 4; ++i) {
      EXPECT_EQ(std::isnan(sines(i)), i == at) << bad << " at " << at << ", entry " << i;
      EXPECT_EQ(std::isnan(cosines(i)), i == at) << bad << " at " << at << ", entry " << i;
    }
  }
}

TEST(SinCos, of_entries_that_are_not_finite_are_nan_in_those_entries_only) {
  expect_nan_of(std::numeric_limits<double>::quiet_NaN());
  expect_nan_of(std::numeric_limits<double>::infinity());
  expect_nan_of(-std::numeric_limits<double>::infinity());
  expect_nan_of(std::numeric_limits<float>::quiet_NaN());
  expect_nan_of(std::numeric_limits<float>::infinity());
}

double float_error_at(float angle) {
  const SinCos<float> pair = sincos(angle);
  const auto exact = static_cast<double>(angle);
  return std::max(std::abs(pair.sin - std::sin(exact)), std::abs(pair.cos - std::cos(exact)));
}

TEST(SinCos, of_float_is_exact_to_round_off) {
  Random random(3);
  double worst = 0.0;
  for (const double range : {1e-6, 0.8, 1.6, 4.0, 100.0, 1000.0, 8192.0, 1e6}) {
    for (int i = 0; i < 100000; ++i) {
      worst = std::max(worst, float_error_at(static_cast<float>(random.uniform(-range, range))));
    }
  }
  for (int k = -5200; k <= 5200; ++k) {  // Here, the reduction has the largest cancellation, and the quadrant changes.
    for (const double offset : {-0.5, 0.0, 0.5}) {
      worst = std::max(worst, float_error_at(static_cast<float>((k + offset) * static_cast<double>(kHalfPi))));
    }
  }
  for (const float angle : {0.0F, -0.0F, 1e-45F, 1e-38F, FloatSinCos::kReach, -FloatSinCos::kReach}) {
    worst = std::max(worst, float_error_at(angle));
  }
  EXPECT_LE(worst, 6.1e-8);
  EXPECT_EQ(sincos(1e-30F).sin, 1e-30F);
}

TEST(SinCos, accepts_any_number_of_angles) {
  for (const Eigen::Index n : {1, 2, 5, 17, 32}) {
    const Vector<Eigen::Dynamic> angles = Vector<Eigen::Dynamic>::LinSpaced(n, -3.0, 40.0);
    Vector<Eigen::Dynamic> sines;
    Vector<Eigen::Dynamic> cosines;
    sincos(angles, sines, cosines);
    ASSERT_EQ(sines.size(), n);
    ASSERT_EQ(cosines.size(), n);
    EXPECT_LE((sines.array() - angles.array().sin()).abs().maxCoeff(), 4e-16);
    EXPECT_LE((cosines.array() - angles.array().cos()).abs().maxCoeff(), 4e-16);
  }
}

}  // namespace
}  // namespace fpbm::test::sincos_laws
