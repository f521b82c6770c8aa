#include "fpbm/simulate/detail/rk4.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support/paper.hpp"
#include "support/recording.hpp"

namespace fpbm::test::rk4_laws {
namespace {

/// Exponent p of error = C hᵖ, from errors at h and h/2.
double order(double coarse, double fine) {
  return std::log2(coarse / fine);
}

/// ẋ = x cos t, ẏ = −y cos t from (1, 1): x = exp(sin t), y = exp(−sin t).
Status swing(double t, const Vector<2>& x, Vector<2>& dx) noexcept {
  dx = std::cos(t) * Vector<2>(x(0), -x(1));
  return Status::kOk;
}

double error_of_swing(int steps) {
  const double h = 3.0 / steps;
  Vector<2> x = Vector<2>::Ones();
  for (int i = 0; i < steps; ++i) EXPECT_EQ(RK4::step(swing, i * h, h, x), Status::kOk);
  return (x - Vector<2>(std::exp(std::sin(3.0)), std::exp(-std::sin(3.0)))).norm();
}

TEST(RK4, is_of_order_four) {
  for (const int steps : {40, 80, 160}) {
    EXPECT_NEAR(order(error_of_swing(steps), error_of_swing(2 * steps)), 4.0, 0.1) << steps << " steps";
  }
}

State<4> end_of_circle(int steps) {
  const TimeGrid<> grid(kDuration, kDuration / steps);
  return recorded(paper_arm(), paper_circle(), paper_fpbm(), paper_start(), grid).result.last;
}

TEST(RK4, is_of_order_four_in_a_rollout) {
  const State<4> exact = end_of_circle(8000);
  const auto error = [&](int steps) { return (end_of_circle(steps).q - exact.q).norm(); };
  EXPECT_NEAR(order(error(200), error(400)), 4.0, 0.1);
  EXPECT_NEAR(order(error(400), error(800)), 4.0, 0.1);
}

TEST(RK4, takes_the_first_slope_as_given_or_evaluates_it) {
  Vector<2> x(1.5, -0.5);
  Vector<2> y = x;
  Vector<2> slope;
  ASSERT_EQ(swing(0.25, x, slope), Status::kOk);
  ASSERT_EQ(RK4::step(swing, 0.25, 0.125, slope, x), Status::kOk);
  ASSERT_EQ(RK4::step(swing, 0.25, 0.125, y), Status::kOk);
  EXPECT_EQ(x, y);
}

TEST(RK4, leaves_x_untouched_when_a_stage_fails) {
  for (int failing = 1; failing <= 4; ++failing) {
    const Vector<2> before(1.5, -0.5);
    Vector<2> x = before;
    int evaluations = 0;
    const auto derivative = [&](double t, const Vector<2>& at, Vector<2>& dx) noexcept {
      static_cast<void>(swing(t, at, dx));
      return ++evaluations == failing ? Status::kSingular : Status::kOk;
    };
    EXPECT_EQ(RK4::step(derivative, 0.0, 0.1, x), Status::kSingular);
    EXPECT_EQ(evaluations, failing);
    EXPECT_EQ(x, before) << "stage " << failing;
  }
}

TEST(RK4, evaluates_at_the_ends_and_twice_in_the_middle) {
  double times[4] = {};
  int evaluations = 0;
  float x = 1.0F;
  const auto derivative = [&](float t, float at, float& dx) noexcept {
    times[evaluations++] = static_cast<double>(t);
    dx = at;
    return Status::kOk;
  };
  ASSERT_EQ(RK4::step(derivative, 2.0F, 0.5F, x), Status::kOk);
  ASSERT_EQ(evaluations, 4);
  EXPECT_EQ(times[0], 2.0);
  EXPECT_EQ(times[1], 2.25);
  EXPECT_EQ(times[2], 2.25);
  EXPECT_EQ(times[3], 2.5);
  // The Taylor series of eʰ up to h⁴, in float.
  EXPECT_NEAR(x, 1.0 + 0.5 + 0.125 + 0.125 / 6.0 + 0.0625 / 24.0, 2e-7);
}

}  // namespace
}  // namespace fpbm::test::rk4_laws
