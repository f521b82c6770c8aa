#include "fpbm/inverse/inverse_kinematics.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "fpbm/bound/clearance.hpp"
#include "fpbm/bound/preset_capsules.hpp"
#include "fpbm/bound/task_bounds.hpp"
#include "fpbm/task/axis_task.hpp"
#include "fpbm/task/pose_task.hpp"
#include "fpbm/task/position_task.hpp"
#include "fpbm/task/posture_task.hpp"
#include "support/arms.hpp"

/// A posture is found for every reachable target, is within all ranges and bounds, and is at the target.
namespace fpbm::test::inverse_laws {
namespace {

constexpr int kOpen = Eigen::Dynamic;
constexpr double kPi = 3.14159265358979323846;
using Spatial = AnyArm<Position<3>>;

template <typename Limits_>
[[nodiscard]] auto random_posture(Random& random, const Limits_& limits) {
  auto q = limits.lower;
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const auto low = std::max(static_cast<double>(limits.lower(i)), -kPi);
    const auto high = std::min(static_cast<double>(limits.upper(i)), kPi);
    q(i) = static_cast<std::decay_t<decltype(q(i))>>(random.uniform(low, high));
  }
  return q;
}

template <typename Space, typename Arm>
[[nodiscard]] auto kinematics_at(const Arm& arm, const Vector<Arm::kDof, typename Arm::Scalar>& q) {
  Kinematics<Space, Arm::kDof, typename Arm::Scalar> kinematics;
  arm.kinematics(q, kinematics);
  return kinematics;
}

/// Distance and angle from the target, by the kinematics of the arm.
template <typename Space, typename Arm, typename Posture_, typename Point>
void expect_at(const Arm& arm, const Posture_& found, const Point& target, double tolerance) {
  using Scalar = typename Arm::Scalar;
  const auto e = Space::template difference<Scalar>(target, kinematics_at<Space>(arm, found.q).tip);
  constexpr int kLinear = Space::kRows - Space::kTurns;
  EXPECT_LE(static_cast<double>(e.head(kLinear).norm()), tolerance);
  EXPECT_LE(static_cast<double>(e.tail(Space::kTurns).norm()), tolerance);
  EXPECT_NEAR(static_cast<double>(found.error),
              static_cast<double>(std::max(e.head(kLinear).norm(), e.tail(Space::kTurns).norm())), 1e-3 * tolerance);
}
template <typename Limits_, typename JointVector>
void expect_within(const Limits_& limits, const JointVector& q) {
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    EXPECT_GE(q(i), limits.lower(i)) << i;
    EXPECT_LE(q(i), limits.upper(i)) << i;
  }
}

/// Random reachable targets, from random starts.
template <typename Space, typename Inverse, typename Arm>
void expect_all_found(Inverse inverse, const Arm& arm, int count, double tolerance, std::uint32_t seed) {
  Random random(seed);
  for (int k = 0; k < count; ++k) {
    SCOPED_TRACE("target " + std::to_string(k));
    const auto target = kinematics_at<Space>(arm, random_posture(random, arm.limits())).tip;
    const auto found = inverse.solve(target, random_posture(random, arm.limits()));
    EXPECT_TRUE(found.solved()) << message(found.status) << ", error " << found.error;
    expect_at<Space>(arm, found, target, tolerance);
    expect_within(arm.limits(), found.q);
  }
}

[[nodiscard]] std::vector<std::pair<std::string, Chain<>>> chains() {
  return {{"panda", presets::panda()}, {"fr3", presets::fr3()},         {"iiwa14", presets::iiwa14()},
          {"gen3", presets::gen3()},   {"ur5e", presets::ur5e()},       {"ur10e", presets::ur10e()},
          {"xarm7", presets::xarm7()}, {"openarm", presets::openarm()}, {"z1", presets::z1()},
          {"rail", panda_on_rail()},   {"coupled", coupled_panda()}};
}

InverseOptions<> patient() {
  InverseOptions<> options;
  options.starts = 256;
  return options;
}

TEST(Inverse, finds_a_posture_for_every_reachable_target) {
  for (const auto& [name, chain] : chains()) {
    SCOPED_TRACE(name);
    const Spatial arm = any_arm(chain);
    expect_all_found<Pose>(InverseKinematics(arm, Pose{}, patient()), arm, trials(300), 1e-6, 1);
    expect_all_found<Position<3>>(InverseKinematics(arm, Position<3>{}, patient()), arm, trials(100), 1e-6, 2);
  }
}

TEST(Inverse, finds_a_posture_in_the_plane) {
  for (const int joints : {2, 3, 4, 12}) {
    const auto arm = any_planar_arm(Vector<kOpen>(Vector<kOpen>::Ones(joints)));
    expect_all_found<Position<2>>(InverseKinematics(arm, Position<2>{}), arm, trials(100), 1e-6, 3);
    if (joints > 2) {
      expect_all_found<PlanarPose>(InverseKinematics(arm, PlanarPose{}), arm, trials(100), 1e-6, 4);
    }
  }
}

TEST(Inverse, finds_a_posture_in_float) {
  const SerialArm<7, float> arm = SerialArm<7>(presets::panda()).cast<float>();
  expect_all_found<Pose>(InverseKinematics(arm, Pose{}), arm, trials(200), 1e-4, 5);
}

TEST(Inverse, does_not_depend_on_the_size_of_the_arm) {
  for (const double scale : {1e-3, 1e3}) {
    Chain<> chain = presets::panda();
    for (auto& joint : chain.joints) joint.placement.p *= scale;
    chain.tip.p *= scale;
    InverseOptions<> options = patient();
    options.tolerance = 1e-6 * std::min(scale, 1.0);
    const Spatial arm = any_arm(chain);
    expect_all_found<Pose>(InverseKinematics(arm, Pose{}, options), arm, trials(100), std::max(1e-6, 1e-6 * scale), 6);
  }
}

/// A target that the start reaches after a half turn about any axis is not reached at the start.
TEST(Inverse, makes_half_turns) {
  for (const auto& [name, chain] : chains()) {
    SCOPED_TRACE(name);
    const Spatial arm = any_arm(chain);
    InverseKinematics inverse(arm, Pose{}, patient());
    Random random(19);
    for (int k = 0; k < trials(100); ++k) {
      const auto q = random_posture(random, arm.limits());
      const auto wanted = random_posture(random, arm.limits());
      for (const double angle : {0.0, 1e-12, 1e-8, 1e-4, 0.9e-3, 1.1e-3}) {
        auto target = kinematics_at<Pose>(arm, wanted).tip;
        const Matrix<3, 3> R = kinematics_at<Pose>(arm, q).tip.R;
        Vector<3> axis = Vector<3>::Unit(k % 3);
        if (k % 2 == 0) axis = random.uniform(3, -1.0, 1.0).normalized();
        target.R = R * Eigen::AngleAxisd(kPi - angle, axis).toRotationMatrix();
        if (k % 4 == 0) target.p = kinematics_at<Pose>(arm, q).tip.p;
        const auto found = inverse.solve(target, q);
        if (found.solved()) expect_at<Pose>(arm, found, target, 1e-6);
      }
    }
  }
}

/// The error of a search has the direction of the rotation vector θ a, and the length 2 sin(θ/2), for all angles.
TEST(Inverse, searches_along_the_rotation_vector) {
  Random random(20);
  for (int k = 0; k < trials(1000); ++k) {
    const Vector<3> axis = random.uniform(3, -1.0, 1.0).normalized();
    const double theta = k % 2 == 0 ? random.uniform(0.0, kPi) : kPi - std::pow(10.0, random.uniform(-12, 0));
    Transform<> y;
    y.R = Eigen::AngleAxisd(random.uniform(0.0, 3.0), random.uniform(3, -1.0, 1.0).normalized()).toRotationMatrix();
    y.p = random.uniform(3, -1.0, 1.0);
    Transform<> x = y;
    x.R = Eigen::AngleAxisd(theta, axis).toRotationMatrix() * y.R;
    const Vector<6> e = search_error<Pose, double>(x, y);
    EXPECT_EQ(e.head<3>().norm(), 0.0);
    EXPECT_LE((e.tail<3>() - 2.0 * std::sin(theta / 2.0) * axis).norm(), 1e-6) << theta;
  }
}

/// The next waypoint of a path, 1 cm and 2° away, is reached on the branch of the posture before: no joint jumps.
TEST(Inverse, stays_on_the_branch_of_a_near_start) {
  for (const auto& [name, chain] : chains()) {
    SCOPED_TRACE(name);
    const Spatial arm = any_arm(chain);
    InverseKinematics inverse(arm, Pose{});
    Random random(7);
    for (int k = 0; k < trials(300); ++k) {
      const auto start = random_posture(random, arm.limits());
      auto near = start;
      for (Eigen::Index i = 0; i < near.size(); ++i) near(i) += random.uniform(-0.02, 0.02);
      near = near.cwiseMax(arm.limits().lower).cwiseMin(arm.limits().upper);
      const auto found = inverse.solve(kinematics_at<Pose>(arm, near).tip, start);
      ASSERT_TRUE(found.solved()) << k;
      EXPECT_EQ(found.starts, 1) << k;
    }
  }
}

TEST(Inverse, gives_the_nearest_posture_if_the_target_is_out_of_reach) {
  for (const auto& [name, chain] : chains()) {
    SCOPED_TRACE(name);
    const Spatial arm = any_arm(chain);
    const double reach = kinematics_at<Pose>(arm, Vector<kOpen>(Vector<kOpen>::Zero(arm.dof()))).length;
    InverseKinematics inverse(arm, Position<3>{});
    Random random(8);
    for (int k = 0; k < trials(10); ++k) {
      const auto start = random_posture(random, arm.limits());
      Vector<3> direction = random.uniform(3, -1.0, 1.0);
      direction.normalize();
      const Vector<3> target = 3.0 * reach * direction;
      const auto found = inverse.solve(target, start);
      EXPECT_EQ(found.status, Status::kNotFound);
      EXPECT_EQ(found.starts, 64);
      expect_within(arm.limits(), found.q);
      EXPECT_NEAR(found.error, (target - kinematics_at<Position<3>>(arm, found.q).tip).norm(), 1e-9);
      EXPECT_LE(found.error, (target - kinematics_at<Position<3>>(arm, start).tip).norm());
      EXPECT_GE(found.error, reach);
    }
  }
}

TEST(Inverse, depends_on_its_arguments_only) {
  const Spatial arm = any_arm(presets::panda());
  Random random(9);
  const Vector<kOpen> start = random_posture(random, arm.limits());
  InverseOptions<> other;
  other.seed = 1;
  InverseKinematics inverse(arm, Pose{});
  InverseKinematics shifted(arm, Pose{}, other);
  int differ = 0;
  for (int k = 0; k < 20; ++k) {
    const auto target = kinematics_at<Pose>(arm, random_posture(random, arm.limits())).tip;
    const auto first = inverse.solve(target, start);
    const auto again = inverse.solve(target, start);
    EXPECT_EQ(first.q, again.q);
    EXPECT_EQ(first.starts, again.starts);
    differ += shifted.solve(target, start).q != first.q ? 1 : 0;
  }
  EXPECT_GT(differ, 0);
}

TEST(Inverse, turns_continuous_joints_the_shorter_way) {
  for (const auto& chain : {presets::gen3(), presets::ur5e()}) {
    const Spatial arm = any_arm(chain);
    InverseKinematics inverse(arm, Pose{}, patient());
    Random random(10);
    for (int k = 0; k < trials(100); ++k) {
      Vector<kOpen> start = random_posture(random, arm.limits());
      const auto target = kinematics_at<Pose>(arm, random_posture(random, arm.limits())).tip;
      const bool continuous = !std::isfinite(arm.limits().upper(0));
      if (continuous) start(0) += 40.0 * kPi;
      const auto found = inverse.solve(target, start);
      ASSERT_TRUE(found.solved());
      const double turn = std::abs(found.q(0) - start(0));
      const bool has_room = continuous || (std::abs(start(0)) < kPi);
      EXPECT_TRUE(!has_room || turn <= kPi + 1e-9) << k << ": " << turn;
    }
  }
}

/// The ends of a range of one turn do not bound the search: the joint passes them, and the result is within the range.
TEST(Inverse, passes_the_ends_of_whole_turns) {
  const Spatial arm = any_arm(presets::ur5e());
  auto limits = arm.limits();
  limits.lower.setConstant(-kPi);
  limits.upper.setConstant(kPi);
  InverseKinematics inverse(arm, Pose{}, patient(), limits);
  InverseKinematics wider(arm, Pose{}, patient());
  Random random(17);
  int starts = 0;
  int starts_of_wider = 0;
  for (int k = 0; k < trials(300); ++k) {
    const auto target = kinematics_at<Pose>(arm, random_posture(random, limits)).tip;
    const auto start = random_posture(random, limits);
    const auto found = inverse.solve(target, start);
    EXPECT_TRUE(found.solved()) << k;
    expect_within(limits, found.q);
    expect_at<Pose>(arm, found, target, 1e-6);
    starts += found.starts;
    starts_of_wider += wider.solve(target, start).starts;
  }
  EXPECT_EQ(starts, starts_of_wider);
}

TEST(Inverse, moves_a_start_into_the_ranges) {
  const Spatial arm = any_arm(presets::panda());
  Random random(11);
  const auto target = kinematics_at<Pose>(arm, random_posture(random, arm.limits())).tip;
  const auto found = InverseKinematics(arm, Pose{}).solve(target, Vector<kOpen>::Constant(7, 9.0));
  EXPECT_TRUE(found.solved());
  expect_within(arm.limits(), found.q);
}

TEST(Inverse, reports_numbers_that_are_not_finite) {
  const Spatial arm = any_arm(presets::panda());
  const Vector<kOpen> start = Vector<kOpen>::Constant(7, 0.1);
  InverseKinematics inverse(arm, Pose{});
  auto target = kinematics_at<Pose>(arm, start).tip;
  const double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(inverse.solve(target, Vector<kOpen>::Constant(7, kNan)).status, Status::kNotFinite);
  target.R(0, 0) = kNan;
  EXPECT_EQ(inverse.solve(target, start).status, Status::kNotFinite);
  target = kinematics_at<Pose>(arm, start).tip;
  target.p(1) = std::numeric_limits<double>::infinity();
  EXPECT_EQ(inverse.solve(target, start).status, Status::kNotFinite);
  EXPECT_EQ(inverse.solve(target, start).q, start);
}

TEST(Inverse, rejects_options_out_of_range) {
  const Spatial arm = any_arm(presets::panda());
  InverseOptions<> options;
  options.starts = 0;
  EXPECT_EQ(complaint([&] { InverseKinematics(arm, Pose{}, options); }), "starts = 0: must be at least 1");
  options = {};
  options.tolerance = 0.0;
  EXPECT_EQ(complaint([&] { InverseKinematics(arm, Pose{}, options); }), "tolerance = 0: must be positive and finite");
  auto limits = arm.limits();
  limits.lower(2) = 1.0;
  limits.upper(2) = 0.5;
  EXPECT_EQ(complaint([&] { InverseKinematics(arm, Pose{}, {}, limits); }),
            "limits.lower[2] = 1: must be at most upper = 0.5");
}

/// A joint with the range [a, a] stays at a.
TEST(Inverse, keeps_a_locked_joint) {
  const Spatial arm = any_arm(presets::panda());
  auto limits = arm.limits();
  limits.lower(2) = limits.upper(2) = 0.3;
  InverseKinematics inverse(arm, Pose{}, patient(), limits);
  Random random(12);
  for (int k = 0; k < trials(50); ++k) {
    const auto target = kinematics_at<Pose>(arm, random_posture(random, limits)).tip;
    const auto found = inverse.solve(target, random_posture(random, arm.limits()));
    EXPECT_TRUE(found.solved()) << k;
    EXPECT_EQ(found.q(2), 0.3);
  }
}

/// search() finds several postures. All eight branches of a UR5e are found from enough starts.
TEST(Inverse, finds_all_branches_of_an_arm_with_six_joints) {
  const Spatial arm = any_arm(presets::ur5e());
  InverseOptions<> options;
  options.starts = 300;
  InverseKinematics inverse(arm, Pose{}, options);
  const Vector<kOpen> q = Vector<6>{0.3, -1.1, 1.4, -0.9, 1.2, 0.4};
  const auto target = kinematics_at<Pose>(arm, q).tip;
  std::vector<Vector<kOpen>> branches;
  (void)inverse.search(target, q, [&](const auto& found) noexcept {
    expect_at<Pose>(arm, found, target, 1e-6);
    const bool known = std::any_of(branches.begin(), branches.end(), [&](const auto& branch) {
      const Vector<kOpen> turns = (branch - found.q) / (2.0 * kPi);
      return (turns - Vector<kOpen>(turns.array().round())).cwiseAbs().maxCoeff() < 1e-3;
    });
    if (!known) branches.push_back(found.q);
    return false;
  });
  EXPECT_EQ(branches.size(), 8U);
}

constexpr int kTip = Robot<7>::kTip;

/// A posture below a pose is approached as far as the pose allows: no other motion in the null space is nearer.
TEST(InverseOfStacks, approaches_a_posture_below_a_pose) {
  const Robot<7> robot(presets::panda());
  const Stack stack(PoseTask<>{LinkFrame<>(kTip), {1.0, 1.0}}, PostureTask<7>{{1.0, 1.0}});
  const RobotTasks tasks(robot, stack);
  InverseKinematics inverse(robot, stack, patient());
  Random random(13);
  double steepest = 0.0;
  for (int k = 0; k < trials(50); ++k) {
    const Vector<7> start = random_posture(random, robot.limits());
    const Vector<7> rest = random_posture(random, robot.limits());
    auto target = kinematics_at<decltype(stack)::Space>(tasks, random_posture(random, robot.limits())).tip;
    std::get<1>(target) = rest;
    const auto found = inverse.solve(target, start);
    ASSERT_TRUE(found.solved()) << k;
    expect_within(robot.limits(), found.q);
    // The gradient of the distance is nearly perpendicular to the null space, except toward an end of a range.
    const auto at = kinematics_at<decltype(stack)::Space>(tasks, found.q);
    const Matrix<6, 7> J = std::get<0>(at.levels).J;
    const Vector<7> z = J.fullPivLu().kernel().col(0).normalized();
    const double slope = z.dot(rest - found.q);
    const Vector<7> step = (slope > 0.0 ? 1e-6 : -1e-6) * z;
    const Vector<7> moved = found.q + step;
    const bool at_end =
        ((moved - robot.limits().upper).array() > 0.0).any() || ((robot.limits().lower - moved).array() > 0.0).any();
    if (!at_end) steepest = std::max(steepest, std::abs(slope) / (rest - found.q).norm());
  }
  EXPECT_LE(steepest, 0.03);
  std::printf("slope of the distance along the null space: at most %.3f\n", steepest);
}

/// The first level is reached exactly, although the second contradicts it.
TEST(InverseOfStacks, keep_their_priorities) {
  const Robot<7> robot(presets::panda());
  const Stack stack(PositionTask<>{LinkFrame<>(kTip), {1.0, 1.0}}, AxisTask<>(LinkFrame<>(kTip), {1.0, 1.0}));
  const RobotTasks tasks(robot, stack);
  InverseKinematics inverse(robot, stack);
  const Vector<7> q = {0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785};
  auto target = kinematics_at<decltype(stack)::Space>(tasks, q).tip;
  const auto found = inverse.solve(target, Vector<7>(Vector<7>::Constant(-0.2)));
  ASSERT_TRUE(found.solved());
  EXPECT_LE(found.error, 1e-6);
  // A pose and another position of the same tip.
  const Stack torn(PoseTask<>{LinkFrame<>(kTip), {1.0, 1.0}}, PositionTask<>{LinkFrame<>(kTip), {1.0, 1.0}});
  const RobotTasks torn_tasks(robot, torn);
  InverseKinematics torn_inverse(robot, torn);
  auto both = kinematics_at<decltype(torn)::Space>(torn_tasks, q).tip;
  std::get<1>(both)(2) += 0.1;
  const auto nearest = torn_inverse.solve(both, q);
  EXPECT_EQ(nearest.status, Status::kNotFound);
  EXPECT_NEAR(nearest.error, 0.1, 1e-6);
  const auto reached = kinematics_at<decltype(torn)::Space>(torn_tasks, nearest.q);
  EXPECT_LE(Pose::difference<double>(std::get<0>(both), std::get<0>(reached.tip)).norm(), 2e-6);
}

TEST(InverseOfStacks, find_postures_of_two_arms) {
  const Robot<14> robot(presets::two_pandas());
  const Stack stack(TaskLevel(PoseTask<>{LinkFrame<>(7), {1.0, 1.0}}, PoseTask<>{LinkFrame<>(14), {1.0, 1.0}}));
  const RobotTasks tasks(robot, stack);
  InverseKinematics inverse(robot, stack, patient());
  Random random(14);
  for (int k = 0; k < trials(100); ++k) {
    const auto target = kinematics_at<decltype(stack)::Space>(tasks, random_posture(random, robot.limits())).tip;
    const auto found = inverse.solve(target, random_posture(random, robot.limits()));
    EXPECT_TRUE(found.solved()) << k;
    expect_within(robot.limits(), found.q);
  }
}

/// The joints of the other arm stay where they start.
TEST(InverseOfStacks, leave_joints_that_move_no_task) {
  const Robot<14> robot(presets::two_pandas());
  const Stack stack(PoseTask<>{LinkFrame<>(7), {1.0, 1.0}});
  const RobotTasks tasks(robot, stack);
  InverseKinematics inverse(robot, stack, patient());
  Random random(15);
  for (int k = 0; k < trials(50); ++k) {
    const Vector<14> start = random_posture(random, robot.limits());
    const auto target = kinematics_at<decltype(stack)::Space>(tasks, random_posture(random, robot.limits())).tip;
    const auto found = inverse.solve(target, start);
    EXPECT_TRUE(found.solved()) << k;
    EXPECT_EQ((found.q - start).tail<7>().norm(), 0.0) << k;
  }
}

/// A table with a post, and a wall that the tip does not pass.
struct Cell {
  Robot<7> robot = Robot<7>(presets::panda());
  Stack<TaskLevel<PoseTask<>>> stack{TaskLevel<PoseTask<>>(PoseTask<>{LinkFrame<>(kTip), {1.0, 1.0}})};
  Clearance<7> clearance{presets::panda(),
                         presets::capsules::panda(),
                         {{"table", HalfSpace<>{{0.0, 0.0, 1.0}, 0.0}},
                          {"post", Capsule<>{{0.4, 0.3, 0.0}, {0.4, 0.3, 1.0}, 0.05}},
                          {"left", HalfSpace<>{{0.0, -1.0, 0.0}, -0.35}},
                          {"right", HalfSpace<>{{0.0, 1.0, 0.0}, -0.35}},
                          {"ceiling", HalfSpace<>{{0.0, 0.0, -1.0}, -0.75}}},
                         0.01,
                         presets::never_collide::panda()};
  TaskBounds<7> walls = wall();

  [[nodiscard]] static TaskBounds<7> wall() {
    TaskBounds<7> bounds(presets::panda());
    PositionBounds<> before{LinkFrame<>(kTip)};
    before.upper(0) = 0.5;
    bounds.keep(before);
    return bounds;
  }
};

/// Every target that a posture within the bounds reaches is reached within the bounds.
TEST(InverseWithinBounds, finds_postures_clear_of_obstacles) {
  Cell cell;
  const RobotTasks tasks(cell.robot, cell.stack);
  Bounds bounds(cell.clearance, cell.walls);
  InverseKinematics inverse(cell.robot, cell.stack, patient(), cell.robot.limits(), bounds);
  InverseKinematics blind(cell.robot, cell.stack, patient());
  Random random(16);
  int beyond = 0;
  int solved = 0;
  int all = 0;
  while (all < trials(200)) {
    const Vector<7> q = random_posture(random, cell.robot.limits());
    if (!complaint([&] { bounds.require(q); }).empty()) continue;
    ++all;
    const Vector<7> start = random_posture(random, cell.robot.limits());
    const auto target = kinematics_at<decltype(cell.stack)::Space>(tasks, q).tip;
    const auto found = inverse.solve(target, start);
    if (found.solved()) {
      ++solved;
      EXPECT_LE(found.error, 1e-6);
      EXPECT_EQ(complaint([&] { bounds.require(found.q); }), "");
      expect_within(cell.robot.limits(), found.q);
    }
    const auto near = blind.solve(target, start);
    beyond += complaint([&] { bounds.require(near.q); }).empty() ? 0 : 1;
  }
  EXPECT_GE(solved, all - all / 100);
  EXPECT_GE(beyond, all / 10) << "the bounds must matter";
}

/// A posture with a large tolerance may be far from its target, and keeps the bounds.
TEST(InverseWithinBounds, keeps_the_bounds_with_every_tolerance) {
  Cell cell;
  const RobotTasks tasks(cell.robot, cell.stack);
  for (const double tolerance : {1e-8, 1e-4, 1e-3, 1e-2, 1e-1}) {
    InverseOptions<> options = patient();
    options.tolerance = tolerance;
    Bounds bounds(cell.clearance, cell.walls);
    InverseKinematics inverse(cell.robot, cell.stack, options, cell.robot.limits(), bounds);
    Random random(18);
    int solved = 0;
    for (int i = 0; i < trials(60); ++i) {
      const auto q = random_posture(random, cell.robot.limits());
      const auto target = kinematics_at<decltype(cell.stack)::Space>(tasks, q).tip;
      const auto found = inverse.solve(target, random_posture(random, cell.robot.limits()));
      if (!found.solved()) continue;
      ++solved;
      EXPECT_LE(found.error, tolerance);
      EXPECT_EQ(complaint([&] { bounds.require(found.q); }), "") << tolerance;
    }
    EXPECT_GT(solved, 0);
  }
}

TEST(InverseWithinBounds, finds_nothing_behind_a_wall) {
  Cell cell;
  const RobotTasks tasks(cell.robot, cell.stack);
  InverseKinematics inverse(cell.robot, cell.stack, {}, cell.robot.limits(), Bounds(cell.walls));
  const Vector<7> q = {0.0, 0.5, 0.0, -1.5, 0.0, 2.0, 0.785};
  const auto target = kinematics_at<decltype(cell.stack)::Space>(tasks, q).tip;
  ASSERT_GT(std::get<0>(target).p(0), 0.52);
  const auto found = inverse.solve(target, q);
  EXPECT_EQ(found.status, Status::kNotFound);
  EXPECT_EQ(found.starts, 64);
}

}  // namespace
}  // namespace fpbm::test::inverse_laws
