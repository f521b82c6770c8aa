#include <gtest/gtest.h>

#include <type_traits>

#include "fpbm/scheme/schemes.hpp"
#include "fpbm/simulate/detail/anchored_path.hpp"
#include "fpbm/simulate/detail/closed_loop.hpp"
#include "fpbm/singular/damping.hpp"
#include "support/paper.hpp"

/// A class that keeps a reference accepts no temporary: the compiler rejects it.
namespace fpbm::test::lifetime_laws {
namespace {

template <typename Scalar>
class Lifetimes : public ::testing::Test {};

using Scalars = ::testing::Types<float, double>;
TYPED_TEST_SUITE(Lifetimes, Scalars, );

TYPED_TEST(Lifetimes, of_a_gram_matrix_spans_its_jacobian) {
  using J = Matrix<3, 7, TypeParam>;
  using Rows = Matrix<7, 3, TypeParam>;
  using Transposed = Eigen::Transpose<const Rows>;
  using Damping = SingularDamping<TypeParam>;
  using Gram = DampedGram<3, 7, TypeParam>;
  EXPECT_TRUE((std::is_constructible_v<Gram, const Damping&, const J&, const Rows&>));
  EXPECT_FALSE((std::is_constructible_v<Gram, const Damping&, J, const Rows&>));
  EXPECT_FALSE((std::is_constructible_v<Gram, const Damping&, const J, const Rows&>));
  EXPECT_FALSE((std::is_constructible_v<Gram, const Damping&, const J&, Rows>));
  // The conversion needs a temporary.
  EXPECT_FALSE((std::is_constructible_v<Gram, const Damping&, Transposed, const Rows&>));

  // The damping is two numbers, of which Gram keeps a copy.
  J jacobian = J::Identity();
  jacobian(2, 2) = TypeParam(0.125);
  const Rows rows = jacobian.transpose();
  auto damping = Damping(TypeParam(0.5), TypeParam(2));
  Gram gram(damping, jacobian, rows);
  damping = Damping::off();
  EXPECT_EQ(gram.factor(TypeParam(1)), Status::kDamped);
}

TYPED_TEST(Lifetimes, of_an_anchored_path_spans_the_path) {
  using CirclePath = Path<Circle<TypeParam>>;
  using Anchored = AnchoredPath<CirclePath>;
  using Point = Vector<2, TypeParam>;
  EXPECT_TRUE((std::is_constructible_v<Anchored, const CirclePath&, const Point&>));
  EXPECT_TRUE((std::is_constructible_v<Anchored, CirclePath&, Point>));
  EXPECT_FALSE((std::is_constructible_v<Anchored, CirclePath, const Point&>));
  EXPECT_FALSE((std::is_constructible_v<Anchored, const CirclePath, const Point&>));
}

/// In braces, the only form in which a loop can be constructed, a temporary lives as long as the loop.
TYPED_TEST(Lifetimes, of_a_closed_loop_spans_arm_and_scheme) {
  using Arm = PlanarArm<4, TypeParam>;
  using Scheme = AccelerationScheme<4, TypeParam>;
  using Loop = ClosedLoop<Arm, Scheme, Position<2>>;
  EXPECT_TRUE(std::is_aggregate_v<Loop>);
  EXPECT_FALSE((std::is_constructible_v<Loop, Arm, Scheme>));
}

}  // namespace
}  // namespace fpbm::test::lifetime_laws
