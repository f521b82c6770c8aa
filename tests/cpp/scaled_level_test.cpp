#include "fpbm/singular/scaled_level.hpp"

#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>

#include "fpbm/model/presets.hpp"
#include "fpbm/model/robot.hpp"
#include "fpbm/realtime/stack_tracker.hpp"
#include "fpbm/scheme/schemes.hpp"
#include "fpbm/task/axis_task.hpp"
#include "fpbm/task/position_task.hpp"
#include "fpbm/task/posture_task.hpp"
#include "support/random.hpp"

/// Scaled rows of a lower level: a singular value is the part of a direction that the higher levels do not use.
namespace fpbm::test {
namespace {

constexpr double kPosture = 0.3;  ///< ρ

[[nodiscard]] Eigen::VectorXd singular_values(const Eigen::MatrixXd& A) {
  return Eigen::JacobiSVD<Eigen::MatrixXd>(A).singularValues();
}

/// For several sizes, units and singular postures.
template <int M, int N>
void expect_scaled(Eigen::Index m, Eigen::Index n) {
  for (int seed = 0; seed < trials(200); ++seed) {
    Random random(static_cast<std::uint32_t>(seed));
    Matrix<M, N> J(m, n);
    for (Eigen::Index i = 0; i < m; ++i) J.row(i) = random.uniform(n, -1.0, 1.0).transpose();
    if (seed % 3 == 0 && m > 1) J.row(0) = J.row(m - 1) * (1.0 + 1e-6 * random.uniform(-1.0, 1.0));
    J *= std::pow(10.0, random.uniform(-3.0, 3.0));
    const Vector<M> r = J * random.uniform(n, -1.0, 1.0);
    const ScaledLevel<M, N, double> level(J, r);
    const Eigen::VectorXd before = singular_values(J);
    const Eigen::VectorXd after = singular_values(level.J);
    for (Eigen::Index i = 0; i < m; ++i) {
      const double expected = before(i) / std::hypot(before(i), kPosture * J.norm());
      EXPECT_NEAR(after(i), expected, 1e-9) << m << " x " << n << ", seed " << seed;
    }
    const Eigen::VectorXd u = J.completeOrthogonalDecomposition().solve(r);  // Solves J u = r.
    EXPECT_LT((level.J * u - level.r).norm(), 1e-9 * (1.0 + u.norm()));
  }
}

TEST(ScaledLevel, has_the_singular_values_of_its_docstring) {
  expect_scaled<1, 7>(1, 7);
  expect_scaled<3, 7>(3, 7);
  expect_scaled<6, 14>(6, 14);
  expect_scaled<Eigen::Dynamic, Eigen::Dynamic>(2, 4);
  expect_scaled<Eigen::Dynamic, Eigen::Dynamic>(6, 24);
}

/// A diagonal level needs no factor, and its result does not depend on the order of the rows.
TEST(ScaledLevel, of_a_posture_does_not_depend_on_the_order_of_rows) {
  Random random(1);
  const Vector<7> entries = random.uniform(7, 0.5, 1.5);
  const Vector<7> r = random.uniform(7, -1.0, 1.0);
  const Matrix<7, 7> posture = entries.asDiagonal();
  const Matrix<7, 7> reversed = posture.colwise().reverse();
  const Vector<7> reversed_r = r.reverse();
  const ScaledLevel<7, 7, double> level(posture, r);
  const ScaledLevel<7, 7, double> other(reversed, reversed_r);
  EXPECT_LT((level.J - Matrix<7, 7>(other.J.colwise().reverse())).norm(), 1e-12);
  EXPECT_LT((level.r - Vector<7>(other.r.reverse())).norm(), 1e-12);
}

/// Rows that are zero or not finite do not change.
TEST(ScaledLevel, leaves_rows_without_a_factor) {
  Matrix<2, 7> J = Matrix<2, 7>::Zero();
  EXPECT_EQ((ScaledLevel<2, 7, double>(J, Vector<2>(1.0, 2.0)).r), Vector<2>(1.0, 2.0));
  J(0, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ((ScaledLevel<2, 7, double>(J, Vector<2>(1.0, 2.0)).r), Vector<2>(1.0, 2.0));
}

/// A position below the axis of the tip of a Panda jumps or moves out of the workspace, and returns.
TEST(ScaledLevel, a_position_is_reached_again) {
  constexpr int kTip = Robot<7>::kTip;
  const Robot<7> robot(presets::panda());
  const TaskGains<> gains(10.0, 25.0);
  const Stack stack(AxisTask<>{{kTip}, gains}, PositionTask<>{{kTip}, gains}, PositionTask<1>{{4}, gains, {2}},
                    PostureTask<7>{TaskGains<>(4.0, 4.0)});
  const auto scheme =
      Balanced<7>(0.6, DiagonalWeights<7>(Vector<7>(Vector<7>::Ones())), NullSpace<7>().with_damping(2.0));
  const int count = trials(120, 12);
  int reached = 0;
  for (int seed = 0; seed < count; ++seed) {
    Random random(static_cast<std::uint32_t>(seed));
    Vector<7> q0{0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785};
    for (Eigen::Index i = 0; i < 7; ++i) q0(i) += random.uniform(-0.3, 0.3);
    auto tracker = stack_tracker(robot, stack, scheme, q0);
    auto target = decltype(tracker)::Target::hold(tracker.tip());
    Vector<3>& place = std::get<1>(target.x);
    const Vector<3> home = place;
    Vector<3> out = random.uniform(3, -1.0, 1.0);
    out *= random.uniform(0.6, 1.2) / out.norm();
    const int ramp = random.uniform(0.0, 1.0) < 0.5 ? 1 : 3000;
    const auto go = [&](const Vector<3>& to, int ticks) {
      const Vector<3> from = place;
      for (int k = 1; k <= ticks; ++k) {
        place = from + (to - from) * std::min(1.0, static_cast<double>(k) / ramp);
        (void)tracker.tick(target);
      }
    };
    go(home + out, 8000);
    go(home, 10000);
    reached += (std::get<1>(tracker.tip()) - home).norm() < 1e-3 ? 1 : 0;
  }
  std::printf("%d of %d positions are reached again\n", reached, count);
  EXPECT_GE(reached, count - std::max(count / 12, 2));
}

}  // namespace
}  // namespace fpbm::test
