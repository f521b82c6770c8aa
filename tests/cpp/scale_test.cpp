#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <string>

#include "support/arms.hpp"
#include "support/compiled_tracker.hpp"

/// A tick with kOk and scale 1 executes the whole task. A tick with a smaller scale does not.
namespace fpbm::test::scale_laws {
namespace {

constexpr int N = Eigen::Dynamic;
constexpr double kTick = 1e-3;

/// Steps of the target from rest, at velocity level, with all gains that a tick of 1 ms can follow. The reference is
/// the task velocity at the start of the tick, whose direction changes by k h within the tick.
template <typename Space, typename Arm>
void expect_ok_to_be_ok(const std::string& name, const Arm& arm, const Vector<N>& q0) {
  int ticks = 0;
  int slowed = 0;
  auto bounds = arm.limits();
  for (Eigen::Index i = 0; i < q0.size(); ++i) bounds.set(i, {-3.1, 3.1, 2.0, 10.0});
  const Limits<Level::kVelocity, N> limits(bounds, kTick);
  for (const double k : {1.0, 5.0, 20.0, 50.0}) {
    for (std::uint32_t seed = 0; seed < static_cast<std::uint32_t>(trials(10)); ++seed) {
      SCOPED_TRACE(name + ", k " + std::to_string(k) + ", seed " + std::to_string(seed));
      Random random(seed);
      const auto scheme = WMVN<N>(random.uniform(q0.size(), 0.5, 3.0), k);
      TrackerOptions<> options;
      options.integral_gain = 1.0;
      CompiledTracker tracker(arm, Space{}, scheme, State<N>{q0, Vector<N>::Zero(q0.size())}, options, limits);
      Vector<Space::kRows> step = Vector<Space::kRows>::Zero();
      constexpr int kLengths = Space::kRows - Space::kTurns;
      step.template head<kLengths>() = random.uniform(kLengths, -1.0, 1.0).normalized() * random.uniform(0.01, 0.08);
      auto reference = Reference<Space>::hold(tracker.tip());
      reference.x = Space::template displace<double>(reference.x, step);
      Kinematics<Space, N> kinematics;
      for (int i = 0; i < 1000; ++i) {
        arm.kinematics(tracker.state().q, kinematics);
        const Vector<Space::kRows> task = k * Space::template difference<double>(reference.x, kinematics.tip);
        if (task.norm() < 1e-3) break;
        const auto tick = tracker.tick(reference);
        const double share = (kinematics.J * tick.qd).dot(task) / task.squaredNorm();
        ++ticks;
        if (tick.status == Status::kOk) {
          ASSERT_EQ(tick.scale, 1.0);
          ASSERT_GE(share, 0.99 - k * kTick) << i;
        }
        if (tick.status == Status::kSlowed) ++slowed;
      }
    }
  }
  std::printf("%s: %d ticks, %d slowed\n", name.c_str(), ticks, slowed);
  EXPECT_GT(slowed, 0);
}

TEST(Scale, is_less_than_one_if_the_task_is_scaled) {
  Vector<N> bent(7);
  bent << 0.1, -0.3, 0.2, -2.2, 0.1, 2.0, 0.785;
  expect_ok_to_be_ok<Pose>("Panda, pose", any_arm(presets::panda()), bent);
  expect_ok_to_be_ok<Position<3>>("Panda, position", any_arm(presets::panda()), bent);
  Vector<N> elbow_up(6);
  elbow_up << 0.1, -1.3, 1.7, -0.9, 1.1, 0.3;
  expect_ok_to_be_ok<Pose>("UR5e, pose", any_arm(presets::ur5e()), elbow_up);
  for (int n = 2; n <= 4; ++n) {
    const Vector<N> ones = Vector<N>::Ones(n);
    expect_ok_to_be_ok<Position<2>>("planar " + std::to_string(n), any_planar_arm(0.5 * ones), 0.6 * ones);
  }
}

}  // namespace
}  // namespace fpbm::test::scale_laws
