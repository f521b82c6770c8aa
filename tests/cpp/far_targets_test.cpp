#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>

#include "support/arms.hpp"
#include "support/compiled_tracker.hpp"

/// If the target is unreachable, the arm moves as near to the target as it can, and stops.
namespace fpbm::test::far_targets_laws {
namespace {

constexpr int N = Eigen::Dynamic;
constexpr int kSeconds = 40;
/// Number of targets for each arm (docs/limits.md, Measurements).
const int kTargets = trials(6, 3);

/// The limits of an arm, reduced to finite bounds for each joint.
[[nodiscard]] JointLimits<N> bounded(JointLimits<N> limits, double acceleration) {
  for (Eigen::Index i = 0; i < limits.lower.size(); ++i) {
    limits.lower(i) = std::max(limits.lower(i), -2.8);
    limits.upper(i) = std::min(limits.upper(i), 2.8);
    limits.velocity(i) = std::min(limits.velocity(i), 2.0);
    limits.acceleration(i) = acceleration;
  }
  return limits;
}

struct Outcome {
  double speed;   ///< Speed of any joint in the last two seconds [rad/s].
  int reversals;  ///< Sign changes of the acceleration of any joint from tick to tick.
};

template <typename Space, typename Arm, typename Scheme>
[[nodiscard]] Outcome reach_for(const Arm& arm, const Scheme& scheme, const JointLimits<N>& bounds, Random& random) {
  const Limits<Scheme::kLevel, N> limits(bounds, 1e-3);
  Vector<N> q0 = bounds.lower;
  for (Eigen::Index i = 0; i < q0.size(); ++i) {
    const double share = random.uniform(0.2, 0.8);
    q0(i) += share * (bounds.upper(i) - bounds.lower(i));
  }
  CompiledTracker tracker(arm, Space{}, scheme, State<N>{q0, Vector<N>::Zero(q0.size())}, {}, limits);
  Kinematics<Space, N> kinematics;
  arm.kinematics(q0, kinematics);
  constexpr int kLengths = Space::kRows - Space::kTurns;
  Vector<Space::kRows> away = Vector<Space::kRows>::Zero();
  const Eigen::VectorXd direction = random.uniform(kLengths, -1.0, 1.0).normalized();
  away.template head<kLengths>() = kinematics.length * random.uniform(0.5, 2.0) * direction;
  const auto reference = Reference<Space>::hold(Space::template displace<double>(tracker.tip(), away));
  Outcome outcome{0.0, 0};
  Vector<N> before = Vector<N>::Zero(q0.size());
  for (int i = 0; i < 1000 * kSeconds; ++i) {
    const auto tick = tracker.tick(reference);
    if (i < 1000 * (kSeconds - 2)) continue;
    outcome.speed = std::max(outcome.speed, tick.qd.cwiseAbs().maxCoeff());
    outcome.reversals += (tick.qdd.array() * before.array() < -1.0).any() ? 1 : 0;
    before = tick.qdd;
  }
  return outcome;
}

/// Accelerations from 2 to 40 rad/s².
template <typename Space, typename Arm>
void check(const std::string& name, const Arm& arm) {
  double worst = 0.0;
  for (int k = 0; k < kTargets; ++k) {
    SCOPED_TRACE(name + ", target " + std::to_string(k));
    Random random(static_cast<std::uint32_t>(k));
    const auto bounds = bounded(arm.limits(), 2.0 * std::pow(20.0, random.uniform(0.0, 1.0)));
    const Vector<N> middle = 0.5 * (bounds.lower + bounds.upper);
    const auto free = NullSpace<N>{}.with_damping(2.0);
    const auto posture = NullSpace<N>{}.with_damping(4.0).with_rest_posture(middle, 4.0);
    const auto resting = NullSpace<N>{}.with_rest_posture(middle, 1.0);
    const double alpha = random.uniform(0.0, 1.0);
    const Vector<N> weights = random.uniform(arm.dof(), 0.5, 5.0);
    const Outcome outcome =
        k % 3 == 0   ? reach_for<Space>(arm, FPBM<N>(alpha, weights, 10.0, 25.0, free), bounds, random)
        : k % 3 == 1 ? reach_for<Space>(arm, FPBM<N>(alpha, weights, 20.0, 100.0, posture), bounds, random)
                     : reach_for<Space>(arm, WMVN<N>(weights, 5.0, resting), bounds, random);
    EXPECT_LE(outcome.speed, 1e-3);
    EXPECT_LE(outcome.reversals, 20);
    worst = std::max(worst, outcome.speed);
  }
  std::printf("%s: %d targets, %d s: at most %.1e rad/s at the end\n", name.c_str(), kTargets, kSeconds, worst);
}

TEST(FarTargets, end_at_rest_in_the_plane) {
  for (int n = 2; n <= 4; ++n) check<Position<2>>("planar " + std::to_string(n), any_planar_arm(Vector<N>::Ones(n)));
}
TEST(FarTargets, end_at_rest_in_space) {
  check<Pose>("Panda, pose", any_arm(presets::panda()));
  check<Position<3>>("Panda, position", any_arm(presets::panda()));
  check<Pose>("UR5e, pose", any_arm(presets::ur5e()));
  check<Position<3>>("iiwa 14, position", any_arm(presets::iiwa14()));
}

/// Whether a tracker from q0 is at the target within 40 s.
template <typename Space, typename Arm, typename Scheme>
[[nodiscard]] bool reaches(const Arm& arm, const Scheme& scheme, const JointLimits<N>& bounds, const Vector<N>& q0,
                           const typename Space::template Point<double>& x, double stall_time) {
  TrackerOptions<> options;
  options.stall_time = stall_time;
  const Limits<Scheme::kLevel, N> limits(bounds, options.dt);
  CompiledTracker tracker(arm, Space{}, scheme, State<N>{q0, Vector<N>::Zero(q0.size())}, options, limits);
  for (int i = 0; i < 1000 * kSeconds; ++i) {
    if (tracker.tick(Reference<Space>::hold(x)).error.norm() < 1e-6) return true;
  }
  return false;
}

/// Targets are tips of random postures, also with small velocities. If an arm without stall detection reaches a target,
/// the arm with stall detection reaches the target too.
template <typename Space, typename Arm>
void expect_no_target_lost(const Arm& arm) {
  for (int k = 0; k < kTargets; ++k) {
    SCOPED_TRACE(k);
    Random random(static_cast<std::uint32_t>(1000 + k));
    auto bounds = bounded(arm.limits(), 2.0 * std::pow(20.0, random.uniform(0.0, 1.0)));
    if (k % 4 == 3) bounds.velocity.setConstant(0.1);
    const Vector<N> range = bounds.upper - bounds.lower;
    const Vector<N> q0 = bounds.lower + random.uniform(arm.dof(), 0.1, 0.9).cwiseProduct(range);
    const Vector<N> there = bounds.lower + random.uniform(arm.dof(), 0.02, 0.98).cwiseProduct(range);
    Kinematics<Space, N> kinematics;
    arm.kinematics(there, kinematics);
    const auto reached = [&](const auto& scheme, double stall_time) {
      return reaches<Space>(arm, scheme, bounds, q0, kinematics.tip, stall_time);
    };
    const auto expect_same = [&](const auto& scheme) {
      if (reached(scheme, std::numeric_limits<double>::infinity())) {
        EXPECT_TRUE(reached(scheme, TrackerOptions<>().stall_time));
      }
    };
    const Vector<N> weights = random.uniform(arm.dof(), 0.5, 5.0);
    expect_same(FPBM<N>(0.6, weights, 4.0, 4.0, NullSpace<N>{}.with_damping(2.0)));
    expect_same(WMVN<N>(weights, 2.0));
  }
}

TEST(FarTargets, do_not_include_reachable_targets) {
  for (int n = 2; n <= 4; ++n) expect_no_target_lost<Position<2>>(any_planar_arm(Vector<N>::Ones(n)));
  expect_no_target_lost<Position<3>>(any_arm(presets::panda()));
  expect_no_target_lost<Pose>(any_arm(presets::panda()));
  expect_no_target_lost<Pose>(any_arm(presets::ur5e()));
}

/// Two links of 1 m, with a target 1 m beyond the workspace.
struct Stall : ::testing::Test {
  static constexpr double kTick = 1e-3;

  [[nodiscard]] static auto loop(const TrackerOptions<>& options = {}) {
    auto bounds = JointLimits<N>::none(2);
    for (int i = 0; i < 2; ++i) bounds.set(i, {-2.5, 2.5, 2.0, 10.0});
    const Vector<N> ones = Vector<N>::Ones(2);
    const auto scheme = FPBM<N>(0.6, ones, 10.0, 25.0, NullSpace<N>{}.with_damping(2.0));
    const State<N> start{Vector<2>(0.5, 1.0), Vector<2>::Zero()};
    const Limits<Level::kAcceleration, N> limits(bounds, kTick);
    return CompiledTracker(any_planar_arm(ones), Position<2>{}, scheme, start, options, limits);
  }

  template <typename Loop>
  static auto ticks(Loop& tracker, const Vector<2>& x, double seconds) {
    auto tick = tracker.tick(Reference<Position<2>>::hold(x));
    for (int i = 1; i < seconds / kTick; ++i) tick = tracker.tick(Reference<Position<2>>::hold(x));
    return tick;
  }

  const Vector<2> beyond{3.0, 0.0};
};

TEST_F(Stall, lasts_until_the_target_moves) {
  auto tracker = loop();
  const auto tick = ticks(tracker, beyond, 40.0);
  EXPECT_EQ(tick.status, Status::kStalled);
  EXPECT_EQ(tick.scale, 0.0);
  EXPECT_EQ(tick.qd, Vector<2>(0.0, 0.0));
  EXPECT_LT(tick.error.norm(), 1.01);
  for (int i = 0; i < 100; ++i) {
    const Vector<2> unsteady = beyond + Vector<2>(0.0, i % 2 ? 1e-3 : -1e-3);
    ASSERT_EQ(ticks(tracker, unsteady, kTick).q, tick.q);
  }
  EXPECT_EQ(ticks(tracker, Vector<2>(0.5, 1.2), 20.0).status, Status::kOk);
  EXPECT_LT((tracker.tip() - Vector<2>(0.5, 1.2)).norm(), 1e-9);
}

TEST_F(Stall, ends_on_resume) {
  auto tracker = loop();
  ASSERT_EQ(ticks(tracker, beyond, 40.0).status, Status::kStalled);
  tracker.resume();
  EXPECT_NE(ticks(tracker, beyond, 0.1).status, Status::kStalled);
  EXPECT_EQ(ticks(tracker, beyond, 10.0).status, Status::kStalled);
}

TEST_F(Stall, begins_after_its_time_without_progress) {
  for (const double seconds : {0.5, 2.0, 8.0}) {
    TrackerOptions<> options;
    options.stall_time = seconds;
    auto tracker = loop(options);
    double least = 10.0;
    double waited = 0.0;
    for (int i = 0; i < 40000; ++i) {
      const auto tick = ticks(tracker, beyond, kTick);
      if (tick.status == Status::kStalled) break;
      waited = tick.error.norm() < least - 4e-3 ? 0.0 : waited + kTick;  // 0.002 times the arm length of 2 m.
      if (waited == 0.0) least = tick.error.norm();
    }
    EXPECT_NEAR(waited, seconds, 0.01);
  }
  TrackerOptions<> options;
  options.stall_time = std::numeric_limits<double>::infinity();
  auto tracker = loop(options);
  EXPECT_NE(ticks(tracker, beyond, 60.0).status, Status::kStalled);
}

TEST_F(Stall, is_not_a_slow_approach) {
  for (const double k : {0.01, 0.5, 5.0}) {
    for (const double reach : {1.9, 1.999, 2.0}) {
      const auto scheme = WMVN<N>(Vector<N>(Vector<3>(1.0, 2.0, 3.0)), k);
      auto bounds = JointLimits<N>::none(3);
      for (int i = 0; i < 3; ++i) bounds.set(i, {-3.0, 3.0, 0.1, 2.0});
      CompiledTracker tracker(any_planar_arm(Vector<N>::Constant(3, 2.0 / 3.0)), Position<2>{}, scheme,
                              State<N>{Vector<3>(0.4, 0.5, 0.6), Vector<3>::Zero()}, {},
                              Limits<Level::kVelocity, N>(bounds, kTick));
      const Vector<2> x(reach * std::cos(0.2), reach * std::sin(0.2));
      for (int i = 0; i < 60000; ++i)
        ASSERT_NE(tracker.tick(Reference<Position<2>>::hold(x)).status, Status::kStalled)
            << k << " " << reach << ", tick " << i;
      if (k >= 0.5) {
        EXPECT_LT((tracker.tip() - x).norm(), 1e-2) << k << ' ' << reach;
      }
    }
  }
}

}  // namespace
}  // namespace fpbm::test::far_targets_laws
