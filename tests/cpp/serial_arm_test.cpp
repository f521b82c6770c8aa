#include "fpbm/model/serial_arm.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "fpbm/model/planar_arm.hpp"
#include "fpbm/scheme/schemes.hpp"
#include "support/random.hpp"
#include "support/textbook.hpp"

/// Serial arms against finite differences, products of transforms and planar arms.
namespace fpbm::test {
namespace {

constexpr double kHalfTurn = 3.14159265358979323846;

Transform<> random_transform(Random& random) {
  return {Vector<3>(random.uniform(3, -0.5, 0.5)), rotation(Vector<3>(random.uniform(3, -1.8, 1.8)))};
}

std::vector<Joint<>> random_chain(Random& random, int dof) {
  std::vector<Joint<>> joints;
  for (int i = 0; i < dof; ++i) {
    const JointType type = random.uniform(0.0, 1.0) < 0.3 ? JointType::kPrismatic : JointType::kRevolute;
    joints.push_back({type, random_transform(random), Vector<3>(random.uniform(3, -1.0, 1.0))});
  }
  return joints;
}

/// Central differences of tip, by ⊖, and of J, along qd.
template <int N, typename Space>
void expect_derivatives(const SerialArm<N>& arm, const Vector<N>& q, const Vector<N>& qd) {
  constexpr double kStep = 1e-6;
  Kinematics<Space, N> here;
  Kinematics<Space, N> before;
  Kinematics<Space, N> after;
  arm.kinematics(q, qd, here);
  arm.kinematics(Vector<N>(q - kStep * qd), before);
  arm.kinematics(Vector<N>(q + kStep * qd), after);
  const Vector<Space::kRows> velocity = Space::template difference<double>(after.tip, before.tip) / (2 * kStep);
  EXPECT_LE((here.J * qd - velocity).cwiseAbs().maxCoeff(), 1e-7);
  EXPECT_LE((here.Jd - (after.J - before.J) / (2 * kStep)).cwiseAbs().maxCoeff(), 1e-7);

  Kinematics<Space, N> without_rate;
  arm.kinematics(q, without_rate);
  EXPECT_EQ(without_rate.J, here.J);
}

template <int N>
void expect_derivatives_of_random_chains(int dof) {
  Random random(static_cast<std::uint32_t>(dof));
  for (int trial = 0; trial < 50; ++trial) {
    SCOPED_TRACE("trial " + std::to_string(trial));
    const SerialArm<N> arm({random_chain(random, dof), random_transform(random)});
    const Vector<N> q = random.uniform(dof, -3.0, 3.0);
    const Vector<N> qd = random.uniform(dof, -1.0, 1.0);
    expect_derivatives<N, Position<3>>(arm, q, qd);
    expect_derivatives<N, Pose>(arm, q, qd);
  }
}

TEST(SerialArm, jacobians_are_derivatives) {
  expect_derivatives_of_random_chains<1>(1);
  expect_derivatives_of_random_chains<Eigen::Dynamic>(3);
  expect_derivatives_of_random_chains<7>(7);
  expect_derivatives_of_random_chains<Eigen::Dynamic>(9);
  expect_derivatives_of_random_chains<Eigen::Dynamic>(kMaxDof);
}

TEST(SerialArm, tip_is_the_product_of_its_transforms) {
  Random random(5);
  for (int trial = 0; trial < 50; ++trial) {
    const std::vector<Joint<>> joints = random_chain(random, 7);
    const Transform<> tip = random_transform(random);
    const Vector<7> q = random.uniform(7, -3.0, 3.0);
    Eigen::Matrix4d product = Eigen::Matrix4d::Identity();
    const auto multiply = [&product](const Vector<3>& p, const Matrix<3, 3>& R) {
      Eigen::Matrix4d factor = Eigen::Matrix4d::Identity();
      factor.topLeftCorner<3, 3>() = R;
      factor.topRightCorner<3, 1>() = p;
      product = (product * factor).eval();
    };
    for (int i = 0; i < 7; ++i) {
      const Joint<>& joint = joints[static_cast<std::size_t>(i)];
      const Vector<3> along = q(i) * joint.axis.normalized();
      multiply(joint.placement.p, joint.placement.R);
      if (joint.type == JointType::kRevolute) {
        multiply(Vector<3>::Zero(), rotation(along));
      } else {
        multiply(along, Matrix<3, 3>::Identity());
      }
    }
    multiply(tip.p, tip.R);
    Kinematics<Pose, 7> kinematics;
    SerialArm<7>({joints, tip}).kinematics(q, kinematics);
    EXPECT_LE((kinematics.tip.p - product.topRightCorner<3, 1>()).norm(), 1e-13);
    EXPECT_LE((kinematics.tip.R - product.topLeftCorner<3, 3>()).norm(), 1e-13);
  }
}

TEST(SerialArm, a_planar_arm_is_one) {
  constexpr int N = 4;
  const Vector<N> lengths{0.5, 1.0, 0.7, 0.3};
  std::vector<Joint<>> joints(N);
  for (int i = 1; i < N; ++i) joints[static_cast<std::size_t>(i)].placement.p(0) = lengths(i - 1);
  Transform<> tip;
  tip.p(0) = lengths(N - 1);
  const SerialArm<N> serial({joints, tip});
  const PlanarArm<N> planar(lengths);
  Random random(1);
  for (int trial = 0; trial < 50; ++trial) {
    const Vector<N> q = random.uniform(N, -3.0, 3.0);
    const Vector<N> qd = random.uniform(N, -1.0, 1.0);
    Kinematics<Position<3>, N> in_space;
    Kinematics<Position<2>, N> in_plane;
    serial.kinematics(q, qd, in_space);
    planar.kinematics(q, qd, in_plane);
    EXPECT_LE((in_space.tip.head<2>() - in_plane.tip).norm(), 1e-14);
    EXPECT_LE((in_space.J.topRows<2>() - in_plane.J).norm(), 1e-14);
    EXPECT_LE((in_space.Jd.topRows<2>() - in_plane.Jd).norm(), 1e-13);
    EXPECT_EQ(in_space.tip(2), 0.0);
  }
}

/// J qdd + Jd qd is the acceleration that (13) commands, for a pose too.
TEST(SerialArm, fpbm_gives_the_tip_its_commanded_acceleration) {
  constexpr int N = 7;
  Random random(3);
  for (int trial = 0; trial < 50; ++trial) {
    const SerialArm<N> arm({random_chain(random, N), random_transform(random)});
    const State<N> state{Vector<N>(random.uniform(N, -2.0, 2.0)), Vector<N>(random.uniform(N, -0.5, 0.5))};
    Kinematics<Pose, N> kinematics;
    arm.kinematics(state.q, state.qd, kinematics);
    if (singular_values(real(kinematics.J))(5) < 0.05L) continue;
    const Vector<6> away{0.02, -0.03, 0.01, 0.1, 0.2, -0.1};
    const Reference<Pose> reference{Pose::displace<double>(kinematics.tip, away), Vector<6>(random.uniform(6, -1, 1)),
                                    Vector<6>(random.uniform(6, -1, 1))};
    const auto scheme = FPBM<N>(0.6, Vector<N>(random.uniform(N, 1, 4)), 2.0, 5.0);
    Vector<N> qdd;
    ASSERT_EQ(scheme.resolve(kinematics, reference, state, qdd), Status::kOk);
    const Vector<6> tip_acceleration = kinematics.J * qdd + kinematics.Jd * state.qd;
    const Vector<6> commanded = reference.xdd + 2.0 * (reference.xd - kinematics.J * state.qd) + 5.0 * away;
    EXPECT_LE((tip_acceleration - commanded).norm(), 1e-9);
  }
}

TEST(Rotation, vector_and_matrix_are_inverse_to_each_other) {
  Random random(2);
  for (const double angle : {0.0, 1e-300, 1e-12, 1e-5, 0.1, 1.5, 3.0, kHalfTurn - 1e-5, kHalfTurn - 1e-9}) {
    for (int trial = 0; trial < 50; ++trial) {
      const Vector<3> r = angle * Vector<3>(random.uniform(3, -1.0, 1.0)).normalized();
      const Matrix<3, 3> R = rotation(r);
      EXPECT_LE((R.transpose() * R - Matrix<3, 3>::Identity()).norm(), 1e-14);
      EXPECT_NEAR(static_cast<double>(determinant(real(R))), 1.0, 1e-14);
      EXPECT_LE((rotation_vector(R) - r).norm(), 1e-14 + 2e-15 * angle) << angle;
      EXPECT_LE((R * r - r).norm(), 1e-14);
    }
  }
  // At π itself both signs are right.
  const Matrix<3, 3> half = rotation(Vector<3>(0.0, kHalfTurn, 0.0));
  EXPECT_NEAR(rotation_vector(half).cwiseAbs()(1), kHalfTurn, 1e-14);
}

TEST(SerialArm, bad_chains_are_refused) {
  const auto refusal = [](const std::vector<Joint<>>& joints, const Transform<>& tip) -> std::string {
    try {
      SerialArm<2>({joints, tip});
    } catch (const std::invalid_argument& refused) {
      return refused.what();
    }
    return "accepted";
  };
  const std::vector<Joint<>> good(2);
  EXPECT_EQ(refusal(good, {}), "accepted");
  EXPECT_EQ(refusal(std::vector<Joint<>>(3), {}), "joints has 3 entries: must have 2, one per joint");
  EXPECT_EQ(refusal({}, {}).substr(0, 20), "joints has 0 entries");
  std::vector<Joint<>> bad = good;
  bad[1].axis.setZero();
  EXPECT_EQ(refusal(bad, {}), "joints[1].axis is zero: must point somewhere");
  bad = good;
  bad[0].axis(2) = std::numeric_limits<double>::infinity();
  EXPECT_EQ(refusal(bad, {}), "joints[0].axis[2] = inf: must be finite");
  bad = good;
  bad[1].placement.R(0, 0) = 2.0;
  EXPECT_EQ(refusal(bad, {}), "joints[1].placement.R: must be a rotation matrix");
  bad[1].placement.R = -Matrix<3, 3>::Identity();
  EXPECT_EQ(refusal(bad, {}), "joints[1].placement.R: must be a rotation matrix");
  Transform<> tip;
  tip.p(1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(refusal(good, tip), "tip.p[1] = nan: must be finite");
}

}  // namespace
}  // namespace fpbm::test
