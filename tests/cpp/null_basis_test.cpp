#include "fpbm/linalg/detail/null_basis.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "support/random.hpp"

namespace fpbm::test::null_basis_laws {
namespace {

/// Type-erased null_basis of a size and a Scalar.
struct ErasedBasis {
  std::string name;
  Eigen::Index rows;
  Eigen::Index cols;
  double epsilon;
  Eigen::MatrixXd (*of)(const Eigen::MatrixXd& A);
};

void PrintTo(const ErasedBasis& basis, std::ostream* out) {
  *out << basis.name;
}

template <int M, int N, typename Scalar = double>
ErasedBasis erased(const std::string& name, Eigen::Index rows = M, Eigen::Index cols = N) {
  return {name, rows, cols, static_cast<double>(std::numeric_limits<Scalar>::epsilon()), [](const Eigen::MatrixXd& A) {
            return Eigen::MatrixXd(null_basis<M, N, Scalar>(A.cast<Scalar>()).template cast<double>());
          }};
}

class NullBasisOf : public ::testing::TestWithParam<ErasedBasis> {
 protected:
  /// AZ = 0 and ZᵀZ = I, up to 45 epsilon: 1e-14 in double.
  static void expect_basis(const Eigen::MatrixXd& A) {
    const Eigen::MatrixXd Z = GetParam().of(A);
    const Eigen::Index nullity = A.cols() - A.rows();
    ASSERT_EQ(Z.rows(), A.cols());
    ASSERT_EQ(Z.cols(), nullity);
    const double tolerance = 45.0 * GetParam().epsilon;
    EXPECT_LE((A * Z).norm(), tolerance * A.norm());
    EXPECT_LE((Z.transpose() * Z - Eigen::MatrixXd::Identity(nullity, nullity)).norm(), tolerance);
  }

  static Eigen::MatrixXd random_matrix(Random& random) {
    return random.uniform(GetParam().rows, GetParam().cols, -1.0, 1.0);
  }
};

TEST_P(NullBasisOf, is_orthonormal_and_annihilated) {
  for (std::uint32_t seed = 0; seed < 200; ++seed) {
    Random random(seed);
    expect_basis(random_matrix(random));
  }
}

/// Rows that are linearly dependent, exactly or up to round-off; rows and columns of zeros; a zero matrix.
TEST_P(NullBasisOf, is_orthonormal_at_every_rank) {
  const Eigen::Index m = GetParam().rows;
  for (std::uint32_t seed = 0; seed < 50; ++seed) {
    Random random(seed);
    for (Eigen::Index rank = 0; rank < m; ++rank) {
      SCOPED_TRACE("seed " + std::to_string(seed) + ", rank " + std::to_string(rank));
      const Eigen::MatrixXd A = random_matrix(random);
      expect_basis(random.uniform(m, rank, -1.0, 1.0) * A.topRows(rank));
      Eigen::MatrixXd rows_gone = A;
      rows_gone.middleRows(rank, m - rank).setZero();
      expect_basis(rows_gone);
      Eigen::MatrixXd repeated = A;
      for (Eigen::Index i = rank; i < m; ++i) repeated.row(i) = A.row(0);
      expect_basis(repeated);
      Eigen::MatrixXd columns_gone = A;
      columns_gone.leftCols(m - rank).setZero();
      expect_basis(columns_gone);
    }
  }
}

/// A row that decreases to zero, also if its square underflows.
TEST_P(NullBasisOf, is_orthonormal_while_a_row_fades) {
  Random random(1);
  const Eigen::MatrixXd A = random_matrix(random);
  const double least = GetParam().epsilon < 1e-10 ? 1e-307 : 1e-37;
  for (double scale = 1.0; scale > least; scale *= 0.5) {
    SCOPED_TRACE("row 0 times " + std::to_string(std::log10(scale)) + " powers of ten");
    Eigen::MatrixXd faded = A;
    faded.row(0) *= scale;
    expect_basis(faded);
  }
}

INSTANTIATE_TEST_SUITE_P(every, NullBasisOf,
                         ::testing::Values(erased<2, 2>("m2_n2"), erased<2, 4>("m2_n4"), erased<3, 7>("m3_n7"),
                                           erased<2, Eigen::Dynamic>("m2_dynamic_12", 2, 12),
                                           erased<6, Eigen::Dynamic>("m6_dynamic_32", 6, 32),
                                           erased<6, Eigen::Dynamic>("m6_dynamic_6", 6, 6),
                                           erased<2, 4, float>("m2_n4_float"), erased<6, 7, float>("m6_n7_float")),
                         [](const auto& each) { return each.param.name; });

}  // namespace
}  // namespace fpbm::test::null_basis_laws
