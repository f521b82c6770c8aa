#include "fpbm/core/symmetric_eigen.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <limits>

#include "support/random.hpp"

/// A = V diag(λ) Vᵀ with VᵀV = I, and the eigenvalues are Eigen's, to round-off, at every rank and scale.
namespace fpbm::test {
namespace {

template <int M, typename Scalar>
void expect_spectrum(const Matrix<M, M, Scalar>& A) {
  const SymmetricEigen<M, Scalar> found(A);
  const Scalar slack = Scalar(20 * M) * std::numeric_limits<Scalar>::epsilon();
  const Matrix<M, M, Scalar> again = found.vectors * found.values.asDiagonal() * found.vectors.transpose();
  const Scalar size = A.cwiseAbs().maxCoeff();
  EXPECT_LE((again - A).cwiseAbs().maxCoeff(), slack * size);
  const Matrix<M, M, Scalar> one = found.vectors.transpose() * found.vectors;
  EXPECT_LE((one - Matrix<M, M, Scalar>::Identity()).cwiseAbs().maxCoeff(), slack);
  Vector<M, Scalar> values = found.values;
  std::sort(values.data(), values.data() + M);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<Scalar, M, M>> known(A, Eigen::EigenvaluesOnly);
  EXPECT_LE((values - known.eigenvalues()).cwiseAbs().maxCoeff(), slack * size);
}

template <typename Type>
class SymmetricEigenLaws : public testing::Test {};
template <int kRows, typename Number>
struct Case {
  static constexpr int M = kRows;
  using Scalar = Number;
};
using Cases = testing::Types<Case<2, double>, Case<3, double>, Case<4, double>, Case<6, double>, Case<2, float>,
                             Case<3, float>, Case<6, float>>;
TYPED_TEST_SUITE(SymmetricEigenLaws, Cases);

TYPED_TEST(SymmetricEigenLaws, hold_for_gram_matrices_of_every_rank_and_scale) {
  constexpr int M = TypeParam::M;
  using Scalar = typename TypeParam::Scalar;
  for (std::uint32_t seed = 0; seed < 500; ++seed) {
    Random random(seed);
    for (int rank = 0; rank <= M; ++rank) {
      Matrix<M, M, Scalar> J = random.uniform(M, M, -1.0, 1.0).template cast<Scalar>();
      J.rightCols(M - rank).setZero();
      const Scalar scale = static_cast<Scalar>(std::pow(10.0, random.uniform(-8.0, 8.0)));
      expect_spectrum<M, Scalar>(scale * (J * J.transpose()));
    }
  }
}

TYPED_TEST(SymmetricEigenLaws, hold_where_eigenvalues_repeat) {
  constexpr int M = TypeParam::M;
  using Scalar = typename TypeParam::Scalar;
  expect_spectrum<M, Scalar>(Matrix<M, M, Scalar>::Zero());
  expect_spectrum<M, Scalar>(Matrix<M, M, Scalar>::Identity());
  expect_spectrum<M, Scalar>(Matrix<M, M, Scalar>::Ones());
}

TYPED_TEST(SymmetricEigenLaws, end_on_what_is_not_finite) {
  constexpr int M = TypeParam::M;
  using Scalar = typename TypeParam::Scalar;
  for (const Scalar nonsense : {std::numeric_limits<Scalar>::quiet_NaN(), std::numeric_limits<Scalar>::infinity()}) {
    Matrix<M, M, Scalar> A = Matrix<M, M, Scalar>::Ones();
    A(M - 1, M - 1) = nonsense;
    const SymmetricEigen<M, Scalar> found(A);
    EXPECT_FALSE(found.values.allFinite());
  }
}

}  // namespace
}  // namespace fpbm::test
