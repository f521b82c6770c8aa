#include "fpbm/linalg/detail/eigenpairs_below.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <ostream>
#include <string>
#include <vector>

#include "support/random.hpp"
#include "support/textbook.hpp"

/// The eigenvalues below a bound equal Eigen's, and their vectors are orthonormal eigenvectors up to round-off, for
/// every rank and scale.
namespace fpbm::test::eigenpairs_below_laws {
namespace {

/// A, rounded to its Scalar, and the eigenpairs found.
struct Eigenpairs {
  RealMatrix A;
  RealVector values;
  RealMatrix vectors;
};

/// Type-erased EigenpairsBelow of a size and a Scalar.
struct ErasedEigen {
  std::string name;
  int rows;
  double epsilon;
  Eigenpairs (*of)(const Eigen::MatrixXd& A, double bound);
};

void PrintTo(const ErasedEigen& eigen, std::ostream* out) {
  *out << eigen.name;
}

template <int M, int Size = M, typename Scalar = double>
ErasedEigen erased(const std::string& name) {
  return {name, Size, std::numeric_limits<Scalar>::epsilon(), [](const Eigen::MatrixXd& A, double bound) -> Eigenpairs {
            const Matrix<M, M, Scalar> rounded = A.cast<Scalar>();
            Matrix<M, M, Scalar> lower = rounded;
            for (Eigen::Index i = 0; i < A.rows(); ++i) {
              for (Eigen::Index j = i + 1; j < A.cols(); ++j) lower(i, j) = std::numeric_limits<Scalar>::quiet_NaN();
            }
            const EigenpairsBelow<M, Scalar> found(lower, static_cast<Scalar>(bound));
            RealVector values(found.count());
            RealMatrix vectors(A.rows(), found.count());
            for (Eigen::Index k = 0; k < found.count(); ++k) {
              values(k) = static_cast<Real>(found.value(k));
              vectors.col(k) = real(found.vector(k));
            }
            return {real(rounded), values, vectors};
          }};
}

class EigenpairsBelowOf : public ::testing::TestWithParam<ErasedEigen> {
 protected:
  static void expect_eigenpairs(const Eigen::MatrixXd& matrix, double bound) {
    const auto [A, values, vectors] = GetParam().of(matrix, bound);
    const Real slack = 20 * GetParam().rows * static_cast<Real>(GetParam().epsilon);
    const Real size = A.cwiseAbs().maxCoeff();
    const RealVector all = eigenvalues(A);
    const auto below = [&](const RealVector& of, Real limit) { return (of.array() < limit).count(); };
    EXPECT_GE(below(values, static_cast<Real>(bound) + slack * size),
              below(all, static_cast<Real>(bound) - slack * size));
    EXPECT_LE(values.size(), A.rows());
    for (Eigen::Index k = 0; k < values.size(); ++k) {
      EXPECT_LE((A * vectors.col(k) - values(k) * vectors.col(k)).cwiseAbs().maxCoeff(), slack * size);
    }
    const RealMatrix one = vectors.transpose() * vectors;
    EXPECT_LE((one - RealMatrix::Identity(one.rows(), one.cols())).cwiseAbs().sum(), slack * A.rows());
    if (values.size() == A.rows()) {
      EXPECT_LE((sorted(values) - all).cwiseAbs().maxCoeff(), slack * size);
    }
  }
  /// With bounds below, among and above the eigenvalues.
  static void expect_eigenpairs(const Eigen::MatrixXd& matrix) {
    const double most = 2.0 * matrix.trace() + 1e-300;
    for (const double bound : {-most, 0.0, 1e-6 * most, 0.01 * most, 0.1 * most, most}) {
      expect_eigenpairs(matrix, bound);
    }
    EXPECT_EQ(GetParam().of(matrix, most).values.size(), matrix.rows());
  }
};

TEST_P(EigenpairsBelowOf, gram_matrices_of_every_rank_and_scale) {
  const int rows = GetParam().rows;
  for (std::uint32_t seed = 0; seed < 100; ++seed) {
    Random random(seed);
    for (int rank = 0; rank <= rows; ++rank) {
      Eigen::MatrixXd J = random.uniform(rows, rows, -1.0, 1.0);
      J.rightCols(rows - rank).setZero();
      expect_eigenpairs(std::pow(10.0, random.uniform(-8.0, 8.0)) * J * J.transpose());
    }
  }
}

/// Entries whose squares are outside the range of the Scalar.
TEST_P(EigenpairsBelowOf, matrices_that_are_scaled) {
  const int rows = GetParam().rows;
  const double power = GetParam().epsilon < 1e-10 ? 200.0 : 25.0;
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    Random random(seed);
    const Eigen::MatrixXd J = random.uniform(rows, rows, -1.0, 1.0);
    for (const double sign : {-1.0, 1.0}) expect_eigenpairs(std::pow(10.0, sign * power) * J * J.transpose());
  }
}

TEST_P(EigenpairsBelowOf, matrices_with_eigenvalues_that_repeat) {
  const int rows = GetParam().rows;
  expect_eigenpairs(Eigen::MatrixXd::Zero(rows, rows));
  expect_eigenpairs(Eigen::MatrixXd::Identity(rows, rows));
  expect_eigenpairs(Eigen::MatrixXd::Ones(rows, rows));
}

TEST_P(EigenpairsBelowOf, matrices_that_are_not_finite_give_values_that_are_not_finite) {
  const int rows = GetParam().rows;
  for (const double nonsense : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Eigen::MatrixXd A = Eigen::MatrixXd::Ones(rows, rows);
    A(rows - 1, rows - 1) = nonsense;
    EXPECT_FALSE(GetParam().of(A, 1.0).values.allFinite());
  }
}

INSTANTIATE_TEST_SUITE_P(every, EigenpairsBelowOf,
                         ::testing::Values(erased<2>("m2"), erased<3>("m3"), erased<4>("m4"), erased<6>("m6"),
                                           erased<1>("m1"), erased<Eigen::Dynamic, 12>("m12_dynamic"),
                                           erased<2, 2, float>("m2_float"), erased<3, 3, float>("m3_float"),
                                           erased<6, 6, float>("m6_float")),
                         [](const auto& each) { return each.param.name; });

}  // namespace
}  // namespace fpbm::test::eigenpairs_below_laws
