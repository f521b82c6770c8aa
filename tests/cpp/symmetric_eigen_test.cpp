#include "fpbm/linalg/symmetric_eigen.hpp"

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

template <int M, typename Scalar>
using Square = Matrix<M, M, Scalar>;

/// Calls check with an empty matrix of every kind.
template <typename Check>
void on_every_size(Check&& check) {
  check(Square<2, double>());
  check(Square<3, double>());
  check(Square<4, double>());
  check(Square<6, double>());
  check(Square<2, float>());
  check(Square<3, float>());
  check(Square<6, float>());
}

TEST(SymmetricEigen, hold_for_gram_matrices_of_every_rank_and_scale) {
  on_every_size([]([[maybe_unused]] auto empty) {
    constexpr int M = decltype(empty)::RowsAtCompileTime;
    using Scalar = typename decltype(empty)::Scalar;
    for (std::uint32_t seed = 0; seed < 500; ++seed) {
      Random random(seed);
      for (int rank = 0; rank <= M; ++rank) {
        Square<M, Scalar> J = random.uniform(M, M, -1.0, 1.0).template cast<Scalar>();
        J.rightCols(M - rank).setZero();
        const Scalar scale = static_cast<Scalar>(std::pow(10.0, random.uniform(-8.0, 8.0)));
        expect_spectrum<M, Scalar>(scale * (J * J.transpose()));
      }
    }
  });
}

TEST(SymmetricEigen, hold_where_eigenvalues_repeat) {
  on_every_size([]([[maybe_unused]] auto empty) {
    constexpr int M = decltype(empty)::RowsAtCompileTime;
    using Scalar = typename decltype(empty)::Scalar;
    expect_spectrum<M, Scalar>(Matrix<M, M, Scalar>::Zero());
    expect_spectrum<M, Scalar>(Matrix<M, M, Scalar>::Identity());
    expect_spectrum<M, Scalar>(Matrix<M, M, Scalar>::Ones());
  });
}

TEST(SymmetricEigen, end_on_what_is_not_finite) {
  on_every_size([]([[maybe_unused]] auto empty) {
    constexpr int M = decltype(empty)::RowsAtCompileTime;
    using Scalar = typename decltype(empty)::Scalar;
    for (const Scalar nonsense : {std::numeric_limits<Scalar>::quiet_NaN(), std::numeric_limits<Scalar>::infinity()}) {
      Matrix<M, M, Scalar> A = Matrix<M, M, Scalar>::Ones();
      A(M - 1, M - 1) = nonsense;
      const SymmetricEigen<M, Scalar> found(A);
      EXPECT_FALSE(found.values.allFinite());
    }
  });
}

}  // namespace
}  // namespace fpbm::test
