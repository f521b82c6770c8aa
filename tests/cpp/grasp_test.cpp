#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>

#include "fpbm/model/detail/robot_presets.hpp"
#include "fpbm/model/presets.hpp"
#include "fpbm/realtime/stack_tracker.hpp"
#include "fpbm/scheme/schemes.hpp"
#include "fpbm/task/pose_task.hpp"
#include "fpbm/task/posture_task.hpp"
#include "fpbm/task/relative_task.hpp"
#include "support/random.hpp"

/// Two arms hold an object. Limits, and a stop with keep_first_level, do not break the grasp.
namespace fpbm::test {
namespace {

constexpr double kTick = 1e-3;

/// Largest excess over the bounds on position, velocity, acceleration and jerk, by differences of positions.
class Excess {
 public:
  Excess(const JointLimits<14>& bounds, const Vector<14>& q) : bounds_(bounds) { last_.fill(q); }

  void see(const Vector<14>& q) {
    const auto& [a, b, c] = last_;
    for (Eigen::Index i = 0; i < 14; ++i) {
      const double velocity = (q(i) - a(i)) / kTick;
      const double acceleration = (q(i) - 2.0 * a(i) + b(i)) / (kTick * kTick);
      const double jerk = (q(i) - 3.0 * a(i) + 3.0 * b(i) - c(i)) / (kTick * kTick * kTick);
      worst = std::max(
          {worst, q(i) - bounds_.upper(i), bounds_.lower(i) - q(i), std::abs(velocity) / bounds_.velocity(i) - 1.0,
           std::abs(acceleration) / bounds_.acceleration(i) - 1.0, std::abs(jerk) / bounds_.jerk(i) - 1.0});
    }
    last_ = {q, a, b};
  }
  double worst = -1.0;

 private:
  JointLimits<14> bounds_;
  std::array<Vector<14>, 3> last_;
};

struct Motion {
  double error = 0.0;   ///< Largest error of the grasp in the states of the tracker [m] or [rad].
  double excess = 0.0;  ///< Over the bounds.
  double speed = 0.0;   ///< At the end [rad/s].
};

/// An object held by two Pandas jumps between targets for one to two seconds. Then the robot stops.
template <typename Scheme>
[[nodiscard]] Motion stopped(const Scheme& scheme, const TaskGains<>& grasp, const TaskGains<>& object,
                             const TaskGains<>& posture, int seed, bool keep) {
  const Tree<> tree = presets::two_pandas();
  const Robot<14> robot(tree);
  const auto right = frame_of(tree, "right_tip");
  Random random(static_cast<std::uint32_t>(seed));
  Vector<14> q0;
  for (int i = 0; i < 14; ++i) {
    q0(i) = Vector<7>{0.0, -0.6, 0.0, -2.4, 0.0, 1.8, 0.785}(i % 7) + random.uniform(-0.3, 0.3);
  }
  TrackerOptions<> options;
  options.keep_first_level = keep;
  const Stack stack(RelativePoseTask<>{{frame_of(tree, "left_tip"), grasp}, right}, PoseTask<>{right, object},
                    PostureTask<14>{posture});
  auto tracker = stack_tracker(robot, stack, scheme, q0, options);
  auto target = decltype(tracker)::Target::hold(tracker.tip());
  const auto start = target.x;
  Excess excess(robot.limits(), q0);
  Motion motion;
  const int stop = 1000 + static_cast<int>(random.uniform(0.0, 1000.0));
  for (int k = 0; k < stop + 1500; ++k) {
    if (k % 1000 == 0 && k < stop) {
      auto& [p, R] = std::get<1>(target.x);
      p = std::get<1>(start).p + Vector<3>(random.uniform(3, -0.5, 0.5));
      R = rotation(Vector<3>(random.uniform(3, -0.8, 0.8))) * std::get<1>(start).R;
    }
    if (k == stop) tracker.stop();
    const auto tick = tracker.tick(target);
    excess.see(tick.q);
    motion.speed = tick.qd.cwiseAbs().maxCoeff();
    motion.error = std::max(motion.error, tick.error.template head<6>().norm());
  }
  motion.excess = excess.worst;
  return motion;
}

TEST(Grasp, outlasts_limits_and_a_stop) {
  const auto balanced = Balanced<14>(0.0, UnitWeights{}, NullSpace<14>().with_damping(2.0));
  const TaskGains<> grasp(500.0, 62500.0);
  double worst = 0.0;
  double broken = 1.0;
  for (int seed = 0; seed < trials(200, 6); ++seed) {
    const Motion kept = stopped(balanced, grasp, {10.0, 25.0}, {4.0, 4.0}, seed, true);
    EXPECT_LT(kept.excess, 1e-9) << seed;
    EXPECT_LT(kept.speed, 1e-12) << seed;
    worst = std::max(worst, kept.error);
    if (seed < 2) {
      const Motion lost = stopped(balanced, grasp, {10.0, 25.0}, {4.0, 4.0}, seed, false);
      EXPECT_EQ(lost.speed, 0.0) << seed;
      broken = std::min(broken, lost.error);
    }
  }
  std::printf("grasp kept to %.1e; without keep_first_level %.1e at least\n", worst, broken);
  EXPECT_LT(worst, 1e-8);
  EXPECT_GT(broken, 1e-4);
}

TEST(Grasp, outlasts_a_stop_by_velocity) {
  double worst = 0.0;
  for (int seed = 0; seed < trials(100, 3); ++seed) {
    const Motion kept = stopped(MVN<14>(), TaskGains<>(400.0), TaskGains<>(5.0), TaskGains<>(2.0), seed, true);
    EXPECT_LT(kept.excess, 1e-9) << seed;
    EXPECT_LT(kept.speed, 1e-9) << seed;
    worst = std::max(worst, kept.error);
  }
  std::printf("grasp kept to %.1e by velocity\n", worst);
  EXPECT_LT(worst, 1e-5);
}

/// One arm: the pose of the tip does not change, while the self-motion decays to rest.
TEST(Grasp, a_stop_keeps_the_pose_of_one_arm) {
  const Robot<7> robot(presets::panda());
  TrackerOptions<> options;
  options.keep_first_level = true;
  const Stack stack(PoseTask<>{{Robot<7>::kTip}, {40.0, 400.0}}, PostureTask<7>{TaskGains<>(10.0, 25.0)});
  const Vector<7> q0{0.0, -0.6, 0.0, -2.4, 0.0, 1.8, 0.785};
  auto tracker = stack_tracker(robot, stack, Balanced<7>(0.0, UnitWeights{}), q0, options);
  auto target = decltype(tracker)::Target::hold(tracker.tip());
  std::get<1>(target.x)(0) += 1.0;
  for (int k = 0; k < 300; ++k) (void)tracker.tick(target);
  const double before = tracker.state().qd.norm();
  tracker.stop();
  double worst = 0.0;
  for (int k = 0; k < 600; ++k) worst = std::max(worst, tracker.tick(target).error.head<6>().norm());
  EXPECT_GT(before, 0.05);
  EXPECT_LT(tracker.state().qd.norm(), 1e-9);
  EXPECT_LT(worst, 1e-6);
  tracker.resume();
  EXPECT_FALSE(failed(tracker.tick(target).status));
}

/// A stop does not move a task of the first level to a target that is far away or not finite.
TEST(Grasp, a_stop_leaves_a_far_target) {
  const Robot<7> robot(presets::panda());
  TrackerOptions<> options;
  options.keep_first_level = true;
  const Stack stack(PoseTask<>{{Robot<7>::kTip}, {40.0, 400.0}}, PostureTask<7>{TaskGains<>(4.0, 4.0)});
  const Vector<7> q0{0.0, -0.6, 0.0, -2.4, 0.0, 1.8, 0.785};
  for (const double shift : {0.4, std::numeric_limits<double>::quiet_NaN()}) {
    auto tracker = stack_tracker(robot, stack, Balanced<7>(0.0, UnitWeights{}), q0, options);
    auto target = decltype(tracker)::Target::hold(tracker.tip());
    std::get<0>(target.x).p(1) += 0.4;
    for (int k = 0; k < 300; ++k) (void)tracker.tick(target);
    const Vector<3> before = std::get<0>(tracker.tip()).p;
    std::get<0>(target.x).p(1) += shift - 0.4;
    tracker.stop();
    for (int k = 0; k < 1500; ++k) (void)tracker.tick(target);
    EXPECT_LT((std::get<0>(tracker.tip()).p - before).norm(), 1e-3) << shift;
    EXPECT_LT(tracker.state().qd.norm(), 1e-3) << shift;
  }
}

}  // namespace
}  // namespace fpbm::test
