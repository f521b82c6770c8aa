#include "fpbm/linalg/symmetric_eigen.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <ostream>
#include <string>
#include <vector>

#include "support/random.hpp"
#include "support/textbook.hpp"

/// A = V diag(λ) Vᵀ with VᵀV = I, and the eigenvalues are Eigen's, to round-off, at every rank and scale.
namespace fpbm::test::symmetric_eigen_laws {
namespace {

/// The decomposition of A as its Scalar rounds it.
struct Decomposition {
  RealMatrix A;
  RealVector values;
  RealMatrix vectors;
};

/// SymmetricEigen of a size and a Scalar, types erased.
struct ErasedEigen {
  std::string name;
  int rows;
  double epsilon;
  Decomposition (*of)(const Eigen::MatrixXd& A);
};

void PrintTo(const ErasedEigen& eigen, std::ostream* out) {
  *out << eigen.name;
}

template <int M, typename Scalar = double>
ErasedEigen erased(const std::string& name) {
  return {name, M, std::numeric_limits<Scalar>::epsilon(), [](const Eigen::MatrixXd& A) -> Decomposition {
            const Matrix<M, M, Scalar> rounded = A.cast<Scalar>();
            const SymmetricEigen<M, Scalar> found(rounded);
            return {real(rounded), real(found.values), real(found.vectors)};
          }};
}

class SymmetricEigenOf : public ::testing::TestWithParam<ErasedEigen> {
 protected:
  static void expect_spectrum(const Eigen::MatrixXd& matrix) {
    const auto [A, values, vectors] = GetParam().of(matrix);
    const Real slack = 20 * GetParam().rows * static_cast<Real>(GetParam().epsilon);
    const Real size = A.cwiseAbs().maxCoeff();
    const RealMatrix again = vectors * values.asDiagonal() * vectors.transpose();
    EXPECT_LE((again - A).cwiseAbs().maxCoeff(), slack * size);
    const RealMatrix one = vectors.transpose() * vectors;
    EXPECT_LE((one - RealMatrix::Identity(A.rows(), A.cols())).cwiseAbs().maxCoeff(), slack);
    EXPECT_LE((sorted(values) - eigenvalues(A)).cwiseAbs().maxCoeff(), slack * size);
  }
};

TEST_P(SymmetricEigenOf, gram_matrices_of_every_rank_and_scale) {
  const int rows = GetParam().rows;
  for (std::uint32_t seed = 0; seed < 500; ++seed) {
    Random random(seed);
    for (int rank = 0; rank <= rows; ++rank) {
      Eigen::MatrixXd J = random.uniform(rows, rows, -1.0, 1.0);
      J.rightCols(rows - rank).setZero();
      expect_spectrum(std::pow(10.0, random.uniform(-8.0, 8.0)) * J * J.transpose());
    }
  }
}

TEST_P(SymmetricEigenOf, matrices_with_eigenvalues_that_repeat) {
  const int rows = GetParam().rows;
  expect_spectrum(Eigen::MatrixXd::Zero(rows, rows));
  expect_spectrum(Eigen::MatrixXd::Identity(rows, rows));
  expect_spectrum(Eigen::MatrixXd::Ones(rows, rows));
}

TEST_P(SymmetricEigenOf, what_is_not_finite_ends_and_is_not_finite) {
  const int rows = GetParam().rows;
  for (const double nonsense : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Eigen::MatrixXd A = Eigen::MatrixXd::Ones(rows, rows);
    A(rows - 1, rows - 1) = nonsense;
    EXPECT_FALSE(GetParam().of(A).values.allFinite());
  }
}

INSTANTIATE_TEST_SUITE_P(every, SymmetricEigenOf,
                         ::testing::Values(erased<2>("m2"), erased<3>("m3"), erased<4>("m4"), erased<6>("m6"),
                                           erased<2, float>("m2_float"), erased<3, float>("m3_float"),
                                           erased<6, float>("m6_float")),
                         [](const auto& each) { return each.param.name; });

}  // namespace
}  // namespace fpbm::test::symmetric_eigen_laws
