#include "fpbm/limits/yield.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "fpbm/limits/level_least_squares.hpp"
#include "fpbm/limits/limiter.hpp"
#include "support/arms.hpp"
#include "support/random.hpp"

/// What replaces the direction of a task that is blocked: the first level's and a lower level's.
namespace fpbm::test::yield_laws {
namespace {

using Joints = Vector<7>;

/// A lower level of M rows below two others, in a random box with random rows.
template <int M>
struct Problem {
  Matrix<3, 7> above;
  Matrix<M, 7> J;
  Joints unit;
  Box<7> box;
  Rows<7, 3> rows;
  Joints from;
  Joints goal;
  Joints calm;

  explicit Problem(Random& random, double size)
      : above(random.uniform(3, 7, -1.0, 1.0)),
        J(random.uniform(M, 7, -1.0, 1.0)),
        unit(random.uniform(7, 0.5, 2.0)),
        box{random.uniform(7, -2.0, -0.1), random.uniform(7, 0.1, 2.0)},
        rows{random.uniform(7, 3, -1.0, 1.0), random.uniform(3, 0.1, 1.0), 3},
        from(Joints::Zero()),
        goal(size * Joints(random.uniform(7, -1.0, 1.0))),
        calm(random.uniform(7, -0.5, 0.5)) {}

  [[nodiscard]] auto basis() const {
    LevelSpace<7> space(7);
    space.add(scaled(above));
    return space.basis();
  }
  template <int K>
  [[nodiscard]] Matrix<K, 7> scaled(const Matrix<K, 7>& A) const {
    return A * unit.asDiagonal();
  }
  [[nodiscard]] Joints solve() const {
    return level_least_squares(basis(), scaled(J), unit, box, rows, from, goal, calm, 0.1);
  }
  /// What is to be small, in units.
  [[nodiscard]] double cost(const Joints& u) const {
    const double mu = 0.01 * scaled(J).squaredNorm();
    const Joints free = basis() * (basis().transpose() * (u - calm).cwiseQuotient(unit));
    return (J * (goal - u)).squaredNorm() + mu * free.squaredNorm();
  }
  [[nodiscard]] bool admits(const Joints& u) const { return box.contains(u) && rows.admit(u); }
};

/// The motion changes no higher level, is within all bounds, and no other such motion near it is much better.
template <int M>
void expect_least_squares() {
  Random random(M);
  double disturbed = 0.0;
  double mean = 0.0;
  for (int trial = 0; trial < trials(300); ++trial) {
    const Problem<M> problem(random, trial % 3 == 0 ? 0.2 : 3.0);
    const Joints u = problem.solve();
    disturbed = std::max(disturbed, (problem.above * u).norm());
    for (Eigen::Index i = 0; i < 7; ++i) {
      EXPECT_LE(u(i), problem.box.upper(i) + 1e-12);
      EXPECT_GE(u(i), problem.box.lower(i) - 1e-12);
    }
    for (int k = 0; k < 3; ++k) EXPECT_LE(problem.rows.excess(k, u), 1e-12);
    const double cost = problem.cost(u);
    const double start = problem.cost(problem.from);
    EXPECT_LE(cost, start + 1e-12);
    const auto Z = problem.basis();
    double gained = 0.0;
    for (int other = 0; other < 200; ++other) {
      const double length = std::pow(10.0, random.uniform(-3.0, 0.0));
      const Joints step = problem.unit.cwiseProduct(Joints(Z * random.uniform(Z.cols(), -length, length)));
      if (!problem.admits(u + step)) continue;
      gained = std::max(gained, (cost - problem.cost(u + step)) / start);
    }
    mean += gained / trials(300);
  }
  std::printf("%d rows: higher levels disturbed by %.1e; a share of %.1e of the cost could be gained\n", M, disturbed,
              mean);
  EXPECT_LE(disturbed, 1e-12);
  EXPECT_LE(mean, 0.02);
}
TEST(LevelLeastSquares, is_near_the_optimum_within_bounds) {
  expect_least_squares<1>();
  expect_least_squares<3>();
  expect_least_squares<7>();
}

/// Without active bounds, it is the damped least squares.
TEST(LevelLeastSquares, is_the_damped_least_squares_without_bounds) {
  Random random(9);
  for (int trial = 0; trial < 50; ++trial) {
    Problem<3> problem(random, 0.2);
    problem.box = {Joints::Constant(-1e3), Joints::Constant(1e3)};
    problem.rows.count = 0;
    const auto Z = problem.basis();
    const Matrix<3, 7> J = problem.scaled(problem.J);
    const Eigen::MatrixXd A = J * Z;
    const double mu = 0.01 * J.squaredNorm();
    const Eigen::VectorXd right =
        A.transpose() * (problem.J * problem.goal) + mu * (Z.transpose() * problem.calm.cwiseQuotient(problem.unit));
    const Eigen::MatrixXd H = A.transpose() * A + mu * Eigen::MatrixXd::Identity(A.cols(), A.cols());
    const Eigen::VectorXd y = H.inverse() * right;
    EXPECT_LE((problem.solve() - problem.unit.cwiseProduct(Joints(Z * y))).norm(), 1e-10);
  }
}

/// A demand far beyond the bounds keeps its direction, however large, where the posture does not lose the direction.
template <Level kLevel>
void expect_direction() {
  const auto limits = Limits<kLevel, 7>(SerialArm<7>(presets::panda()).limits(), 1e-3);
  const Limiter<kLevel, 7> limiter(limits);
  const SerialArm<7> arm(presets::panda());
  const Joints q{0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785};
  Kinematics<Position<3>, 7> kinematics;
  arm.kinematics(q, Joints(Joints::Zero()), kinematics);
  const State<7> state{q, Joints::Zero()};
  Random random(4);
  double worst = 0.0;
  double least = 1.0;
  int kept = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const Vector<3> direction = random.uniform(3, -1.0, 1.0);
    for (const double size : {10.0, 100.0, 1000.0, 10000.0}) {
      const Joints desired =
          size * Joints(kinematics.J.transpose() * (kinematics.J * kinematics.J.transpose()).inverse() * direction);
      const auto found = limiter.motion(kinematics.J, state, desired);
      const Vector<3> moved = kinematics.J * found.u;
      const double angle = (moved.normalized() - direction.normalized()).norm();
      worst = std::max(worst, angle);
      kept += angle < 1e-9 ? 1 : 0;
      least = std::min(least, found.scale);
    }
  }
  std::printf("%d of 800 keep their direction, largest angle %.1e rad, least scale %.1e\n", kept, worst, least);
  EXPECT_GE(kept, 790);
  EXPECT_LT(least, 1e-3);
}
TEST(Yield, keeps_the_direction_of_a_large_demand) {
  expect_direction<Level::kAcceleration>();
  expect_direction<Level::kVelocity>();
}

}  // namespace
}  // namespace fpbm::test::yield_laws
