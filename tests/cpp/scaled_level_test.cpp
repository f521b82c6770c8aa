#include "fpbm/singular/detail/scaled_level.hpp"

#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <cmath>
#include <cstdint>
#include <limits>

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
    const Eigen::VectorXd u = Eigen::MatrixXd(J).completeOrthogonalDecomposition().solve(r);  // J u = r
    EXPECT_LT((level.J * u - level.r).norm(), 1e-9 * (1.0 + u.norm()));
  }
}

TEST(ScaledLevel, has_the_singular_values_of_its_docstring) {
  expect_scaled<3, 7>(3, 7);
#ifndef FPBM_FEW_TYPES
  expect_scaled<1, 7>(1, 7);
  expect_scaled<6, 14>(6, 14);
#endif
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

}  // namespace
}  // namespace fpbm::test
