#include <gtest/gtest.h>

#include <array>
#include <cstdint>

#include "fpbm/model/presets.hpp"
#include "fpbm/model/robot.hpp"
#include "fpbm/realtime/stack_tracker.hpp"
#include "fpbm/scheme/schemes.hpp"
#include "fpbm/task/position_task.hpp"
#include "fpbm/task/posture_task.hpp"
#include "support/random.hpp"

/// A level that is a posture task of all joints has no matrices (PostureRows). The same rows on a level of two tasks
/// have matrices.
namespace fpbm::test {
namespace {

constexpr int kDof = 7;
constexpr std::array<int, kDof> kShuffled{4, 0, 6, 2, 5, 1, 3};

/// Motions of a posture task with any order of joints, and of the same posture as two tasks on one level, within the
/// limits. The levels are enabled and disabled.
template <typename Scheme>
void expect_same_motions(const Scheme& scheme, const TaskGains<>& tip_gains, const TaskGains<>& gains) {
  const Robot<kDof> robot(presets::panda());
  const PositionTask<> tip{{Robot<kDof>::kTip}, tip_gains};
  const PostureTask<4> some{gains, {kShuffled[0], kShuffled[1], kShuffled[2], kShuffled[3]}};
  const PostureTask<3> others{gains, {kShuffled[4], kShuffled[5], kShuffled[6]}};
  TrackerOptions<> options;
  // Bounds on errors apply to each task: with smaller bounds or larger gains of the postures, the motions would differ.
  options.error_bound = 10.0;
  for (int seed = 0; seed < trials(20); ++seed) {
    Random random(static_cast<std::uint32_t>(seed));
    Vector<kDof> q0{0.0, -0.6, 0.0, -2.4, 0.0, 1.8, 0.785};
    q0 += random.uniform(kDof, -0.2, 0.2);
    auto ordered = stack_tracker(robot, Stack(tip, PostureTask<kDof>{gains}), scheme, q0, options);
    auto shuffled = stack_tracker(robot, Stack(tip, PostureTask<kDof>{gains, kShuffled}), scheme, q0, options);
    auto dense = stack_tracker(robot, Stack(tip, TaskLevel(some, others)), scheme, q0, options);
    auto to_ordered = decltype(ordered)::Target::hold(ordered.tip());
    auto to_shuffled = decltype(shuffled)::Target::hold(shuffled.tip());
    auto to_dense = decltype(dense)::Target::hold(dense.tip());
    Vector<3>& goal = std::get<0>(to_ordered.x);
    goal += random.uniform(3, -0.4, 0.4);
    std::get<0>(to_shuffled.x) = std::get<0>(to_dense.x) = goal;
    for (int i = 0; i < kDof; ++i) {
      const int joint = kShuffled[static_cast<std::size_t>(i)];
      const double x = std::get<1>(to_ordered.x)(joint) += random.uniform(-0.5, 0.5);
      std::get<1>(to_shuffled.x)(i) = x;
      (i < 4 ? std::get<1>(to_dense.x)(i) : std::get<2>(to_dense.x)(i - 4)) = x;
    }
    for (int i = 0; i < 1500; ++i) {
      if (i % 400 == 399) {
        const bool on = i % 800 > 400;
        EXPECT_TRUE(ordered.enable(1, on) && shuffled.enable(1, on) && dense.enable(1, on));
      }
      const auto expected = ordered.tick(to_ordered);
      const auto tick = shuffled.tick(to_shuffled);
      ASSERT_LT((tick.q - expected.q).norm(), 1e-9) << seed << ", tick " << i;
      ASSERT_LT((dense.tick(to_dense).q - expected.q).norm(), 1e-6) << seed << ", tick " << i;
      ASSERT_EQ(tick.status, expected.status);
    }
    EXPECT_GT((ordered.state().q - q0).norm(), 0.1);
  }
}

TEST(PostureRows, in_any_order_move_as_rows_of_matrices) {
  expect_same_motions(Balanced<kDof>(0.6, UnitWeights{}, NullSpace<kDof>().with_damping(2.0)), TaskGains<>(10.0, 25.0),
                      TaskGains<>(2.0, 1.0));
  expect_same_motions(MVN<kDof>(), TaskGains<>(5.0), TaskGains<>(0.5));
}

}  // namespace
}  // namespace fpbm::test
