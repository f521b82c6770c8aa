#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <type_traits>

#include "fpbm/fpbm.hpp"
#include "support/random.hpp"
#include "support/recording.hpp"

/// Task spaces, with arms and rollouts in each.
namespace fpbm::test::spaces_laws {
namespace {

constexpr double kPi = kTwoPi / 2;

TEST(Spaces, difference_and_displace_are_inverse_to_each_other) {
  Random random(1);
  for (const double size : {1e-12, 1e-6, 0.1, 1.0, 3.0}) {
    for (int trial = 0; trial < 100; ++trial) {
      const Transform<> y{Vector<3>(random.uniform(3, -1, 1)), rotation(Vector<3>(random.uniform(3, -1.8, 1.8)))};
      Vector<6> d = random.uniform(6, -1, 1);
      d.tail<3>() *= size / d.tail<3>().norm();
      const Transform<> x = Pose::displace<double>(y, d);
      EXPECT_LE((Pose::difference<double>(x, y) - d).norm(), 1e-14);

      const Vector<3> planar = random.uniform(3, -1, 1);
      const Vector<3> displacement{0.3, -0.2, std::min(size, 3.1)};
      const Vector<3> moved = PlanarPose::displace<double>(planar, displacement);
      EXPECT_LE((PlanarPose::difference<double>(moved, planar) - displacement).norm(), 1e-15);
    }
  }
}

/// Near half a turn, the error is near π and along the axis, to the last digits. At π, the sign of the error
/// may change.
TEST(Spaces, orientation_error_is_good_up_to_half_a_turn) {
  Random random(2);
  for (const double short_of : {1e-1, 1e-4, 1e-8, 1e-12}) {
    for (int trial = 0; trial < 100; ++trial) {
      const Vector<3> axis = Vector<3>(random.uniform(3, -1, 1)).normalized();
      const Matrix<3, 3> R = rotation(Vector<3>(random.uniform(3, -1.8, 1.8)));
      const Transform<> x{Vector<3>::Zero(), rotation(Vector<3>((kPi - short_of) * axis)) * R};
      const Vector<3> e = Pose::difference<double>(x, {Vector<3>::Zero(), R}).tail<3>();
      // Within round-off of π, both signs of e are the same rotation.
      const double sign = e.dot(axis) > 0.0 || short_of > 1e-10 ? 1.0 : -1.0;
      EXPECT_LE((e - sign * (kPi - short_of) * axis).norm(), 1e-13) << short_of;
      EXPECT_NEAR(e.norm(), kPi - short_of, 1e-14);
    }
  }
}

TEST(Spaces, planar_angles_take_the_shorter_direction) {
  EXPECT_NEAR(PlanarPose::difference<double>({0, 0, 3.0}, {0, 0, -3.0})(2), 6.0 - kTwoPi, 1e-15);
  EXPECT_NEAR(PlanarPose::difference<double>({0, 0, 40.0}, {0, 0, 1.0})(2), 39.0 - 6 * kTwoPi, 1e-14);
}

TEST(PlanarArm, has_a_pose) {
  const PlanarArm<5> arm({0.5, 1.0, 0.7, 0.3, 0.4});
  Random random(3);
  for (int trial = 0; trial < 50; ++trial) {
    const Vector<5> q = random.uniform(5, -3, 3);
    const Vector<5> qd = random.uniform(5, -1, 1);
    Kinematics<Position<2>, 5> position;
    Kinematics<PlanarPose, 5> pose;
    arm.kinematics(q, qd, position);
    arm.kinematics(q, qd, pose);
    EXPECT_EQ(pose.tip.head<2>(), position.tip);
    EXPECT_NEAR(pose.tip(2), q.sum(), 1e-14);
    EXPECT_EQ(pose.J.topRows<2>(), position.J);
    EXPECT_EQ(pose.Jd.topRows<2>(), position.Jd);
    EXPECT_EQ(pose.J.row(2), (Matrix<1, 5>::Ones()));
    EXPECT_EQ(pose.Jd.row(2), (Matrix<1, 5>::Zero()));
  }
}

/// The column of J of a mimic joint is added to the column of its leader, and J and Jd are the derivatives.
TEST(CoupledArm, moves_its_mimic_joints) {
  Chain<> chain = presets::panda();
  chain.joints[3].mimic = {1, -2.0, 0.4};
  chain.joints[5].mimic = {1, 0.5, 0.0};
  const CoupledArm<5> arm(chain);
  const CoupledArm<Eigen::Dynamic> dynamic(chain);
  EXPECT_EQ(arm.dof(), 5);
  EXPECT_EQ(arm.limits().upper(2), chain.joints[2].bounds.upper);
  EXPECT_EQ(arm.limits().upper(3), chain.joints[4].bounds.upper);
  const SerialArm<7> whole(presets::panda());
  Random random(4);
  for (int trial = 0; trial < 50; ++trial) {
    const Vector<5> q = random.uniform(5, -2, 2);
    const Vector<5> qd = random.uniform(5, -1, 1);
    const Vector<7> all{q(0), q(1), q(2), 0.4 - 2.0 * q(1), q(3), 0.5 * q(1), q(4)};
    Kinematics<Pose, 5> here;
    Kinematics<Pose, 5> before;
    Kinematics<Pose, 5> after;
    Kinematics<Pose, 7> reference;
    constexpr double kStep = 1e-6;
    arm.kinematics(q, qd, here);
    arm.kinematics(Vector<5>(q - kStep * qd), before);
    arm.kinematics(Vector<5>(q + kStep * qd), after);
    whole.kinematics(all, reference);
    EXPECT_LE((here.tip.p - reference.tip.p).norm() + (here.tip.R - reference.tip.R).norm(), 1e-14);
    EXPECT_LE((here.J * qd - Pose::difference<double>(after.tip, before.tip) / (2 * kStep)).norm(), 1e-8);
    EXPECT_LE((here.Jd - (after.J - before.J) / (2 * kStep)).norm(), 1e-7);
    Kinematics<Pose, Eigen::Dynamic> open;
    dynamic.kinematics(q, qd, open);
    EXPECT_EQ(open.J, here.J);
    EXPECT_EQ(open.Jd, here.Jd);
  }
  const auto refusal = [](const Chain<>& bad) -> std::string {
    try {
      CoupledArm<Eigen::Dynamic>{bad};
    } catch (const std::invalid_argument& refused) {
      return refused.what();
    }
    return "accepted";
  };
  chain.joints[5].mimic.joint = 3;
  EXPECT_EQ(refusal(chain), "joint 'panda_joint6'.mimic.joint = 3: must be the index of a joint with its own drive");
  chain.joints[5].mimic.joint = 9;
  EXPECT_EQ(refusal(chain), "joint 'panda_joint6'.mimic.joint = 9: must be the index of a joint with its own drive");
  EXPECT_THROW(SerialArm<7>{chain}, std::invalid_argument);
}

/// The Panda holds its orientation along a circle, or rotates, for 10 s at 1 kHz.
TEST(PoseTask, is_tracked_from_a_consistent_start) {
  const SerialArm<7> arm(presets::panda());
  const State<7> start{{0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785}, Vector<7>::Zero()};
  const DiagonalWeights<7> weights({1, 1, 1, 1, 2, 2, 2});
  const auto fpbm = FPBM<7>(0.6, weights, 10.0, 25.0, NullSpace<7>{}.with_damping(2.0));
  const Vector<7> ones = Vector<7>::Ones();  // MVN and MAN are WMVN and the balance with equal weights.
  const auto expect_tracked = [&](const auto& path, const auto& scheme) {
    double position = 0.0;
    double turn = 0.0;
    const auto run = recorded(arm, AnyPath<Pose>(path), scheme, start, TimeGrid<>(10.0, 1e-3));
    for (const auto& sample : run.samples) {
      position = std::max(position, sample.error.template head<3>().norm());
      turn = std::max(turn, sample.error.template tail<3>().norm());
    }
    EXPECT_EQ(run.result.status, Status::kOk);
    EXPECT_LE(position, 1e-9);
    EXPECT_LE(turn, 1e-9);
  };
  const InPlane circle(Path(Circle(0.1), 10.0), Vector<3>::UnitY(), Vector<3>::UnitZ());
  expect_tracked(WithRotation(circle), fpbm);
  expect_tracked(WithRotation(circle, Vector<3>(0.2, -0.3, 0.8)), fpbm);
  expect_tracked(WithRotation(circle, Vector<3>(0.2, -0.3, 0.8)), WMVN<7>(ones));
  expect_tracked(WithRotation(circle, Vector<3>(0.2, -0.3, 0.8)), WMVN<7>(weights));
  expect_tracked(WithRotation(circle), Balanced<7>(0.0, ones));
}

/// From any start, a motion along an unreachable path ends before it leaves the ball of all flange positions. The tip
/// is never farther from its reference than one step, and every sample is finite.
TEST(PoseTask, that_leaves_the_workspace_ends) {
  const SerialArm<7> arm(presets::panda());
  const JointLimits<7>& limits = arm.limits();
  constexpr double kReach = 1.2;  // Longer than the sum of all links, from the shoulder at 0.333 m.
  Random random(7);
  const auto expect_end = [&](const auto& scheme, const auto& path, double speed) {
    State<7> start{Vector<7>::Zero(), Vector<7>::Zero()};
    for (Eigen::Index i = 0; i < 7; ++i) start.q(i) = random.uniform(limits.lower(i), limits.upper(i));
    constexpr double kStep = 2e-3;
    double worst = 0.0;
    bool finite = true;
    double away = 0.0;
    using Space = typename std::decay_t<decltype(path)>::Space;
    const auto run = recorded(arm, AnyPath<Space>(path), scheme, start, TimeGrid<>(4.0, kStep));
    for (const auto& sample : run.samples) {
      finite = finite && sample.q.allFinite() && sample.qd.allFinite() && sample.qdd.allFinite();
      worst = std::max(worst, sample.error.template head<3>().norm());
      if constexpr (std::is_same_v<Space, Pose>) {
        away = (sample.reference.x.p - Vector<3>(0, 0, 0.333)).norm();
      } else {
        away = (sample.reference.x - Vector<3>(0, 0, 0.333)).norm();
      }
    }
    EXPECT_NE(run.result.status, Status::kOk);
    EXPECT_TRUE(finite);
    EXPECT_LE(away, kReach);
    EXPECT_LE(worst, kStep * speed);
  };
  for (int trial = 0; trial < 40; ++trial) {
    SCOPED_TRACE("trial " + std::to_string(trial));
    const Vector<3> displacement = 3.0 * Vector<3>(random.uniform(3, -1, 1)).normalized();
    const Path line(Line<3>(displacement), 4.0);
    const double speed = kPi / 2 * displacement.norm() / 4.0;
    const DiagonalWeights<7> weights(Vector<7>(random.uniform(7, 1, 4)));
    const WithRotation turned(line, Vector<3>(random.uniform(3, -1, 1)));
    const Vector<7> ones = Vector<7>::Ones();
    expect_end(WMVN<7>(ones), line, speed);
    expect_end(Balanced<7>(0.0, ones), line, speed);
    expect_end(WMVN<7>(weights, 5.0), turned, speed);
    expect_end(Balanced<7>(0.0, ones), turned, speed);
    expect_end(FPBM<7>(0.6, weights, 10.0, 25.0, NullSpace<7>{}.with_damping(2.0)), turned, speed);
  }
}

/// From a start at rest, with errors of 0.6 rad and 5 cm: position errors satisfy ë + k₁ė + k₂e = 0, and so do
/// orientation errors if the target is at rest. If the target rotates, the orientation error decays at the same rate.
TEST(PoseTask, converges_at_the_rate_of_its_gains) {
  using Arm = SerialArm<7>;
  using Scheme = AccelerationScheme<7>;
  using Loop = ClosedLoop<Arm, Scheme, Pose>;
  const Arm arm(presets::panda());
  const double k1 = 7.0;
  const double k2 = 10.0;  // Roots −2 and −5.
  const Scheme scheme = FPBM<7>(0.6, DiagonalWeights<7>(Vector<7>::Ones()), k1, k2, NullSpace<7>{}.with_damping(2.0));
  for (const double rate : {0.0, 0.4}) {
    Loop loop{arm, scheme, {}, {}, Vector<7>::Zero()};
    Loop::X x = Loop::X::Zero();
    x.col(0) << 0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785;
    arm.kinematics(Vector<7>(x.col(0)), loop.kinematics);
    const Vector<6> e0 = (Vector<6>() << 0.03, -0.02, 0.04, 0.3, -0.2, 0.48).finished();
    const Transform<> target = Pose::displace<double>(loop.kinematics.tip, e0);
    const Vector<3> axis = rate * Vector<3>(0.6, 0.0, 0.8);
    const auto reference = [&](double t) {
      Reference<Pose> at = Reference<Pose>::hold(target);
      at.x.R = rotation(Vector<3>(t * axis)) * target.R;
      at.xd.tail<3>() = axis;
      return at;
    };
    const auto derivative = [&](double t, const Loop::X& at, Loop::X& dx) noexcept {
      return loop.evaluate(reference(t), at, dx);
    };
    constexpr double kStep = 1e-3;
    for (int i = 0; i < 3000; ++i) {
      ASSERT_EQ(RK4::step(derivative, i * kStep, kStep, x), Status::kOk);
      const double t = (i + 1) * kStep;
      arm.kinematics(Vector<7>(x.col(0)), loop.kinematics);
      const Vector<6> e = Pose::difference<double>(reference(t).x, loop.kinematics.tip);
      const double fading = (5.0 * std::exp(-2.0 * t) - 2.0 * std::exp(-5.0 * t)) / 3.0;
      ASSERT_LE((e.head<3>() - fading * e0.head<3>()).norm(), 1e-9) << t;
      if (rate == 0.0) {
        ASSERT_LE((e.tail<3>() - fading * e0.tail<3>()).norm(), 1e-9) << t;
      } else {
        // The initial ė is the angular velocity of the target.
        ASSERT_LE(e.tail<3>().norm(), 2.0 * (e0.tail<3>().norm() + rate / 2) * std::exp(-2.0 * t)) << t;
      }
    }
  }
}

}  // namespace
}  // namespace fpbm::test::spaces_laws
