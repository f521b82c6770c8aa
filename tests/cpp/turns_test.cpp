#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <type_traits>
#include <vector>

#include "fpbm/realtime/stack_tracker.hpp"
#include "support/arms.hpp"
#include "support/compiled_tracker.hpp"

/// Positions of a continuous joint that differ by whole turns are equal: goals that differ by whole turns cause the
/// same motion.
namespace fpbm::test::turns_laws {
namespace {

constexpr int kOpen = Eigen::Dynamic;

/// Joints 1, 3, 5 and 7 of the Gen3 are continuous.
const Vector<7> kStart{0.4, 0.26, 3.0, -2.27, 0.2, 0.96, 1.57};
const Vector<7> kRest{0.2, 0.5, -2.9, -2.0, 0.4, 0.8, 1.0};

/// A posture with other turns of the joints in `joints`.
[[nodiscard]] Vector<7> turned(Vector<7> q, std::uint64_t joints, double turns = 1.0) {
  for (int i = 0; i < 7; ++i) {
    if ((joints >> i & 1U) != 0) q(i) += 2.0 * M_PI * turns * (i % 4 == 0 ? 1.0 : -1.0);
  }
  return q;
}

template <Level kLevel>
[[nodiscard]] auto scheme_of(const Vector<7>& rest) {
  const auto z = NullSpace<kOpen>().with_damping(kLevel == Level::kAcceleration ? 3.0 : 0.0).with_rest_posture(rest, 2);
  if constexpr (kLevel == Level::kAcceleration) {
    return FPBM<kOpen>(0.6, Vector<kOpen>(Vector<7>::Ones()), 10.0, 25.0, z);
  } else {
    return WMVN<kOpen>(Vector<kOpen>(Vector<7>::Ones()), 5.0, z);
  }
}

template <Level kLevel>
[[nodiscard]] std::vector<Vector<7>> motion_to(const Vector<7>& rest, double tick) {
  TrackerOptions<> options;
  options.dt = tick;
  CompiledTracker tracker(any_arm(presets::gen3()), Pose{}, scheme_of<kLevel>(rest), Vector<kOpen>(kStart), options);
  Transform<> target = tracker.tip();
  target.p(1) += 0.1;
  std::vector<Vector<7>> motion;
  for (int i = 0; i < 3.0 / tick; ++i) motion.emplace_back(tracker.tick(Reference<Pose>::hold(target)).q);
  return motion;
}

template <Level kLevel>
void rest_postures_are_modulo_turns() {
  const JointBits continuous = 0b1010101;
  ASSERT_EQ(SerialArm<7>(presets::gen3()).limits().continuous, continuous);
  for (const double tick : {1e-3, 4e-3, 2e-2}) {
    const auto expected = motion_to<kLevel>(kRest, tick);
    double farthest = 0.0;
    for (const Vector<7>& q : expected) farthest = std::max(farthest, (q - kStart).cwiseAbs().maxCoeff());
    EXPECT_GT(farthest, 0.1);
    EXPECT_LT(farthest, M_PI);  // Without a whole turn: joint 3 rests at 2π − 2.9.
    for (const JointBits joints : {JointBits(1), JointBits(0b100), JointBits(0b1000000), continuous}) {
      for (const double turns : {1.0, -3.0}) {
        const auto motion = motion_to<kLevel>(turned(kRest, joints, turns), tick);
        for (std::size_t i = 0; i < motion.size(); ++i) {
          ASSERT_LE((motion[i] - expected[i]).cwiseAbs().maxCoeff(), 1e-9) << "tick " << tick << ", sample " << i;
        }
      }
    }
  }
}

TEST(Turns, of_a_rest_posture_do_not_count_at_acceleration_level) {
  rest_postures_are_modulo_turns<Level::kAcceleration>();
}
TEST(Turns, of_a_rest_posture_do_not_count_at_velocity_level) {
  rest_postures_are_modulo_turns<Level::kVelocity>();
}

TEST(Turns, of_a_rest_posture_do_not_count_in_a_rollout) {
  const Vector<4> start{0.3, 0.4, 0.5, 0.6};
  const PlanarArm<4> arm(Vector<4>::Ones());
  const Path circle(Circle<double>(0.3), 2.0, SinSquared{});
  const auto last = [&](const Vector<4>& rest) {
    const auto z = NullSpace<4>().with_damping(2.0).with_rest_posture(rest, 1.0);
    const auto scheme = FPBM<4>(0.6, Vector<4>(Vector<4>::Ones()), 10.0, 25.0, z);
    const State<4> at_rest{start, Vector<4>::Zero()};
    return rollout(arm, circle, scheme, at_rest, TimeGrid<double>(2.0, 1e-2), [](const auto&) noexcept {}).last.q;
  };
  const Vector<4> expected = last(start);
  EXPECT_LE((last(start + Vector<4>(2.0 * M_PI, 0.0, -4.0 * M_PI, 2.0 * M_PI)) - expected).cwiseAbs().maxCoeff(), 1e-9);
}

template <Level kLevel, typename Posture>
void posture_tasks_are_modulo_turns(const Posture& posture) {
  const auto motion_to = [&](const Vector<7>& goal, double tick) {
    TrackerOptions<> options;
    options.dt = tick;
    const Robot<7> robot(presets::gen3());
    const auto acceleration = Balanced<7>(0.0, UnitWeights{}, NullSpace<7>().with_damping(2.0));
    std::vector<Vector<7>> motion;
    const auto run = [&](auto tracker) {
      using Space = typename std::decay_t<decltype(tracker)>::Target;
      auto reference = Space::hold(tracker.tip());
      auto& x = std::get<std::tuple_size_v<std::decay_t<decltype(reference.x)>> - 1>(reference.x);
      for (int i = 0; i < 7; ++i) x(i) = goal(i);
      for (int i = 0; i < 4.0 / tick; ++i) motion.push_back(tracker.tick(reference).q);
    };
    if constexpr (kLevel == Level::kAcceleration) {
      run(stack_tracker(robot, Stack(PositionTask<>{{Robot<7>::kTip}, TaskGains<>(10.0, 25.0)}, posture), acceleration,
                        kStart, options));
    } else {
      run(stack_tracker(robot, Stack(PositionTask<>{{Robot<7>::kTip}, TaskGains<>(5.0)}, posture), MVN<7>(), kStart,
                        options));
    }
    return motion;
  };
  const JointBits continuous = 0b1010101;
  for (const double tick : {1e-3, 4e-3, 2e-2}) {
    const auto expected = motion_to(kRest, tick);
    for (const auto& q : expected) EXPECT_LT((q - kStart).cwiseAbs().maxCoeff(), M_PI);
    for (const double turns : {1.0, -2.0}) {
      const auto motion = motion_to(turned(kRest, continuous, turns), tick);
      for (std::size_t i = 0; i < motion.size(); ++i) {
        ASSERT_LE((motion[i] - expected[i]).cwiseAbs().maxCoeff(), 1e-9) << "tick " << tick << ", sample " << i;
      }
    }
  }
}

TEST(Turns, of_a_posture_task_do_not_count_at_acceleration_level) {
  posture_tasks_are_modulo_turns<Level::kAcceleration>(PostureTask<7>{TaskGains<>(4.0, 4.0)});
}
TEST(Turns, of_a_posture_task_do_not_count_at_velocity_level) {
  posture_tasks_are_modulo_turns<Level::kVelocity>(PostureTask<7>{TaskGains<>(2.0)});
}

/// Limits of a tracker may bound a continuous joint. Then its positions are not modulo turns.
TEST(Turns, count_for_bounded_joints) {
  const SerialArm<7> arm(presets::gen3());
  JointLimits<7> bounds = arm.limits();
  EXPECT_EQ(continuous_joints(arm, bounds), JointBits(0b1010101));
  bounds.lower(2) = -10.0;
  bounds.upper(6) = 10.0;
  EXPECT_EQ(continuous_joints(arm, bounds), JointBits(0b0010001));
  EXPECT_EQ(SerialArm<7>(presets::panda()).limits().continuous, JointBits(0));
  Chain<> rail = panda_on_rail();
  for (auto& joint : rail.joints) joint.bounds.lower = -JointBounds<>::kNone, joint.bounds.upper = JointBounds<>::kNone;
  EXPECT_EQ(SerialArm<8>(rail).limits().continuous, JointBits(0b11111110));  // Joint 1 is prismatic.
}

/// A turn of a drive leaves the posture unchanged only if all mimic joints rotate by whole turns, too.
TEST(Turns, of_a_drive_move_its_mimic_joints) {
  const auto continuous = [](double ratio, JointType type, bool bounded) {
    Chain<> chain = presets::gen3();
    for (auto& joint : chain.joints)
      joint.bounds.lower = -JointBounds<>::kNone, joint.bounds.upper = JointBounds<>::kNone;
    chain.joints[6].mimic = {0, ratio, 0.3};
    chain.joints[6].type = type;
    if (bounded) chain.joints[6].bounds.upper = 3.0;
    return CoupledArm<6>(chain).limits().continuous;
  };
  EXPECT_EQ(continuous(2.0, JointType::kContinuous, false), JointBits(0b111111));
  EXPECT_EQ(continuous(-1.0, JointType::kRevolute, false), JointBits(0b111111));
  EXPECT_EQ(continuous(0.5, JointType::kContinuous, false), JointBits(0b111110));
  EXPECT_EQ(continuous(1.0, JointType::kPrismatic, false), JointBits(0b111110));
  EXPECT_EQ(continuous(1.0, JointType::kRevolute, true), JointBits(0b111110));
  EXPECT_EQ(continuous(0.0, JointType::kRevolute, true), JointBits(0b111111));
}

/// A stalled arm returns to a remembered posture without whole turns.
TEST(Turns, do_not_count_in_a_recovery) {
  const Vector<7> q = kStart;
  Recovery<Position<3>, 7> recovery(q, 2.0, 1e-3, 0b1010101);
  recovery.remember(turned(kRest, 0b1010101, 2.0), Vector<3>::Zero(), 1.0);
  ASSERT_TRUE(recovery.begin(q, Vector<3>::Zero(), 1.0, 1.0));
  const Limits<Level::kVelocity, 7> limits(SerialArm<7>(presets::gen3()).limits(), 1e-3);
  const Vector<7> rates = recovery.motion(limits, State<7>{q, Vector<7>::Zero()});
  Vector<7> gap = kRest - q;
  gap(2) += 2.0 * M_PI;
  EXPECT_LE((rates / rates.norm() - gap / gap.norm()).norm(), 1e-9);
}

}  // namespace
}  // namespace fpbm::test::turns_laws
