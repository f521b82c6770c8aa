#include "fpbm/model/serial_arm.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <tuple>
#include <vector>

#include "fpbm/model/planar_arm.hpp"
#include "fpbm/scheme/schemes.hpp"
#include "support/random.hpp"
#include "support/textbook.hpp"

/// Serial arms, compared with finite differences, products of transforms and planar arms.
namespace fpbm::test::serial_arm_laws {
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

/// Central differences of the tip, by ⊖, and of J, along qd.
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
  expect_derivatives_of_random_chains<7>(7);
  for (const int dof : {1, 3, 9, kMaxDof}) expect_derivatives_of_random_chains<Eigen::Dynamic>(dof);
}

/// Column i of Jd is [wᵢ × lᵢ + aᵢ × uᵢ; wᵢ × aᵢ], where column i of J is [lᵢ; aᵢ] (docs/kinematics.md, "Time
/// derivative of J"). J is computed from the arm at q.
template <int N>
void expect_rate_from_columns(int dof) {
  Random random(static_cast<std::uint32_t>(dof));
  for (int trial = 0; trial < 50; ++trial) {
    SCOPED_TRACE("trial " + std::to_string(trial));
    const SerialArm<N> arm({random_chain(random, dof), random_transform(random)});
    const Vector<N> q = random.uniform(dof, -3.0, 3.0);
    const Vector<N> qd = random.uniform(dof, -1.0, 1.0);
    Kinematics<Pose, N> at_rest;
    Kinematics<Pose, N> moving;
    Kinematics<Position<3>, N> position;
    arm.kinematics(q, at_rest);
    arm.kinematics(q, qd, moving);
    arm.kinematics(q, qd, position);
    Matrix<6, N> rate(6, dof);
    for (int i = 0; i < dof; ++i) {
      const Vector<3> l = at_rest.J.col(i).template head<3>();
      const Vector<3> a = at_rest.J.col(i).template tail<3>();
      Vector<3> w = Vector<3>::Zero();
      Vector<3> u = Vector<3>::Zero();
      for (int j = 0; j <= i; ++j) w += qd(j) * at_rest.J.col(j).template tail<3>();
      for (int j = i + 1; j < dof; ++j) u += qd(j) * at_rest.J.col(j).template head<3>();
      rate.col(i) << cross(w, l) + cross(a, u), cross(w, a);
    }
    constexpr double kStep = 1e-6;
    Kinematics<Pose, N> before;
    Kinematics<Pose, N> after;
    arm.kinematics(Vector<N>(q - kStep * qd), before);
    arm.kinematics(Vector<N>(q + kStep * qd), after);
    EXPECT_LE((rate - (after.J - before.J) / (2 * kStep)).cwiseAbs().maxCoeff(), 1e-7);
    const double round_off = 1e-15 * at_rest.J.norm() * (1.0 + qd.norm());
    EXPECT_LE((moving.Jd - rate).cwiseAbs().maxCoeff(), round_off);
    EXPECT_LE((position.Jd - rate.template topRows<3>()).cwiseAbs().maxCoeff(), round_off);
  }
}

TEST(SerialArm, rate_of_J_follows_from_J_alone) {
  expect_rate_from_columns<1>(1);
  expect_rate_from_columns<6>(6);
  expect_rate_from_columns<7>(7);
  for (const int dof : {2, 3, 9, kMaxDof}) expect_rate_from_columns<Eigen::Dynamic>(dof);
}

/// An arm in another Scalar, or with N known at run time, is the same arm up to round-off.
template <int N, typename Scalar>
void expect_same_arm(const Chain<>& chain, Random& random) {
  const SerialArm<Eigen::Dynamic> arm(chain);
  const auto other = SerialArm<N>(chain).template cast<Scalar>();
  const Vector<N, Scalar> q = random.uniform(N, -3.0, 3.0).cast<Scalar>();
  const Vector<N, Scalar> qd = random.uniform(N, -1.0, 1.0).cast<Scalar>();
  Kinematics<Pose, Eigen::Dynamic> expected;
  Kinematics<Pose, N, Scalar> out;
  arm.kinematics(Vector<Eigen::Dynamic>(q.template cast<double>()), Vector<Eigen::Dynamic>(qd.template cast<double>()),
                 expected);
  other.kinematics(q, qd, out);
  const double round_off = 40.0 * std::max<double>(static_cast<double>(std::numeric_limits<Scalar>::epsilon()),
                                                   std::numeric_limits<double>::epsilon());
  EXPECT_LE((out.tip.p.template cast<double>() - expected.tip.p).norm(), round_off * (1.0 + expected.tip.p.norm()));
  EXPECT_LE((out.tip.R.template cast<double>() - expected.tip.R).norm(), round_off);
  EXPECT_LE((out.J.template cast<double>() - expected.J).norm(), round_off * expected.J.norm());
  EXPECT_LE((out.Jd.template cast<double>() - expected.Jd).norm(), round_off * expected.J.norm() * (1.0 + qd.norm()));
}

TEST(SerialArm, agrees_in_other_scalar_types) {
  Random random(9);
  for (int trial = 0; trial < 50; ++trial) {
    SCOPED_TRACE("trial " + std::to_string(trial));
    const Chain<> seven{random_chain(random, 7), random_transform(random)};
    const Chain<> four{random_chain(random, 4), random_transform(random)};
    expect_same_arm<7, double>(seven, random);
    expect_same_arm<7, float>(seven, random);
    expect_same_arm<4, long double>(four, random);
  }
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

/// J qdd + Jd qd is the acceleration that (13) commands, also for a pose.
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
  // At π, both signs of the rotation vector are correct.
  const Matrix<3, 3> half = rotation(Vector<3>(0.0, kHalfTurn, 0.0));
  EXPECT_NEAR(rotation_vector(half).cwiseAbs()(1), kHalfTurn, 1e-14);
}

/// The rotation vector of R_x R_yᵀ, computed without the matrix for small angles, equals the rotation vector of the
/// matrix.
template <typename Scalar>
void expect_the_vector_between() {
  const auto epsilon = static_cast<double>(std::numeric_limits<Scalar>::epsilon());
  Random random(8);
  for (const double angle : {0.0, 1e-12, 1e-5, 0.1, 0.24, 0.26, 1.5, 3.0, kHalfTurn - 1e-2}) {
    for (int trial = 0; trial < 50; ++trial) {
      const Vector<3> r = angle * Vector<3>(random.uniform(3, -1.0, 1.0)).normalized();
      const Matrix<3, 3, Scalar> y = rotation(Vector<3>(random.uniform(3, -1.8, 1.8))).cast<Scalar>();
      const Matrix<3, 3, Scalar> x = rotation(r).cast<Scalar>() * y;
      const Vector<3, Scalar> between = rotation_between(x, y);
      EXPECT_LE((between.template cast<double>() - r).norm(), epsilon * (5.0 + 40.0 * angle)) << angle;
      EXPECT_LE(static_cast<double>((between - rotation_vector<Scalar>(x * y.transpose())).norm()),
                epsilon * (2.0 + 20.0 * angle))
          << angle;
    }
  }
}
TEST(Rotation, between_two_is_that_of_their_quotient) {
  expect_the_vector_between<double>();
  expect_the_vector_between<float>();
}

TEST(SerialArm, of_a_chain_of_known_length_is_the_same) {
  Random random(11);
  for (int trial = 0; trial < 20; ++trial) {
    const Chain<> chain{random_chain(random, 7), random_transform(random)};
    Chain<double, 7> fixed;
    fixed.tip = chain.tip;
    for (std::size_t i = 0; i < 7; ++i) {
      const auto& [type, placement, axis, bounds, name, mimic, moved, drive] = chain.joints[i];
      fixed.joints[i] = {type, placement, axis, bounds, name, mimic, moved, drive};
    }
    const State<7> state{Vector<7>(random.uniform(7, -2.0, 2.0)), Vector<7>(random.uniform(7, -2.0, 2.0))};
    Kinematics<Pose, 7> a;
    SerialArm<7>(chain).kinematics(state.q, state.qd, a);
    for (const auto& arm : {SerialArm<7>(fixed), SerialArm<7>(Chain<>(fixed))}) {
      Kinematics<Pose, 7> b;
      arm.kinematics(state.q, state.qd, b);
      EXPECT_EQ(a.tip.p, b.tip.p);
      EXPECT_EQ(a.J, b.J);
      EXPECT_EQ(a.Jd, b.Jd);
      EXPECT_EQ(arm.limits().upper, SerialArm<7>(chain).limits().upper);
    }
  }
}

TEST(SerialArm, rejected_bounds_have_a_name_an_index_and_a_value) {
  const auto refused = [](auto change) {
    Chain<double, 2> chain;
    chain.joints[0].name = "elbow";
    change(chain.joints);
    try {
      const SerialArm<2> arm(chain);
    } catch (const ParameterError& error) {
      return std::tuple(std::string(error.what()), error.name(), error.index(), error.value());
    }
    return std::tuple(std::string("accepted"), std::string(), 0, 0.0);
  };
  EXPECT_EQ(refused([](auto& joints) { joints[1].bounds.lower = joints[1].bounds.upper = 0.5; }),
            std::tuple("joints[1].lower = 0.5: must be below upper = 0.5", "joints", 1, 0.5));
  EXPECT_EQ(refused([](auto& joints) { joints[0].bounds.jerk = -2.0; }),
            std::tuple("joint 'elbow'.jerk = -2: must be positive", "joint 'elbow'.jerk", -1, -2.0));
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  EXPECT_EQ(
      refused([](auto& joints) { joints[0].placement.p(1) = kInfinite; }),
      std::tuple("joint 'elbow'.placement.p[1] = inf: must be finite", "joint 'elbow'.placement.p", 1, kInfinite));
}

TEST(SerialArm, invalid_chains_are_rejected) {
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
  EXPECT_EQ(refusal(bad, {}), "joints[1].axis is zero: must be a nonzero vector");
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
}  // namespace fpbm::test::serial_arm_laws
