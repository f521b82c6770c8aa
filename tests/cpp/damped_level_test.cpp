#include "fpbm/singular/detail/damped_level.hpp"

#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <ostream>
#include <string>

#include "fpbm/limits/level_saturation.hpp"
#include "support/random.hpp"

/// A level that is nearly singular, or nearly contradicts the level above, is damped in the lost directions only.
namespace fpbm::test::damped_level_laws {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kRadius = 0.05;
constexpr double kUnbounded = std::numeric_limits<double>::infinity();

/// Two levels J₁ u = b₁ and J u = b, within a box of ±bound and further rows g·u ≤ 0.
struct Problem {
  MatrixXd J1;
  VectorXd b1;
  MatrixXd J;
  VectorXd b;
  VectorXd unit;
  double bound = kUnbounded;
  MatrixXd g = {};
};

/// A problem with n joints and m ≤ n − 2 rows. In the null space of J₁ and in the units of the joints, the smallest
/// singular value of J is `least` times the norm of the other singular values. The sizes of the levels range from 1e-3
/// to 1e3.
Problem random_problem(Random& random, Eigen::Index n, Eigen::Index m, double least) {
  const auto matrix = [&](Eigen::Index rows) {
    MatrixXd A(rows, n);
    for (Eigen::Index i = 0; i < rows; ++i) A.row(i) = random.uniform(n, -1.0, 1.0).transpose();
    return A;
  };
  Problem problem{matrix(2), random.uniform(2, -1.0, 1.0), {}, {}, random.uniform(n, 0.5, 2.0)};
  const Eigen::JacobiSVD<MatrixXd> above(problem.J1 * problem.unit.asDiagonal(), Eigen::ComputeFullV);
  const MatrixXd Z = above.matrixV().rightCols(n - 2);
  const Eigen::JacobiSVD<MatrixXd> own(matrix(m) * Z, Eigen::ComputeThinU | Eigen::ComputeThinV);
  VectorXd sigma = VectorXd::Ones(m) + 0.5 * random.uniform(m, -1.0, 1.0);  // Only the last singular value is small.
  sigma(m - 1) = m == 1 ? 1.0 : least * sigma.head(m - 1).norm();
  const double size = std::pow(10.0, random.uniform(-3.0, 3.0));
  problem.J = size * own.matrixU() * sigma.asDiagonal() * own.matrixV().transpose() * Z.transpose() *
              problem.unit.cwiseInverse().asDiagonal();
  problem.b = size * random.uniform(m, -1.0, 1.0);
  return problem;
}

/// u after the first level and after the second level; task scale and lost directions of the second level.
struct Found {
  VectorXd above;
  VectorXd u;
  double scale;
  double lost;
};

/// radius < 0: resolve(J, b), without damping.
template <int N, typename Scalar, int M, int P>
Found resolved(const Problem& problem, double radius) {
  const auto n = problem.unit.size();
  const Vector<N, Scalar> most = Vector<N, Scalar>::Constant(n, static_cast<Scalar>(problem.bound));
  Rows<N, P, Scalar> rows;
  if constexpr (P > 0) {
    rows.count = problem.g.cols();
    rows.g.setZero(n, P);
    rows.g.leftCols(rows.count) = problem.g.cast<Scalar>();
    rows.b.setZero();
  }
  LevelSaturation<N, Scalar, P> levels({-most, most}, Vector<N, Scalar>::Zero(n), problem.unit.cast<Scalar>(), rows);
  levels.template resolve<2>(problem.J1.cast<Scalar>(), problem.b1.cast<Scalar>());
  const VectorXd above = levels.motion().template cast<double>();
  const Matrix<M, N, Scalar> J = problem.J.cast<Scalar>();
  const Vector<M, Scalar> b = problem.b.cast<Scalar>();
  const Scalar scale = radius < 0.0 ? levels.resolve(J, b) : levels.resolve(J, b, static_cast<Scalar>(radius));
  return {above, levels.motion().template cast<double>(), static_cast<double>(scale),
          static_cast<double>(levels.lost())};
}

/// A combination of types with its name and its sizes.
struct Kind {
  const char* name;
  Eigen::Index rows;
  Eigen::Index fewest;  ///< Smallest number of joints.
  Eigen::Index most;
  double epsilon;
  int further;  ///< Number of rows in addition to the box.
  Found (*resolved)(const Problem&, double);
};
void PrintTo(const Kind& kind, std::ostream* out) {
  *out << kind.name;
}
constexpr int kOpen = Eigen::Dynamic;
constexpr double kDouble = std::numeric_limits<double>::epsilon();
constexpr double kFloat = std::numeric_limits<float>::epsilon();
const Kind kKinds[] = {
    {"3 rows, 7 joints", 3, 7, 7, kDouble, 0, resolved<7, double, 3, 0>},
    {"6 rows, 8 to 32 joints", 6, 8, 32, kDouble, 0, resolved<kOpen, double, 6, 0>},
    {"2 rows, 4 to 16 joints", 2, 4, 16, kDouble, 0, resolved<kOpen, double, 2, 0>},
    {"3 rows, 7 joints, float", 3, 7, 7, kFloat, 0, resolved<7, float, 3, 0>},
    {"3 rows, 7 joints, 3 further bounds", 3, 7, 7, kDouble, 3, resolved<7, double, 3, 3>},
};

class DampedLevel : public ::testing::TestWithParam<Kind> {
 protected:
  /// Calls law(seed, problem) for many problems, with the smallest singular value least(random).
  template <typename Least, typename Law>
  static void for_problems(int count, const Least& least, const Law& law) {
    const Kind& kind = GetParam();
    for (int seed = 0; seed < trials(count); ++seed) {
      Random random(static_cast<std::uint32_t>(seed));
      const auto spread = static_cast<double>(kind.most - kind.fewest) + 0.999;
      const Eigen::Index n = kind.fewest + static_cast<Eigen::Index>(random.uniform(0.0, spread));
      Problem problem = random_problem(random, n, kind.rows, least(random));
      problem.g = MatrixXd(n, kind.further);
      for (Eigen::Index k = 0; k < kind.further; ++k) problem.g.col(k) = random.uniform(n, -1.0, 1.0);
      law(seed, problem);
    }
  }
};

TEST_P(DampedLevel, changes_no_bit_far_from_singular_postures) {
  const auto least = [](Random& random) { return random.uniform(1.5 * kRadius, 1.0); };
  for_problems(200, least, [](int seed, Problem& problem) {
    for (const double bound : {kUnbounded, 0.5}) {
      problem.bound = bound;
      const Found damped = GetParam().resolved(problem, kRadius);
      const Found exact = GetParam().resolved(problem, -1.0);
      EXPECT_EQ(damped.lost, 0.0) << seed;
      EXPECT_EQ(damped.u, exact.u) << seed;
      EXPECT_EQ(damped.scale, exact.scale) << seed;
    }
  });
}

/// With radius 0, the result equals the least-squares solution, even if rows depend on other rows.
TEST_P(DampedLevel, is_off_with_radius_0) {
  for_problems(
      200, [](Random&) { return 0.0; },
      [](int seed, Problem& problem) {
        if (seed % 2 == 0) problem.J.row(0) = 2.0 * problem.J.row(GetParam().rows - 1);
        if (seed % 3 == 0) problem.J.row(0) = problem.J1.row(1);
        EXPECT_EQ(GetParam().resolved(problem, 0.0).u, GetParam().resolved(problem, -1.0).u) << seed;
      });
}

/// For any smallest singular value, the motion is at most 1.17 |r|/ε, the higher level does not change, and the
/// directions that are not lost are executed completely.
TEST_P(DampedLevel, bounds_the_motion_and_executes_the_remaining_task) {
  double largest = 0.0;
  double disturbed = 0.0;
  double undone = 0.0;
  const auto least = [](Random& random) {
    return random.uniform(0.0, 1.0) < 0.2 ? 0.0 : kRadius * std::pow(10.0, random.uniform(-12.0, -0.1));
  };
  for_problems(200, least, [&](int seed, Problem& problem) {
    problem.g.resize(problem.unit.size(), 0);  // Bounds would add null-space motion to the motion of the level.
    const Found found = GetParam().resolved(problem, kRadius);
    EXPECT_GT(found.lost, 0.0) << seed;
    const MatrixXd scaled = problem.J * problem.unit.asDiagonal();
    const VectorXd r = problem.b - problem.J * found.above;
    const VectorXd step = (found.u - found.above).cwiseQuotient(problem.unit);
    largest = std::max(largest, step.norm() * kRadius * scaled.norm() / r.norm());
    disturbed = std::max(disturbed, (problem.J1 * (found.u - found.above)).norm() / (1.0 + found.u.norm()));
    const Eigen::JacobiSVD<MatrixXd> svd(scaled, Eigen::ComputeThinU);
    const VectorXd off = svd.matrixU().leftCols(GetParam().rows - 1).transpose() * (problem.J * found.u - problem.b);
    undone = std::max(undone, off.norm() / (r.norm() + scaled.norm() * found.above.norm()));
  });
  std::printf("%s: |u| %.3f |r|/eps at most; higher level changed by %.1e; directions that are not lost off by %.1e\n",
              GetParam().name, largest, disturbed, undone);
  EXPECT_LE(largest, 1.17);
  EXPECT_LE(disturbed, 1e3 * GetParam().epsilon);
  EXPECT_LE(undone, 1e4 * GetParam().epsilon);
}

/// With bounds, from rest and with bounds that admit no motion: no bound is exceeded, and the higher level is the same
/// as without the damped level.
TEST_P(DampedLevel, keeps_all_bounds) {
  const auto least = [](Random& random) { return kRadius * std::pow(10.0, random.uniform(-12.0, 1.0)); };
  for_problems(300, least, [](int seed, Problem& problem) {
    problem.bound = seed % 10 == 0 ? 0.0 : std::ldexp(1.0, -3 * (seed % 4));  // Exact in float.
    const Found found = GetParam().resolved(problem, kRadius);
    EXPECT_LE(found.u.cwiseAbs().maxCoeff(), problem.bound) << seed;
    for (Eigen::Index k = 0; k < GetParam().further; ++k) {
      EXPECT_LE(problem.g.col(k).dot(found.u), 1e3 * GetParam().epsilon * problem.bound) << seed;
    }
    EXPECT_LE((problem.J1 * (found.u - found.above)).norm(), 1e3 * GetParam().epsilon) << seed;
    EXPECT_GE(found.scale, 0.0) << seed;
    EXPECT_LE(found.scale, 1.0) << seed;
  });
}

TEST_P(DampedLevel, stops_alone_if_it_is_not_finite) {
  for_problems(
      20, [](Random&) { return 0.0; },
      [](int seed, Problem& problem) {
        (seed % 2 == 0 ? problem.b(0) : problem.J(0, 1)) = std::numeric_limits<double>::quiet_NaN();
        const Found found = GetParam().resolved(problem, kRadius);
        EXPECT_EQ(found.scale, 0.0) << seed;
        EXPECT_EQ(found.lost, 0.0) << seed;
        EXPECT_EQ(found.u, found.above) << seed;
      });
}

INSTANTIATE_TEST_SUITE_P(every, DampedLevel, ::testing::ValuesIn(kKinds), [](const auto& tested) {
  std::string name = tested.param.name;
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c == ' ' || c == ','; }, '_');
  return name;
});

/// A posture task of all joints needs no factorisation, and its motion does not depend on the order of the rows.
TEST(DampedLevels, of_a_posture_do_not_depend_on_the_order_of_rows) {
  constexpr Eigen::Index n = 7;
  for (std::uint32_t seed = 0; seed < 200; ++seed) {
    Random random(seed);
    const double radius = seed % 2 == 0 ? 0.1 : 0.6;  // With 0.6, the solver damps directions.
    const Matrix<Eigen::Dynamic, n> above = random.uniform(random.uniform(0.0, 1.0) < 0.5 ? 3 : 5, n, -1.0, 1.0);
    const double size = std::pow(10.0, random.uniform(-2.0, 2.0));
    Vector<n> entries = Vector<n>::Constant(size);
    if (seed % 3 > 0) entries = size * random.uniform(n, 0.5, 1.5);
    const Matrix<n, n> posture = entries.asDiagonal();
    const Vector<n> r = random.uniform(n, -1.0, 1.0);
    const auto motion = [&](const Matrix<n, n>& A, const Vector<n>& b) {
      LevelSpace<n> space(n);
      space.add(above);
      fpbm::DampedLevel<n, double> damped(radius * radius * A.squaredNorm());
      const Vector<n> y = space.add(A, b, damped);
      EXPECT_EQ(space.rank(), n);
      return y;
    };
    const Vector<n> expected = motion(posture.colwise().reverse(), r.reverse());
    EXPECT_LT((motion(posture, r) - expected).norm(), 1e-12 / size) << seed;
    EXPECT_GT(expected.norm(), 1e-3 / size);
  }
}

/// Levels with dependent rows, whose L has fewer columns than rows, in float as in double.
TEST(DampedLevels, in_float_damp_dependent_rows) {
  Random random(31);
  int damped = 0;
  for (int k = 0; k < trials(2000); ++k) {
    const int columns = 1 + k % 2;
    Matrix<3, 3> L = Matrix<3, 3>::Zero();
    for (int j = 0; j < columns; ++j) {
      for (int i = j; i < 3; ++i) L(i, j) = random.uniform(-1.0, 1.0) * std::pow(10.0, -random.uniform(0.0, 2.0) * j);
    }
    const Vector<3> r = random.uniform(3, -1.0, 1.0);
    Vector<3> w = r;
    Vector<3, float> w_float = r.cast<float>();
    const bool expected = fpbm::DampedLevel<3, double>(0.01)(L, w, columns);
    const Matrix<3, 3, float> L_float = L.cast<float>();
    ASSERT_EQ((fpbm::DampedLevel<3, float>(0.01F)(L_float, w_float, columns)), expected) << L;
    if (!expected) continue;
    ++damped;
    EXPECT_LE((w_float.cast<double>() - w).norm(), 1e-3 * r.norm()) << L;
  }
  EXPECT_GT(damped, trials(2000) / 20);
}

/// A row of the second level rotates through a row of the first level. The motion is continuous, even where the two
/// rows coincide.
TEST(DampedLevels, are_continuous_where_rows_of_two_levels_coincide) {
  double largest = 0.0;
  double undamped = 0.0;
  for (int seed = 0; seed < trials(50); ++seed) {
    Random random(static_cast<std::uint32_t>(seed));
    Problem problem = random_problem(random, 7, 1, 1.0);
    problem.unit.setOnes();
    problem.b(0) = 1.0;
    const VectorXd other = random.uniform(7, -1.0, 1.0);
    constexpr int kSteps = 400;
    Found before{};
    Found exact_before{};
    for (int i = 0; i <= kSteps; ++i) {
      const double angle = 1e-2 * (2.0 * i / kSteps - 1.0);
      problem.J = std::cos(angle) * problem.J1.row(0) + std::sin(angle) * other.transpose();
      const Found found = resolved<7, double, 1, 0>(problem, kRadius);
      const Found exact = resolved<7, double, 1, 0>(problem, -1.0);
      if (i > 0) {
        largest = std::max(largest, (found.u - before.u).norm());
        undamped = std::max(undamped, (exact.u - exact_before.u).norm());
      }
      before = found;
      exact_before = exact;
    }
  }
  std::printf("largest change of u in a step of 5e-5 rad: %.2g with damping, %.2g without\n", largest, undamped);
  EXPECT_LE(largest, 0.2);
  EXPECT_GE(undamped, 100.0);  // The discontinuity that the damping removes.
}

}  // namespace
}  // namespace fpbm::test::damped_level_laws
