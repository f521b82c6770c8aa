#include <gtest/gtest.h>

#include <algorithm>

#include "fpbm/core/lanes.hpp"
#include "fpbm/fpbm.hpp"
#include "support/arms.hpp"

/// Attempts in SIMD lanes find postures like attempts one by one.
namespace fpbm::test::inverse_lanes_laws {
namespace {

using Panda = SerialArm<7>;

[[nodiscard]] Vector<7> random_posture(Random& random, const Panda& arm) {
  Vector<7> q;
  for (int i = 0; i < 7; ++i) q(i) = random.uniform(arm.limits().lower(i), arm.limits().upper(i));
  return q;
}

TEST(InverseInLanes, finds_a_posture_for_every_reachable_target) {
  const Panda arm(presets::panda());
  InverseOptions<> options;
  options.starts = 256;
  InverseKinematics<Panda, Pose, Lanes<2>> in_lanes(arm, Pose{}, options);
  InverseKinematics alone(arm, Pose{}, options);
  Random random(1);
  int equal = 0;
  const int all = trials(300);
  for (int k = 0; k < all; ++k) {
    Kinematics<Pose, 7> kinematics;
    arm.kinematics(random_posture(random, arm), kinematics);
    const Transform<> target = kinematics.tip;
    const Vector<7> start = random_posture(random, arm);
    const auto found = in_lanes.solve(target, start);
    EXPECT_TRUE(found.solved()) << k;
    EXPECT_LE(found.starts, 256);
    arm.kinematics(found.q, kinematics);
    const auto e = Pose::difference<double>(target, kinematics.tip);
    EXPECT_LE(std::max(e.head<3>().norm(), e.tail<3>().norm()), 1e-6);
    EXPECT_TRUE((found.q.array() >= arm.limits().lower.array()).all());
    EXPECT_TRUE((found.q.array() <= arm.limits().upper.array()).all());
    equal += alone.solve(target, start).q == found.q ? 1 : 0;
  }
  EXPECT_GT(equal, all / 4) << "the attempt from the given start is the same";
}

TEST(InverseInLanes, gives_the_nearest_posture_out_of_reach) {
  const Panda arm(presets::panda());
  InverseKinematics<Panda, Position<3>, Lanes<2>> in_lanes(arm, Position<3>{});
  InverseKinematics alone(arm, Position<3>{});
  const Vector<7> start = {0.1, -0.3, 0.2, -2.2, 0.1, 2.0, 0.785};
  const Vector<3> target(0.4, 1.9, 0.5);
  const auto found = in_lanes.solve(target, start);
  EXPECT_EQ(found.status, Status::kNotFound);
  EXPECT_EQ(found.starts, 64);
  EXPECT_NEAR(found.error, alone.solve(target, start).error, 1e-2);
}

}  // namespace
}  // namespace fpbm::test::inverse_lanes_laws
