#include "fpbm/singular/damped_level.hpp"

#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "fpbm/limits/level_saturation.hpp"
#include "support/random.hpp"

/// A level that is nearly singular, or nearly contradicts the level above, is damped in the lost directions alone.
namespace fpbm::test::damped_level_laws {
namespace {

constexpr double kRadius = 0.05;
constexpr int kJoints = 7;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

using Joints = Vector<kJoints>;
template <int M>
using Rows = Matrix<M, kJoints>;

/// Two levels without bounds: u after the first, u after the second, and the second's lost directions.
struct Found {
  Joints above;
  Joints u;
  double lost;
  double scale;
};

template <int M>
Found resolved(const Rows<2>& J1, const Vector<2>& b1, const Rows<M>& J, const Vector<M>& b, double radius,
               const Joints& unit, double bound = kInfinity) {
  const Joints most = Joints::Constant(bound);
  LevelSaturation<kJoints> levels(Box<kJoints>{-most, most}, Joints::Zero(), unit);
  levels.resolve(J1, b1);
  const Joints above = levels.motion();
  const double scale = levels.resolve(J, b, radius);
  return {above, levels.motion(), levels.lost(), scale};
}

template <int M>
Rows<M> random_rows(Random& random) {
  Rows<M> J;
  for (Eigen::Index i = 0; i < J.size(); ++i) J(i) = random.uniform(-1.0, 1.0);
  return J;
}

/// J₂ in the null space of J₁ and in the units of the joints, of which a singular value is `least` of its norm.
Rows<3> with_least(Random& random, const Rows<2>& J1, const Joints& unit, double least) {
  const Eigen::MatrixXd scaled = J1 * unit.asDiagonal();
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(scaled, Eigen::ComputeFullV);
  const Eigen::MatrixXd Z = svd.matrixV().rightCols<kJoints - 2>();
  const Eigen::MatrixXd A = random_rows<3>(random) * Z;
  Eigen::JacobiSVD<Eigen::MatrixXd> own(A, Eigen::ComputeThinU | Eigen::ComputeThinV);
  Eigen::Vector3d sigma = own.singularValues();
  sigma(2) = least * sigma.head<2>().norm();
  return own.matrixU() * sigma.asDiagonal() * own.matrixV().transpose() * Z.transpose() *
         unit.cwiseInverse().asDiagonal();
}

struct Case {
  Rows<2> J1;
  Vector<2> b1;
  Rows<3> J;
  Vector<3> b;
  Joints unit;
};

Case random_case(Random& random, double least) {
  Case drawn;
  drawn.unit = random.uniform(kJoints, 0.5, 2.0);
  drawn.J1 = random_rows<2>(random);
  drawn.b1 = random.uniform(2, -1.0, 1.0);
  drawn.J = with_least(random, drawn.J1, drawn.unit, least);
  drawn.b = random.uniform(3, -1.0, 1.0);
  return drawn;
}

TEST(DampedLevel, is_the_exact_solution_far_from_singular_postures) {
  for (std::uint32_t seed = 0; seed < static_cast<std::uint32_t>(trials(300)); ++seed) {
    Random random(seed);
    const auto [J1, b1, J, b, unit] = random_case(random, 1.5 * kRadius);
    const Found damped = resolved<3>(J1, b1, J, b, kRadius, unit);
    const Found exact = resolved<3>(J1, b1, J, b, 0.0, unit);
    EXPECT_EQ(damped.lost, 0.0) << seed;
    EXPECT_LE((damped.u - exact.u).norm(), 1e-10 * (1.0 + exact.u.norm())) << seed;
    EXPECT_LE((J * damped.u - b).norm(), 1e-10) << seed;
  }
}

/// Whatever is left of the level, down to nothing: the motion is at most 1.17 |r|/ε, no higher level changes, and the
/// directions that are not lost are done whole.
TEST(DampedLevel, bounds_the_motion_and_does_what_is_not_lost) {
  double largest = 0.0;
  double disturbed = 0.0;
  double undone = 0.0;
  for (std::uint32_t seed = 0; seed < static_cast<std::uint32_t>(trials(300)); ++seed) {
    Random random(seed);
    const double least = seed % 5 == 0 ? 0.0 : kRadius * std::pow(10.0, random.uniform(-12.0, -0.1));
    const auto [J1, b1, J, b, unit] = random_case(random, least);
    const Found found = resolved<3>(J1, b1, J, b, kRadius, unit);
    EXPECT_GT(found.lost, 0.0) << seed;
    const Eigen::MatrixXd scaled = J * unit.asDiagonal();
    const Eigen::VectorXd r = b - J * found.above;
    const Eigen::VectorXd step = (found.u - found.above).cwiseQuotient(unit);
    largest = std::max(largest, step.norm() * kRadius * scaled.norm() / r.norm());
    disturbed = std::max(disturbed, (J1 * found.u - b1).norm());
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(scaled, Eigen::ComputeThinU);
    undone = std::max(undone, (svd.matrixU().leftCols<2>().transpose() * (J * found.u - b)).norm());
  }
  std::printf("|u|: at most %.3f |r|/eps; higher level changed by %.1e; directions that are not lost off by %.1e\n",
              largest, disturbed, undone);
  EXPECT_LE(largest, 1.17);
  EXPECT_LE(disturbed, 1e-11);
  EXPECT_LE(undone, 1e-10);
}

/// A row of the second level turns through a row of the first: the motion is continuous, also where they coincide.
TEST(DampedLevel, is_continuous_where_levels_come_to_contradict_each_other) {
  double steepest = 0.0;
  double undamped = 0.0;
  for (std::uint32_t seed = 0; seed < static_cast<std::uint32_t>(trials(50)); ++seed) {
    Random random(seed);
    const Joints unit = Joints::Ones();
    const Rows<2> J1 = random_rows<2>(random);
    const Vector<2> b1 = random.uniform(2, -1.0, 1.0);
    const Rows<1> other = random_rows<1>(random);
    const Vector<1> b(1.0);
    const int steps = 400;
    Joints before;
    Joints exact_before;
    for (int i = 0; i <= steps; ++i) {
      const double angle = 1e-2 * (2.0 * i / steps - 1.0);
      const Rows<1> J = std::cos(angle) * J1.row(0) + std::sin(angle) * other;
      const Joints u = resolved<1>(J1, b1, J, b, kRadius, unit).u;
      const Joints exact = resolved<1>(J1, b1, J, b, 0.0, unit).u;
      if (i > 0) {
        steepest = std::max(steepest, (u - before).norm());
        undamped = std::max(undamped, (exact - exact_before).norm());
      }
      before = u;
      exact_before = exact;
    }
  }
  std::printf("largest change in a step of 5e-5 rad: %.2g with damping, %.2g without\n", steepest, undamped);
  EXPECT_LE(steepest, 0.2);
  EXPECT_GE(undamped, 100.0);  // What there is to damp.
}

/// In a box: the bounds hold to the last bit, and the higher level is as without the damped one.
TEST(DampedLevel, keeps_the_box) {
  for (std::uint32_t seed = 0; seed < static_cast<std::uint32_t>(trials(300)); ++seed) {
    Random random(seed);
    const double least = kRadius * std::pow(10.0, random.uniform(-12.0, 1.0));
    const auto [J1, b1, J, b, unit] = random_case(random, least);
    const Found found = resolved<3>(J1, b1, J, b, kRadius, unit, 1.0);
    EXPECT_LE(found.u.cwiseAbs().maxCoeff(), 1.0) << seed;
    EXPECT_LE((J1 * (found.u - found.above)).norm(), 1e-12) << seed;
    EXPECT_GE(found.scale, 0.0) << seed;
    EXPECT_LE(found.scale, 1.0) << seed;
  }
}

TEST(DampedLevel, a_level_that_is_not_finite_stops_alone) {
  Random random(1);
  auto [J1, b1, J, b, unit] = random_case(random, 0.0);
  b(1) = std::numeric_limits<double>::quiet_NaN();
  const Found found = resolved<3>(J1, b1, J, b, kRadius, unit);
  EXPECT_EQ(found.scale, 0.0);
  EXPECT_EQ(found.u, found.above);
}

}  // namespace
}  // namespace fpbm::test::damped_level_laws
