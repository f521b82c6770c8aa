#include "fpbm/linalg/detail/level_space.hpp"

#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "support/random.hpp"

/// The null space of levels of rows, compared with a singular value decomposition.
namespace fpbm::test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A random unit vector perpendicular to the rows of A.
[[nodiscard]] VectorXd outside(const MatrixXd& A, Random& random) {
  const VectorXd x = random.uniform(A.cols(), -1.0, 1.0);
  const VectorXd left = x - A.transpose() * A.transpose().colPivHouseholderQr().solve(x);
  return left / left.norm();
}

/// Three rows, then five rows below them. One row depends on the rows above, one also on its own level, and one has a
/// remainder of `gap`. Units differ from row to row.
template <int M1, int M2, int N, typename Scalar>
void expect_as_by_svd(Eigen::Index n, double gap, double tolerance) {
  for (int seed = 0; seed < trials(50); ++seed) {
    Random random(static_cast<std::uint32_t>(seed));
    MatrixXd above = random.uniform(3, n, -1.0, 1.0);
    MatrixXd below = random.uniform(5, n, -1.0, 1.0);
    below.row(0) = random.uniform(3, -1.0, 1.0).transpose() * above;
    const VectorXd nearly = above.transpose() * random.uniform(3, -1.0, 1.0);
    below.row(2) = (nearly + gap * nearly.norm() * outside(above, random)).transpose();
    below.row(4) = below.row(1) - 2.0 * below.row(3) + above.row(0);
    const MatrixXd Z = Eigen::JacobiSVD<MatrixXd>(above, Eigen::ComputeFullV).matrixV().rightCols(n - 3);
    MatrixXd independent(3, n);
    independent << below.row(1), below.row(2), below.row(3);
    const VectorXd z = Z * random.uniform(n - 3, -1.0, 1.0);
    // The y of least norm with the same rows: the component of z in the span of the projected rows.
    const MatrixXd projected = independent * Z;
    const VectorXd expected = Z * projected.completeOrthogonalDecomposition().solve(independent * z);

    const double unit = std::pow(10.0, random.uniform(-3.0, 3.0));
    const VectorXd units = (VectorXd(5) << 1.0, unit, 1.0, 1.0 / unit, unit).finished();
    const Matrix<M1, N, Scalar> A1 = (unit * above).template cast<Scalar>();
    const Matrix<M2, N, Scalar> A2 = (units.asDiagonal() * below).template cast<Scalar>();
    LevelSpace<N, Scalar> space(n);
    space.add(A1);
    ASSERT_EQ(space.rank(), 3);
    const Vector<M2, Scalar> r = (units.asDiagonal() * below * z).template cast<Scalar>();
    const VectorXd y = space.add(A2, r).template cast<double>();
    ASSERT_EQ(space.rank(), 6) << seed;
    EXPECT_LT((y - expected).norm(), tolerance * (1.0 + expected.norm())) << seed;
    EXPECT_LT((above * y).norm(), tolerance * (1.0 + y.norm())) << seed;

    const MatrixXd basis = space.basis().template cast<double>();
    const double round_off = 100.0 * static_cast<double>(std::numeric_limits<Scalar>::epsilon());
    EXPECT_LT((basis.transpose() * basis - MatrixXd::Identity(n - 6, n - 6)).norm(), round_off);
    const Vector<N, Scalar> x = random.uniform(n, -1.0, 1.0).template cast<Scalar>();
    const VectorXd once = space.project(x).template cast<double>();
    EXPECT_LT((once - basis * basis.transpose() * x.template cast<double>()).norm(), round_off);
    const VectorXd rest = space.add_unit(x).template cast<double>();
    EXPECT_EQ((rest - once).norm(), 0.0);
    EXPECT_EQ(space.rank(), n);
    EXPECT_EQ(space.project(x).norm(), Scalar(0));
  }
}

TEST(LevelSpace, is_that_of_a_singular_value_decomposition) {
  for (const double gap : {1.0, 1e-2, 1e-4, 1e-6, 1e-7}) {
    const double tolerance = 1e-13 / gap;
    expect_as_by_svd<3, 5, 7, double>(7, gap, tolerance);
#ifndef FPBM_FEW_TYPES
    expect_as_by_svd<3, 5, 14, double>(14, gap, tolerance);
    expect_as_by_svd<Eigen::Dynamic, Eigen::Dynamic, 9, double>(9, gap, tolerance);
#endif
    expect_as_by_svd<Eigen::Dynamic, Eigen::Dynamic, Eigen::Dynamic, double>(24, gap, tolerance);
  }
  for (const double gap : {1.0, 1e-1, 1e-2}) expect_as_by_svd<3, 5, 7, float>(7, gap, 2e-5 / gap);
}

}  // namespace
}  // namespace fpbm::test
