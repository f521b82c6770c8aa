#include "fpbm/limits/level_saturation.hpp"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include "support/linear_program.hpp"
#include "support/random.hpp"

/// Tasks in strict priority within a box: each task scale is the largest possible, no level disturbs a higher level,
/// and no bound is exceeded.
namespace fpbm::test::level_saturation_laws {
namespace {

struct Level {
  Eigen::MatrixXd J;
  Eigen::VectorXd b;
};

struct Problem {
  Eigen::VectorXd lower;
  Eigen::VectorXd upper;
  Eigen::VectorXd rest;
  std::vector<Level> levels;
  Eigen::MatrixXd G = {};
  Eigen::VectorXd most = {};
};

/// Levels as in SNS-IK's test of several tasks (runTest_snsIk_acc_mt.m): of motions within the box, of which two in
/// five are too large by a factor of up to ten. odd: with rows that are zero, repeat or depend on other rows, and with
/// level sizes from 1e-4 to 1e4.
[[nodiscard]] Problem random_problem(Random& random, Eigen::Index n, int levels, bool odd) {
  Problem problem;
  problem.lower = random.uniform(n, -1.1, -0.1);
  problem.upper = random.uniform(n, 0.1, 1.1);
  problem.rest = random.uniform(n, -0.1, 0.1);
  for (Eigen::Index i = 0; i < n; ++i) {
    if (random.uniform(0.0, 1.0) < 0.1) problem.rest(i) = problem.lower(i);
  }
  for (int k = 0; k < levels; ++k) {
    const auto m =
        static_cast<Eigen::Index>(random.uniform(1.0, static_cast<double>(std::min<Eigen::Index>(n, 6)) + 0.999));
    Level level{Eigen::MatrixXd(m, n), {}};
    for (Eigen::Index i = 0; i < m; ++i) level.J.row(i) = random.uniform(n, -1.0, 1.0).transpose();
    if (odd) {
      const double draw = random.uniform(0.0, 1.0);
      if (draw < 0.2) level.J.row(0).setZero();
      if (draw > 0.8 && m > 1) level.J.row(0) = 2.0 * level.J.row(m - 1);
      if (draw > 0.4 && draw < 0.6 && k > 0) level.J.row(0) = problem.levels[0].J.row(0);
      level.J *= std::pow(10.0, random.uniform(-4.0, 4.0));
    }
    Eigen::VectorXd u(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      u(i) = random.uniform(problem.lower(i), problem.upper(i));
      const double draw = random.uniform(0.0, 1.0);
      if (draw < 0.1) u(i) = problem.lower(i);
      if (draw > 0.9) u(i) = problem.upper(i);
    }
    level.b = level.J * u;
    if (random.uniform(0.0, 1.0) < 0.4) level.b /= random.uniform(0.1, 0.9);
    problem.levels.push_back(level);
  }
  return problem;
}

constexpr int kMostRows = 4;

struct Answer {
  std::vector<Eigen::VectorXd> u;  ///< After each level.
  std::vector<double> scale;
};

template <int N, typename Scalar, int P>
[[nodiscard]] Answer answer_as(const Problem& problem) {
  const auto cast = [](const Eigen::VectorXd& v) { return Vector<N, Scalar>(v.cast<Scalar>()); };
  Rows<N, P, Scalar> rows;
  if constexpr (P > 0) {
    rows.g.setZero(problem.rest.size(), P);
    rows.count = problem.most.size();
    rows.g.leftCols(rows.count) = problem.G.transpose().cast<Scalar>();
    rows.b.head(rows.count) = problem.most.cast<Scalar>();
  }
  LevelSaturation<N, Scalar, P> saturation({cast(problem.lower), cast(problem.upper)}, cast(problem.rest),
                                           cast((problem.upper - problem.lower) / 2.0), rows);
  Answer answer;
  for (const Level& level : problem.levels) {
    const Matrix<Eigen::Dynamic, N, Scalar> J = level.J.cast<Scalar>();
    const Vector<Eigen::Dynamic, Scalar> b = level.b.cast<Scalar>();
    answer.scale.push_back(static_cast<double>(saturation.resolve(J, b)));
    answer.u.emplace_back(saturation.motion().template cast<double>());
  }
  return answer;
}

[[nodiscard]] Answer answer(const Problem& problem) {
  if (problem.most.size() > 0) return answer_as<Eigen::Dynamic, double, kMostRows>(problem);
  if (problem.rest.size() == 7) return answer_as<7, double, 0>(problem);
  return answer_as<Eigen::Dynamic, double, 0>(problem);
}

/// The desired motion of a level after u, by Eigen's decompositions; the rows of all levels up to this level; and
/// whether the level is feasible without bounds.
struct Asked {
  Eigen::VectorXd desired;
  Eigen::MatrixXd all;
  bool possible;
};

[[nodiscard]] Asked asked(const Problem& problem, std::size_t k, const Eigen::VectorXd& u) {
  const Eigen::Index n = u.size();
  const Eigen::VectorXd unit = (problem.upper - problem.lower) / 2.0;
  Eigen::MatrixXd all(0, n);
  const auto add = [&](const Eigen::MatrixXd& rows) {  // Unit rows, so that one threshold applies to all rows.
    for (Eigen::Index i = 0; i < rows.rows(); ++i) {
      const double length = rows.row(i).norm();
      if (length == 0.0) continue;
      all.conservativeResize(all.rows() + 1, n);
      all.bottomRows(1) = rows.row(i) / length;
    }
  };
  for (std::size_t i = 0; i < k; ++i) add(problem.levels[i].J * unit.asDiagonal());
  Eigen::MatrixXd Z = Eigen::MatrixXd::Identity(n, n);
  if (all.rows() > 0) {
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> above(all.transpose());
    above.setThreshold(1e-9);
    Z = (above.householderQ() * Z).eval().rightCols(n - above.rank());
  }
  const Level& level = problem.levels[k];
  const Eigen::MatrixXd A = level.J * unit.asDiagonal() * Z;
  const Eigen::VectorXd left = level.b - level.J * u;
  Eigen::VectorXd y = Eigen::VectorXd::Zero(Z.cols());
  const double whole = (level.J * unit.asDiagonal()).norm();
  if (A.norm() > 1e-9 * whole) {
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> decomposed;
    decomposed.setThreshold(1e-9 * whole / A.norm());
    y = decomposed.compute(A).solve(left);
  }
  add(level.J * unit.asDiagonal());
  return {u + unit.asDiagonal() * (Z * y), all * unit.cwiseInverse().asDiagonal(),
          (A * y - left).norm() <= 1e-9 * (level.b.norm() + level.J.norm())};
}

struct Tally {
  int levels = 0;
  int limited = 0;
  double short_of = 0.0;   ///< Largest scale − scale found.
  double beyond = 0.0;     ///< Excess over a bound.
  double disturbed = 0.0;  ///< Change of J u of a level by lower levels, relative to |J|.
  double off = 0.0;        ///< J u − b of a level with scale 1, relative to |b| + |J|.
};

void check(const Problem& problem, const Answer& found, Tally& tally) {
  Eigen::VectorXd u = problem.rest;
  for (std::size_t k = 0; k < problem.levels.size(); ++k) {
    const auto& [J, b] = problem.levels[k];
    const double size = J.norm() + b.norm();
    const Asked want = asked(problem, k, u);
    const double best = largest_scale(want.all, problem.lower, problem.upper, u, want.desired, problem.G, problem.most);
    ++tally.levels;
    tally.limited += found.scale[k] < 1.0 ? 1 : 0;
    if ((want.desired - u).norm() > 1e-9) tally.short_of = std::max(tally.short_of, best - found.scale[k]);
    u = found.u[k];
    tally.beyond = std::max({tally.beyond, (problem.lower - u).maxCoeff(), (u - problem.upper).maxCoeff()});
    if (problem.most.size() > 0)
      tally.beyond = std::max(tally.beyond, (problem.G * u - problem.most).maxCoeff() - 1e-13);
    if (found.scale[k] == 1.0 && want.possible && size > 0.0)
      tally.off = std::max(tally.off, (J * u - b).norm() / size);
    if (J.norm() > 0.0) tally.disturbed = std::max(tally.disturbed, (J * (found.u.back() - u)).norm() / J.norm());
  }
}

void expect_priorities(const char* name, Eigen::Index most, int problems, bool odd, bool rows) {
  Tally tally;
  for (int seed = 0; seed < problems; ++seed) {
    Random random(static_cast<std::uint32_t>(seed));
    const Eigen::Index n = 2 + seed % (most - 1);
    Problem problem = random_problem(random, n, 1 + seed % 5, odd);
    if (rows) {
      problem.G.resize(kMostRows, n);
      for (int i = 0; i < kMostRows; ++i) problem.G.row(i) = random.uniform(n, -1.0, 1.0).transpose();
      problem.most = problem.G * problem.rest + random.uniform(kMostRows, 0.0, 0.3);
    }
    check(problem, answer(problem), tally);
  }
  std::printf(
      "%s: %d levels, %d limited; short of the largest scale by %.1e at most, beyond a bound by %.1e, levels "
      "before disturbed by %.1e, done whole but for %.1e\n",
      name, tally.levels, tally.limited, tally.short_of, tally.beyond, tally.disturbed, tally.off);
  EXPECT_GT(tally.limited, tally.levels / 10);
  EXPECT_LE(tally.short_of, 1e-6);
  EXPECT_LE(tally.beyond, 0.0);
  EXPECT_LE(tally.disturbed, 1e-10);
  EXPECT_LE(tally.off, 1e-9);
}

TEST(LevelSaturation, every_scale_is_the_largest) {
  expect_priorities("levels", 9, trials(2000), false, false);
}
TEST(LevelSaturation, every_scale_is_the_largest_with_dependent_rows) {
  expect_priorities("odd levels", 9, trials(2000), true, false);
}
TEST(LevelSaturation, every_scale_is_the_largest_within_further_bounds) {
  expect_priorities("levels and rows", 9, trials(1000), false, true);
}
TEST(LevelSaturation, every_scale_is_the_largest_with_many_joints) {
  expect_priorities("many joints", 32, trials(200), true, false);
}

/// For one level, the result is the saturation of a single task.
TEST(LevelSaturation, of_one_level_equals_that_of_a_task) {
  for (std::uint32_t seed = 0; seed < static_cast<std::uint32_t>(trials(200)); ++seed) {
    Random random(seed);
    const Problem problem = random_problem(random, 7, 1, false);
    const Matrix<Eigen::Dynamic, 7> J = problem.levels[0].J;
    const Vector<7> unit = (problem.upper - problem.lower) / 2.0;
    const Vector<7> desired = asked(problem, 0, problem.rest).desired;
    const Box<7> box{problem.lower, problem.upper};
    NullSpaceSaturation<Eigen::Dynamic, 7, double> alone(J, unit);
    const auto found = answer_as<7, double, 0>(problem);
    if (box.contains(desired)) {
      EXPECT_EQ(found.scale[0], 1.0) << seed;
      EXPECT_LE((found.u[0] - desired).norm(), 1e-12) << seed;
    } else {
      const auto one = alone(box, problem.rest, desired);
      EXPECT_NEAR(found.scale[0], one.scale, 1e-9) << seed;
      EXPECT_LE((found.u[0] - one.u).norm(), 1e-8) << seed;
    }
  }
}

TEST(LevelSaturation, float_keeps_the_box) {
  for (std::uint32_t seed = 0; seed < static_cast<std::uint32_t>(trials(300)); ++seed) {
    Random random(seed);
    const Problem problem = random_problem(random, 7, 4, seed % 2 == 0);
    const Answer found = answer_as<7, float, 0>(problem);
    for (const Eigen::VectorXd& u : found.u) {
      for (Eigen::Index i = 0; i < 7; ++i) {
        EXPECT_GE(static_cast<float>(u(i)), static_cast<float>(problem.lower(i))) << seed;
        EXPECT_LE(static_cast<float>(u(i)), static_cast<float>(problem.upper(i))) << seed;
      }
    }
  }
}

/// A level that is not finite is omitted, and does not change the other levels.
TEST(LevelSaturation, a_level_that_is_not_finite_stops_alone) {
  Random random(3);
  Problem problem = random_problem(random, 7, 3, false);
  Problem without = problem;
  without.levels.erase(without.levels.begin() + 1);
  problem.levels[1].b(0) = std::numeric_limits<double>::quiet_NaN();
  const Answer found = answer(problem);
  const Answer others = answer(without);
  EXPECT_EQ(found.scale[1], 0.0);
  EXPECT_EQ(found.scale[0], others.scale[0]);
  EXPECT_EQ(found.scale[2], others.scale[1]);
  EXPECT_EQ(found.u.back(), others.u.back());
}

}  // namespace
}  // namespace fpbm::test::level_saturation_laws
