#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <ostream>
#include <string>
#include <vector>

#include "fpbm/linalg/detail/pair.hpp"
#include "fpbm/model/planar_arm.hpp"
#include "support/random.hpp"
#include "support/textbook.hpp"

namespace fpbm::test::kinematics_laws {
namespace {

/// Tip, J and Jd of a type-erased arm.
using Evaluate = Situation (*)(const Eigen::VectorXd& lengths, const Eigen::VectorXd& q, const Eigen::VectorXd& qd);

template <typename Arm>
Situation evaluate(const Eigen::VectorXd& lengths, const Eigen::VectorXd& q, const Eigen::VectorXd& qd) {
  using Scalar = typename Arm::Scalar;
  const Arm arm(lengths.cast<Scalar>());
  Kinematics<Position<2>, Arm::kDof, Scalar> out;
  arm.kinematics(q.cast<Scalar>(), qd.cast<Scalar>(), out);
  Kinematics<Position<2>, Arm::kDof, Scalar> without_rate;
  arm.kinematics(q.cast<Scalar>(), without_rate);
  EXPECT_EQ(without_rate.tip, out.tip);
  EXPECT_EQ(without_rate.J, out.J);
  Situation at;
  at.tip = real(out.tip);
  at.J = real(out.J);
  at.Jd = real(out.Jd);
  return at;
}

struct ErasedArm {
  std::string name;
  int dof;
  double epsilon;
  Evaluate evaluate;
  Evaluate evaluate_in_double;  ///< For difference quotients, because float has too few digits.
};

void PrintTo(const ErasedArm& arm, std::ostream* out) {
  *out << arm.name;
}

template <int N, typename Scalar = double>
ErasedArm erased(const std::string& name, int dof = N) {
  return {name, dof, std::numeric_limits<Scalar>::epsilon(), &evaluate<PlanarArm<N, Scalar>>, &evaluate<PlanarArm<N>>};
}

std::vector<ErasedArm> arms() {
  constexpr int kOpen = Eigen::Dynamic;
  return {erased<2>("n2"),
          erased<3>("n3"),
          erased<4>("n4"),
          erased<5>("n5"),
          erased<6>("n6"),
          erased<7>("n7"),
          erased<8>("n8"),
          erased<9>("n9"),
          erased<10>("n10"),
          erased<kOpen>("dynamic_4", 4),
          erased<kOpen>("dynamic_12", 12),
          erased<kOpen>("dynamic_32", 32),
          erased<2, float>("n2_float"),
          erased<4, float>("n4_float"),
          erased<7, float>("n7_float"),
          erased<kOpen, float>("dynamic_32_float", 32)};
}

class PlanarKinematics : public ::testing::TestWithParam<ErasedArm> {
 protected:
  /// Calls check(lengths, q, qd) for random arms in random states.
  template <typename Check>
  static void everywhere(Check&& check) {
    const int n = GetParam().dof;
    for (std::uint32_t seed = 0; seed < 50; ++seed) {
      SCOPED_TRACE("seed " + std::to_string(seed));
      Random random(seed);
      const Eigen::VectorXd lengths = random.uniform(n, 0.1, 2.0);
      const Eigen::VectorXd q = random.uniform(n, -3.2, 3.2);
      check(lengths, q, random.uniform(n, -2.0, 2.0));
    }
  }
};

/// Tip, J and Jd are sums of n terms of known size. The round-off error of each term is the round-off error of its sum
/// of angles.
TEST_P(PlanarKinematics, equals_the_plain_formula) {
  everywhere([](const Eigen::VectorXd& lengths, const Eigen::VectorXd& q, const Eigen::VectorXd& qd) {
    const Situation out = GetParam().evaluate(lengths, q, qd);
    const Situation expected = planar_arm(real(lengths), real(q), real(qd));
    const auto tolerance = static_cast<Real>(GetParam().epsilon * lengths.sum() * (1.0 + q.cwiseAbs().sum()));
    const Real rate = 1 + static_cast<Real>(qd.cwiseAbs().sum());
    EXPECT_LE((out.tip - expected.tip).norm(), tolerance);
    EXPECT_LE((out.J - expected.J).cwiseAbs().maxCoeff(), tolerance);
    EXPECT_LE((out.Jd - expected.Jd).cwiseAbs().maxCoeff(), rate * tolerance);
  });
}

/// J is the derivative of f, and Jd the derivative of J along qd, by central differences.
TEST_P(PlanarKinematics, has_J_and_Jd_as_derivatives) {
  everywhere([](const Eigen::VectorXd& lengths, const Eigen::VectorXd& q, const Eigen::VectorXd& qd) {
    constexpr double kStep = 1e-5;
    const Situation out = GetParam().evaluate(lengths, q, qd);
    const auto at = [&](const Eigen::VectorXd& posture) { return GetParam().evaluate_in_double(lengths, posture, qd); };
    // Truncation error h²/6 · |f‴| and round-off error ε/h of the difference, and the round-off error of the arm.
    const double rate = 1.0 + qd.cwiseAbs().sum();
    const double own = GetParam().epsilon * (1.0 + q.cwiseAbs().sum());
    const auto tolerance = static_cast<Real>(lengths.sum() * (1e-9 * std::pow(rate, 3) + own * rate));
    for (Eigen::Index j = 0; j < q.size(); ++j) {
      const Eigen::VectorXd step = kStep * Eigen::VectorXd::Unit(q.size(), j);
      const RealVector slope = (at(q + step).tip - at(q - step).tip) / (2 * static_cast<Real>(kStep));
      EXPECT_LE((out.J.col(j) - slope).norm(), tolerance) << "column " << j;
    }
    const RealMatrix slope = (at(q + kStep * qd).J - at(q - kStep * qd).J) / (2 * static_cast<Real>(kStep));
    EXPECT_LE((out.Jd - slope).cwiseAbs().maxCoeff(), tolerance);
  });
}

/// Two adjacent entries of a vector, read and written together. Beyond the end of the vector, zero is read and
/// nothing is written.
template <int N, typename Scalar>
void expect_neighbours() {
  Vector<N, Scalar> from(5);
  for (int i = 0; i < 5; ++i) from(i) = Scalar(i + 1);
  Vector<N, Scalar> to = Vector<N, Scalar>::Zero(5);
  for (Eigen::Index i = 0; i < 5; ++i) {
    const Pair<Scalar> two = two_of(from, i);
    EXPECT_EQ(two.first(), from(i));
    EXPECT_EQ(two.second(), i < 4 ? from(i + 1) : Scalar(0));
    set_two_of(to, i, two);
    EXPECT_EQ(to.head(i + 1), from.head(i + 1));
    EXPECT_EQ(to.tail(5 - std::min<Eigen::Index>(i + 2, 5)).squaredNorm(), Scalar(0));
  }
}
TEST(Pair, holds_two_neighbours_of_a_vector) {
  expect_neighbours<5, double>();
  expect_neighbours<5, float>();
  expect_neighbours<5, long double>();
  expect_neighbours<Eigen::Dynamic, double>();
}

INSTANTIATE_TEST_SUITE_P(every, PlanarKinematics, ::testing::ValuesIn(arms()),
                         [](const auto& each) { return each.param.name; });

}  // namespace
}  // namespace fpbm::test::kinematics_laws
