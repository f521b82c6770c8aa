#include "fpbm/limits/detail/least_squares_blend.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "fpbm/limits/limiter.hpp"
#include "support/arms.hpp"
#include "support/random.hpp"

/// Conditions under which the motion of a task deviates from the direction of the task.
namespace fpbm::test::yield_laws {
namespace {

using Joints = Vector<7>;

/// A desired motion of any size beyond the bounds keeps its direction, unless the posture loses the direction.
template <Level kLevel>
void expect_direction() {
  const auto limits = Limits<kLevel, 7>(SerialArm<7>(presets::panda()).limits(), 1e-3);
  const Limiter<kLevel, 7> limiter(limits);
  const SerialArm<7> arm(presets::panda());
  const Joints q{0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785};
  Kinematics<Position<3>, 7> kinematics;
  arm.kinematics(q, Joints(Joints::Zero()), kinematics);
  const State<7> state{q, Joints::Zero()};
  Random random(4);
  double worst = 0.0;
  double least = 1.0;
  int kept = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const Vector<3> direction = random.uniform(3, -1.0, 1.0);
    for (const double size : {10.0, 100.0, 1000.0, 10000.0}) {
      const Joints desired =
          size * Joints(kinematics.J.transpose() * (kinematics.J * kinematics.J.transpose()).inverse() * direction);
      const auto found = limiter.motion(kinematics.J, state, desired);
      const Vector<3> moved = kinematics.J * found.u;
      const double angle = (moved.normalized() - direction.normalized()).norm();
      worst = std::max(worst, angle);
      kept += angle < 1e-9 ? 1 : 0;
      least = std::min(least, found.scale);
    }
  }
  std::printf("%d of 800 keep their direction, largest angle %.1e rad, least scale %.1e\n", kept, worst, least);
  EXPECT_GE(kept, 790);
  EXPECT_LT(least, 1e-3);
}
TEST(Yield, keeps_the_direction_of_a_large_demand) {
  expect_direction<Level::kAcceleration>();
  expect_direction<Level::kVelocity>();
}

}  // namespace
}  // namespace fpbm::test::yield_laws
