#include "fpbm/linalg/detail/cholesky.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <ostream>
#include <string>
#include <vector>

#include "support/random.hpp"
#include "support/textbook.hpp"

namespace fpbm::test::cholesky_laws {
namespace {

/// Solves A x = b by a type-erased Cholesky. Returns false if A is rejected.
using Solve = bool (*)(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, Eigen::VectorXd& x);

template <int M, typename Scalar>
bool solve(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, Eigen::VectorXd& x) {
  Cholesky<M, Scalar> cholesky;
  if (cholesky.factor(A.cast<Scalar>()) != Status::kOk) return false;
  x = cholesky.solve(b.cast<Scalar>()).template cast<double>();
  return true;
}

struct ErasedCholesky {
  std::string name;
  int rows;
  double epsilon;
  Solve solve;

  [[nodiscard]] bool factors(const Eigen::MatrixXd& A) const {
    Eigen::VectorXd x;
    return solve(A, Eigen::VectorXd::Zero(A.rows()), x);
  }
};

void PrintTo(const ErasedCholesky& cholesky, std::ostream* out) {
  *out << cholesky.name;
}

template <int M, typename Scalar = double>
ErasedCholesky erased(const std::string& name, int rows = M) {
  return {name, rows, std::numeric_limits<Scalar>::epsilon(), &solve<M, Scalar>};
}

std::vector<ErasedCholesky> sizes() {
  constexpr int kOpen = Eigen::Dynamic;
  return {erased<1>("m1"),
          erased<2>("m2"),
          erased<3>("m3"),
          erased<4>("m4"),
          erased<5>("m5"),
          erased<6>("m6"),
          erased<kOpen>("dynamic_6", 6),
          erased<kOpen>("dynamic_32", 32),
          erased<2, float>("m2_float"),
          erased<6, float>("m6_float")};
}

class CholeskyOf : public ::testing::TestWithParam<ErasedCholesky> {};

TEST_P(CholeskyOf, solves) {
  const int rows = GetParam().rows;
  for (std::uint32_t seed = 0; seed < 50; ++seed) {
    Random random(seed);
    const Eigen::MatrixXd A = random.positive_definite(rows);
    const Eigen::VectorXd b = random.uniform(rows, -1.0, 1.0);
    const RealVector expected = inverse(real(A)) * real(b);
    Eigen::VectorXd x;
    ASSERT_TRUE(GetParam().solve(A, b, x));
    EXPECT_LE((real(x) - expected).norm(), 16 * rows * static_cast<Real>(GetParam().epsilon) * expected.norm());
  }
}

TEST_P(CholeskyOf, reads_the_lower_triangle_only) {
  Random random(1);
  const Eigen::MatrixXd A = random.positive_definite(GetParam().rows);
  const Eigen::VectorXd b = random.uniform(GetParam().rows, -1.0, 1.0);
  Eigen::MatrixXd lower = A;
  lower.triangularView<Eigen::StrictlyUpper>().setConstant(std::numeric_limits<double>::quiet_NaN());
  Eigen::VectorXd x;
  Eigen::VectorXd y;
  ASSERT_TRUE(GetParam().solve(A, b, x));
  ASSERT_TRUE(GetParam().solve(lower, b, y));
  EXPECT_EQ(x, y);
}

TEST_P(CholeskyOf, rejects_matrices_that_are_not_positive_definite) {
  const int rows = GetParam().rows;
  Random random(2);
  const Eigen::MatrixXd A = random.positive_definite(rows);
  EXPECT_FALSE(GetParam().factors(Eigen::MatrixXd::Zero(rows, rows))) << "zero";
  EXPECT_FALSE(GetParam().factors(-A)) << "negative definite";
  for (Eigen::Index i = 0; i < rows; ++i) {
    Eigen::MatrixXd indefinite = A;
    indefinite(i, i) = -0.1;
    EXPECT_FALSE(GetParam().factors(indefinite)) << "indefinite at " << i;
  }
  if (rows == 1) return;
  const Eigen::MatrixXd thin = random.uniform(rows, rows - 1, -1.0, 1.0);
  EXPECT_FALSE(GetParam().factors(thin * thin.transpose())) << "singular";
  EXPECT_FALSE(GetParam().factors(Eigen::MatrixXd::Ones(rows, rows))) << "of rank one";
}

TEST_P(CholeskyOf, rejects_matrices_that_are_not_finite) {
  Random random(3);
  const Eigen::MatrixXd A = random.positive_definite(GetParam().rows);
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    for (Eigen::Index i = 0; i < A.rows(); ++i) {
      for (Eigen::Index j = 0; j <= i; ++j) {
        Eigen::MatrixXd spoiled = A;
        spoiled(i, j) = bad;
        EXPECT_FALSE(GetParam().factors(spoiled)) << bad << " at " << i << ", " << j;
      }
    }
  }
}

/// No scale is too small or too large, because pivots are compared with the diagonal.
TEST_P(CholeskyOf, does_not_depend_on_scale) {
  Random random(4);
  const Eigen::MatrixXd A = random.positive_definite(GetParam().rows);
  for (const double scale : {1e-30, 1e-6, 1e6, 1e30}) EXPECT_TRUE(GetParam().factors(scale * A)) << scale;
}

/// Two matrices factorised together give bitwise the results of separate factorisations. The pair is rejected if either
/// matrix is rejected.
template <int M, typename Scalar>
void expect_pair_to_agree() {
  using Square = Matrix<M, M, Scalar>;
  for (std::uint32_t seed = 0; seed < 50; ++seed) {
    Random random(seed);
    const Square A = random.positive_definite(M).template cast<Scalar>();
    const Square B = random.positive_definite(M).template cast<Scalar>();
    const Vector<M, Scalar> a = random.uniform(M, -1.0, 1.0).template cast<Scalar>();
    const Vector<M, Scalar> b = random.uniform(M, -1.0, 1.0).template cast<Scalar>();
    Cholesky<M, Pair<Scalar>> both;
    Cholesky<M, Scalar> of_a;
    Cholesky<M, Scalar> of_b;
    ASSERT_EQ(both.factor(side_by_side<M, M, Scalar>(A, B)), Status::kOk);
    ASSERT_EQ(of_a.factor(A), Status::kOk);
    ASSERT_EQ(of_b.factor(B), Status::kOk);
    const auto x = both.solve(side_by_side<M, 1, Scalar>(a, b));
    EXPECT_EQ((fpbm::first<M, 1, Scalar>(x)), of_a.solve(a));
    EXPECT_EQ((fpbm::second<M, 1, Scalar>(x)), of_b.solve(b));
    EXPECT_EQ(both.inverse_trace().first(), of_a.inverse_trace());
    EXPECT_EQ(both.inverse_trace().second(), of_b.inverse_trace());

    Square singular = A;
    singular.row(M - 1) = A.row(0);
    singular.col(M - 1) = singular.col(0);
    EXPECT_EQ(both.factor(side_by_side<M, M, Scalar>(singular, B)), Status::kSingular);
    EXPECT_EQ(both.factor(side_by_side<M, M, Scalar>(A, singular)), Status::kSingular);
    singular(0, 0) = std::numeric_limits<Scalar>::quiet_NaN();
    EXPECT_EQ(both.factor(side_by_side<M, M, Scalar>(A, singular)), Status::kNotFinite);
  }
}
TEST(CholeskyOfPair, agrees_with_each_matrix_alone) {
  expect_pair_to_agree<2, double>();
  expect_pair_to_agree<6, float>();
#ifndef FPBM_FEW_TYPES
  expect_pair_to_agree<3, double>();
  expect_pair_to_agree<6, double>();
#endif
}

INSTANTIATE_TEST_SUITE_P(every, CholeskyOf, ::testing::ValuesIn(sizes()),
                         [](const auto& each) { return each.param.name; });

}  // namespace
}  // namespace fpbm::test::cholesky_laws
