#include "fpbm/any/any_stack.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "fpbm/any/detail/any_weights.hpp"
#include "fpbm/realtime/stack_tracker.hpp"
#include "fpbm/simulate/detail/first_level.hpp"
#include "fpbm/task/axis_task.hpp"
#include "fpbm/task/center_of_mass_task.hpp"
#include "fpbm/task/pose_task.hpp"
#include "fpbm/task/position_task.hpp"
#include "fpbm/task/posture_task.hpp"
#include "fpbm/task/relative_task.hpp"
#include "support/arms.hpp"
#include "support/bodies.hpp"

/// Stacks of tasks that are known at run time give the same motions as stacks of fixed types.
namespace fpbm::test::any_stack {
namespace {

constexpr int kTip = Robot<7>::kTip;
constexpr int kDynamic = Eigen::Dynamic;
using Weights = DiagonalWeights<kDynamic>;
const AnyFrameTask::Selection kAll{true, true, true, true, true, true};
const AnyFrameTask::Selection kHeight{false, false, true, false, false, false};
const TaskGains<> kGains(10.0, 25.0);

[[nodiscard]] AnyFrameTask frame_task(FrameCoordinates kind, int link, const AnyFrameTask::Selection& rows = kAll,
                                      bool in_frame = false) {
  return AnyFrameTask(kind, LinkFrame<>(link), kGains, rows, in_frame);
}
[[nodiscard]] AnyLevel level(const AnyFrameTask& first, const AnyFrameTask& second = {},
                             const AnyPostureTask& posture = {}) {
  return AnyLevel(first, second, posture);
}
[[nodiscard]] AnyLevel posture_level() {
  return level({}, {}, AnyPostureTask({0, 1, 2, 3, 4, 5, 6}, TaskGains<>(4.0, 4.0)));
}
[[nodiscard]] AnyLevel no_level() {
  return level({});
}

[[nodiscard]] Vector<7> start() {
  return Vector<7>{0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785};
}

template <typename Stack_>
[[nodiscard]] auto fixed(const Stack_& stack) {
  const auto scheme = Balanced<7>(0.6, DiagonalWeights<7>(Vector<7>(Vector<7>::LinSpaced(7, 1.0, 4.0))),
                                  NullSpace<7>().with_damping(2.0));
  return stack_tracker(Robot<7>(presets::panda()), stack, scheme, start());
}
[[nodiscard]] auto at_run_time(const AnyStack& stack) {
  const AnyWeights weights(Weights(Vector<kDynamic>(Vector<7>::LinSpaced(7, 1.0, 4.0))));
  const AccelerationScheme<kDynamic, double, AnyWeights> scheme(0.6, weights, 0.0, 0.0,
                                                                NullSpace<kDynamic>().with_damping(2.0));
  return stack_tracker(Robot<kDynamic>(presets::panda()), stack, scheme, Vector<kDynamic>(start()));
}

template <typename Tracker>
[[nodiscard]] auto holding(const Tracker& tracker) {
  using Target = typename Tracker::Target;
  return Target::hold(tracker.tip());
}

/// An axis, a position and a height of a link, and a posture, on four levels.
TEST(AnyStack, moves_as_a_stack_of_fixed_types) {
  auto expected = fixed(Stack(AxisTask<>{{kTip}, kGains}, PositionTask<>{{kTip}, kGains},
                              PositionTask<1>{{4}, kGains, {2}}, PostureTask<7>{TaskGains<>(4.0, 4.0)}));
  auto tracker = at_run_time(AnyStack(level(frame_task(FrameCoordinates::kAxis, kTip)),
                                      level(frame_task(FrameCoordinates::kPosition, kTip)),
                                      level(frame_task(FrameCoordinates::kPosition, 4, kHeight)), posture_level()));
  auto target = holding(expected);
  auto any = holding(tracker);
  std::get<1>(target.x) += Vector<3>(0.3, 0.4, -0.1);
  std::get<3>(any.x).at.p += Vector<3>(0.3, 0.4, -0.1);
  int slowed = 0;
  for (int i = 0; i < 4000; ++i) {
    const auto tick = expected.tick(target);
    const auto other = tracker.tick(any);
    ASSERT_LT((tick.q - other.q).norm(), 1e-9) << i;
    ASSERT_EQ(tick.status, other.status) << i;
    for (std::size_t k = 0; k < 4; ++k) ASSERT_NEAR(tick.scales[k], other.scales[k], 1e-6) << i;
    slowed += tick.status == Status::kSlowed ? 1 : 0;
  }
  EXPECT_GT(slowed, 10);
}

/// Several tasks on one level, and omitted levels.
TEST(AnyStack, has_tasks_side_by_side) {
  auto expected =
      fixed(Stack(TaskLevel(PositionTask<>{{kTip}, kGains}, AxisTask<>{{kTip}, kGains}), PoseTask<>{{5}, kGains}));
  auto tracker = at_run_time(
      AnyStack(level(frame_task(FrameCoordinates::kPosition, kTip), frame_task(FrameCoordinates::kAxis, kTip)),
               level(frame_task(FrameCoordinates::kPose, 5)), no_level(), no_level()));
  auto target = holding(expected);
  auto any = holding(tracker);
  std::get<0>(target.x)(1) += 0.2;
  std::get<0>(any.x).at.p(1) += 0.2;
  for (int i = 0; i < 2000; ++i) {
    const auto tick = expected.tick(target);
    const auto other = tracker.tick(any);
    ASSERT_LT((tick.q - other.q).norm(), 1e-9) << i;
    ASSERT_EQ(other.scales[2], 1.0);
  }
}

/// S J and S J̇ of a task in one state of a robot.
template <typename Task>
[[nodiscard]] auto rows_in(const Robot<kDynamic>& robot, Task task) {
  constexpr int kRows = Task::kRows;
  task.bind(robot);
  Random random(7);
  RobotState<kDynamic> state;
  robot.update(random.uniform(robot.dof(), -1.0, 1.0), random.uniform(robot.dof(), -1.0, 1.0), state);
  LevelRows<kRows, kDynamic, double> rows;
  rows.resize(rows_of(task), robot.dof());
  typename Task::Space::template Point<double> x;
  Vector<Task::Space::kRows> xd;
  Matrix<kRows, Task::Space::kRows> S;
  task.evaluate(robot, state, x, xd, S, TaskRows(rows, 0));
  return std::pair{Eigen::MatrixXd(rows.J), Eigen::MatrixXd(rows.Jd)};
}

TEST(AnyFrameTask, has_the_rows_of_relative_tasks_and_of_the_center_of_mass) {
  Tree<> tree = two_pandas(true);
  for (auto& each : tree.joints) each.joint.moved = {1.0, Vector<3>(0.1, 0.2, 0.3)};
  const Robot<kDynamic> robot(tree);
  const LinkFrame<> right = frame_of(tree, "right_tip");
  const LinkFrame<> left = frame_of(tree, "left_tip");
  const auto expect_same = [](const auto& one, const auto& other) {
    ASSERT_EQ(one.first.rows(), other.first.rows());
    EXPECT_LT((one.first - other.first).norm() + (one.second - other.second).norm(), 1e-12);
  };
  const auto any = [&](FrameCoordinates kind, const AnyFrameTask::Selection& selected = kAll) {
    return rows_in(robot, AnyFrameTask(kind, left, kGains, selected, false, {0.0, 0.0, 1.0}, right));
  };
  expect_same(any(FrameCoordinates::kPose), rows_in(robot, RelativePoseTask<>{{left, kGains}, right}));
  expect_same(any(FrameCoordinates::kAxis), rows_in(robot, RelativeTask{AxisTask<>{left, kGains}, right}));
  expect_same(any(FrameCoordinates::kPosition, kHeight),
              rows_in(robot, RelativeTask{PositionTask<1>{left, kGains, {2}}, right}));
  expect_same(any(FrameCoordinates::kCenterOfMass, kHeight), rows_in(robot, CenterOfMassTask<1>{kGains, {2}}));
  EXPECT_EQ(complaint([&] { (void)frame_of(tree, "lft_tip"); }),
            "frame = 'lft_tip': must be a frame of the tree: 'torso_tip' 'right_tip' 'left_tip'");
}

/// A pose with a free rotation about the z axis of the frame.
TEST(AnyStack, has_poses_of_fewer_rows) {
  auto tracker = at_run_time(
      AnyStack(level(frame_task(FrameCoordinates::kPose, kTip, {true, true, true, true, true, false}, true)),
               posture_level(), no_level(), no_level()));
  auto target = holding(tracker);
  const auto tip = std::get<0>(target.x).at;
  std::get<0>(target.x).at.R = tip.R * rotation(Vector<3>(0.0, 0.0, 1.0));  // Rotated about the free z axis: no task
                                                                            // error.
  std::get<5>(target.x)(6) += 0.5;
  for (int i = 0; i < 8000; ++i) (void)tracker.tick(target);
  const auto reached = std::get<0>(tracker.tip()).at;
  EXPECT_LT((reached.p - tip.p).norm(), 1e-6);
  EXPECT_LT((reached.R.col(2) - tip.R.col(2)).norm(), 1e-6);
  EXPECT_GT((reached.R.col(0) - tip.R.col(0)).norm(), 0.2);
}

/// A task without rows leaves its velocity unset, which must not end a rollout by chance.
TEST(AnyStack, empty_places_do_not_change_the_watch_of_a_rollout) {
  using Space = AnyStack::Space;
  const AnyStack stack(level(frame_task(FrameCoordinates::kPosition, kTip, kHeight, true)), no_level(), no_level(),
                       no_level());
  const RobotTasks<Robot<kDynamic>, AnyStack> tasks(Robot<kDynamic>(presets::panda()), stack);
  Kinematics<Space, kDynamic> kinematics;
  std::get<1>(kinematics.tasks).xd.setConstant(std::numeric_limits<double>::quiet_NaN());
  SelectionGrowth<Space, kDynamic, double> selection;
  const Vector<Space::kRows> xd = Vector<Space::kRows>::Constant(0.1);
  Vector<kDynamic> q(start());
  double growth = 0.0;
  for (int i = 0; i < 2; ++i) {
    tasks.kinematics(q, Vector<kDynamic>(Vector<7>::Ones()), kinematics);
    growth = selection.of_rate(kinematics, xd);
    q.array() += 0.1;
  }
  EXPECT_GT(growth, 0.0);  // Not NaN: the axes of the frame have turned.
}

TEST(AnyStack, rejects_invalid_tasks) {
  EXPECT_THROW((void)frame_task(FrameCoordinates::kOrientation, kTip, kHeight), std::invalid_argument);
  EXPECT_THROW(AnyFrameTask(FrameCoordinates::kAxis, LinkFrame<>(0), kGains, kAll, false, Vector<3>::Zero()),
               std::invalid_argument);
  EXPECT_THROW(AnyPostureTask({}, kGains), std::invalid_argument);
  EXPECT_THROW(AnyPostureTask(std::vector<int>(kMaxDof + 1, 0), kGains), std::invalid_argument);
  const auto build = [](const AnyLevel& first) {
    return at_run_time(AnyStack(first, no_level(), no_level(), no_level()));
  };
  EXPECT_THROW((void)build(level({}, {}, AnyPostureTask({0, 0}, kGains))), std::invalid_argument);
  EXPECT_THROW((void)build(level({}, {}, AnyPostureTask({7}, kGains))), std::invalid_argument);
  EXPECT_THROW((void)build(level(frame_task(FrameCoordinates::kPose, 8))), std::invalid_argument);
  EXPECT_THROW((void)build(level(frame_task(FrameCoordinates::kPose, kTip), frame_task(FrameCoordinates::kPose, 4))),
               std::invalid_argument);
  EXPECT_THROW((void)build(no_level()), std::invalid_argument);
}

}  // namespace
}  // namespace fpbm::test::any_stack
