#include <gtest/gtest.h>

#include <Eigen/SVD>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "fpbm/realtime/stack_tracker.hpp"
#include "fpbm/task/axis_task.hpp"
#include "fpbm/task/center_of_mass_task.hpp"
#include "fpbm/task/orientation_task.hpp"
#include "fpbm/task/pose_task.hpp"
#include "fpbm/task/position_task.hpp"
#include "fpbm/task/posture_task.hpp"
#include "fpbm/task/relative_task.hpp"
#include "support/arms.hpp"
#include "support/bodies.hpp"
#include "support/random.hpp"

/// Stacks of tasks in strict priority: tasks have their documented rows, no level disturbs a higher level, and no bound
/// is exceeded.
namespace fpbm::test::stack_laws {
namespace {

constexpr int kTip = Robot<7>::kTip;
constexpr double kTick = 1e-3;

[[nodiscard]] const Robot<7>& panda() {
  static const Robot<7> robot(presets::panda());
  return robot;
}
[[nodiscard]] auto balanced() {
  return Balanced<7>(0.6, DiagonalWeights<7>(Vector<7>(Vector<7>::Ones())), NullSpace<7>().with_damping(2.0));
}
[[nodiscard]] Vector<7> random_posture(Random& random) {
  const auto& limits = panda().limits();
  Vector<7> q;
  for (Eigen::Index i = 0; i < 7; ++i) {
    q(i) = limits.lower(i) + random.uniform(0.15, 0.85) * (limits.upper(i) - limits.lower(i));
  }
  return q;
}

/// Axis alignment of the tip, position, height of the elbow, posture.
[[nodiscard]] auto level_tip() {
  const TaskGains<> gains(10.0, 25.0);
  return Stack(AxisTask<>{{kTip}, gains}, PositionTask<>{{kTip}, gains}, PositionTask<1>{{4}, gains, {2}},
               PostureTask<7>{TaskGains<>(4.0, 4.0)});
}
template <int N>
void expect_kinematics_of(const Chain<>& chain) {
  const Robot<N> robot(chain);
  const SerialArm<N> arm(chain);
  EXPECT_NEAR(robot.length(), arm.length(), 1e-12);
  Random random(1);
  for (int trial = 0; trial < trials(100); ++trial) {
    const Vector<N> q = random.uniform(robot.dof(), -2.0, 2.0);
    const Vector<N> qd = random.uniform(robot.dof(), -2.0, 2.0);
    RobotState<N> state;
    robot.update(q, qd, state);
    Kinematics<Pose, N> expected;
    arm.kinematics(q, qd, expected);
    const Transform<> tip = robot.frame(state, Robot<N>::kTip, robot.in_joint(Robot<N>::kTip, {}));
    Matrix<6, N> J;
    Matrix<6, N> Jd;
    robot.jacobian(state, Robot<N>::kTip, tip.p, J, Jd);
    EXPECT_LT((tip.p - expected.tip.p).norm() + (tip.R - expected.tip.R).norm(), 1e-12);
    EXPECT_LT((J - expected.J).norm(), 1e-12);
    EXPECT_LT((Jd - expected.Jd).norm(), 1e-11);
  }
}

TEST(Robot, has_the_kinematics_of_serial_arms) {
  for (const Chain<>& chain : {presets::ur5e(), presets::iiwa14(), panda_on_rail()}) {
    expect_kinematics_of<Eigen::Dynamic>(chain);
  }
  expect_kinematics_of<7>(presets::panda());
}

TEST(Robot, places_its_links_at_their_joints_frames) {
  const Chain<> chain = panda_on_rail();
  const Robot<Eigen::Dynamic> robot(chain);
  Random random(2);
  const Vector<Eigen::Dynamic> q = random.uniform(robot.dof(), -1.0, 1.0);
  RobotState<Eigen::Dynamic> state;
  robot.update(q, q, state);
  Transform<> at;
  for (int i = 0; i < robot.dof(); ++i) {
    const auto& joint = chain.joints[static_cast<std::size_t>(i)];
    const Vector<3> axis = joint.axis.normalized();
    const bool slides = joint.type == JointType::kPrismatic;
    Transform<> moved;
    if (slides) {
      moved.p = q(i) * axis;
    } else {
      moved.R = rotation(Vector<3>(q(i) * axis));
    }
    at = at * joint.placement * moved;
    const Transform<> link = robot.frame(state, i + 1, robot.in_joint(i + 1, {}));
    EXPECT_LT((link.p - at.p).norm() + (link.R - at.R).norm(), 1e-12) << i;
  }
}

/// S J and S J̇ of a task by central differences of its point and of J q̇.
template <typename Task>
inline constexpr bool kIsAxis = std::is_same_v<Task, AxisTask<>> || std::is_same_v<Task, RelativeTask<AxisTask<>>>;
template <int N, int Joints, typename Task>
void expect_derivatives(const Robot<N, double, Joints>& robot, Task task) {
  using Space = typename Task::Space;
  struct At {
    typename Space::template Point<double> x;
    Vector<Space::kRows> xd;
    Matrix<Task::kRows, Space::kRows> S;
    LevelRows<Task::kRows, N, double> rows;
  };
  task.bind(robot);
  const int dof = robot.dof();
  const auto at = [&](const Vector<N>& q, const Vector<N>& qd) {
    RobotState<N, double, Joints> state;
    robot.update(q, qd, state);
    At result;
    result.rows.resize(Task::kRows, dof);
    task.evaluate(robot, state, result.x, result.xd, result.S, TaskRows(result.rows, 0));
    return result;
  };
  const double h = 1e-6;
  Random random(3);
  for (int trial = 0; trial < trials(50); ++trial) {
    const Vector<N> q = random.uniform(dof, -2.0, 2.0);
    const Vector<N> qd = random.uniform(dof, -1.0, 1.0);
    const At here = at(q, qd);
    Matrix<Task::kRows, N> J(Task::kRows, dof);
    Matrix<Task::kRows, N> Jd(Task::kRows, dof);
    for (int j = 0; j < dof; ++j) {
      const Vector<N> unit = Vector<N>::Unit(dof, j);
      const Vector<Space::kRows> change =
          Space::template difference<double>(at(q + h * unit, qd).x, at(q - h * unit, qd).x) / (2.0 * h);
      J.col(j) = here.S * change;
      Vector<Space::kRows> rate = (at(q + h * qd, unit).xd - at(q - h * qd, unit).xd) / (2.0 * h);
      if constexpr (kIsAxis<Task>) rate -= cross(here.xd, here.x) * here.x.dot(at(q, unit).xd);
      Jd.col(j) = here.S * rate;
    }
    EXPECT_LT((here.rows.J - J).norm(), 1e-8);
    EXPECT_LT((here.S * here.xd - here.rows.J * qd).norm(), 1e-12);
    EXPECT_LT((here.rows.Jd - Jd).norm(), 1e-7);
    if constexpr (kIsAxis<Task>) {
      // Derivative of the angular velocity perpendicular to the axis.
      const auto turning = [&](const At& state) { return Vector<3>(state.xd - state.xd.dot(state.x) * state.x); };
      const Vector<3> rate = (turning(at(q + h * qd, qd)) - turning(at(q - h * qd, qd))) / (2.0 * h);
      EXPECT_LT((here.rows.Jd * qd - here.S * rate).norm(), 1e-7);
    }
  }
}

/// For every link: even and odd numbers of joints before the link, with and without prismatic joints.
template <int N>
void expect_derivatives_of_all_tasks(const Chain<>& chain) {
  const Robot<N> robot(chain);
  Transform<> offset;
  offset.p = Vector<3>(0.1, -0.2, 0.05);
  offset.R = rotation(Vector<3>(0.3, 0.5, -0.2));
  const TaskGains<> gains(1.0, 1.0);
  for (int link = kTip; link <= robot.dof(); ++link) {
    SCOPED_TRACE(testing::Message() << robot.dof() << " joints, link " << link);
    const LinkFrame<double> frame{link, offset};
    expect_derivatives(robot, PositionTask<>{frame, gains});
    expect_derivatives(robot, PositionTask<2>{frame, gains, {2, 0}});
    expect_derivatives(robot, PositionTask<2>{frame, gains, {2, 0}, true});
    expect_derivatives(robot, OrientationTask<>{frame, gains});
    expect_derivatives(robot, PoseTask<>{frame, gains});
    expect_derivatives(robot, AxisTask<>{frame, gains, Vector<3>(0.0, 2.0, 1.0)});
  }
  expect_derivatives(robot, PostureTask<3>{gains, {5, 0, 3}});
}

TEST(Task, has_the_rows_of_its_point_s_derivative) {
  expect_derivatives_of_all_tasks<6>(presets::ur5e());
  expect_derivatives_of_all_tasks<7>(presets::panda());
  expect_derivatives_of_all_tasks<Eigen::Dynamic>(panda_on_rail());
}

/// Frames of two arms, of the torso that carries both, and of one arm. A joint that moves both frames does not
/// contribute.
template <int N, int Joints>
void expect_derivatives_of_relative_tasks(const Tree<>& tree) {
  const Robot<N, double, Joints> robot(tree);
  Transform<> offset;
  offset.p = Vector<3>(0.1, -0.2, 0.05);
  offset.R = rotation(Vector<3>(0.3, 0.5, -0.2));
  const TaskGains<> gains(1.0, 1.0);
  for (const auto& [link, other] : {std::pair{9, 16}, {16, 8}, {9, 1}, {4, 0}, {5, 3}, {2, 9}}) {
    SCOPED_TRACE(testing::Message() << "link " << link << " in " << other);
    const LinkFrame<> frame{link, offset};
    const LinkFrame<> reference{other, inverse(offset)};
    expect_derivatives(robot, RelativePoseTask<>{{frame, gains}, reference});
    expect_derivatives(robot, RelativeTask{PositionTask<2>{frame, gains, {2, 0}}, reference});
    expect_derivatives(robot, RelativeTask{PositionTask<2>{frame, gains, {2, 0}, true}, reference});
    expect_derivatives(robot, RelativeTask{OrientationTask<>{frame, gains}, reference});
    expect_derivatives(robot, RelativeTask{AxisTask<>{frame, gains, Vector<3>(0.0, 2.0, 1.0)}, reference});
  }
  expect_derivatives(robot, CenterOfMassTask<>{gains});
  expect_derivatives(robot, CenterOfMassTask<2>{gains, {2, 0}});
}

TEST(Task, of_a_tree_has_the_rows_of_its_point_s_derivative) {
  Tree<> tree = two_pandas(true);
  Random random(6);
  tree.base = {3.0, random.uniform(3, -0.3, 0.3)};
  for (auto& each : tree.joints) each.joint.moved = {random.uniform(0.1, 4.0), random.uniform(3, -0.2, 0.2)};
  tree.joints[5].joint.type = JointType::kPrismatic;
  expect_derivatives_of_relative_tasks<16, 16>(tree);
  tree.joints[7].joint.mimic = {3, -0.7, 0.2};
  tree.joints[12].joint.mimic = {1, 0.5, 0.0};
  expect_derivatives_of_relative_tasks<14, 16>(tree);
  expect_derivatives_of_relative_tasks<Eigen::Dynamic, Eigen::Dynamic>(tree);
}

TEST(Task, names_the_invalid_argument_for_a_tree) {
  auto tree = two_pandas(true);
  for (auto& each : tree.joints) each.joint.moved = {};
  const Robot<16> robot(tree);
  const TaskGains<> gains(1.0, 1.0);
  const auto bound = [&](auto task) { return complaint([&] { task.bind(robot); }); };
  EXPECT_EQ(bound(RelativePoseTask<>{{{9}, gains}, {9}}),
            "reference_frame: moves with the task's frame: must be on another link");
  EXPECT_EQ(bound(PoseTask<>{{kTip}, gains}),
            "frame = -1: must be the number of a link: a tree has no tip, name one of its frames");
  EXPECT_EQ(bound(RelativePoseTask<>{{{9}, gains}, {17}}), "frame = 17: must be the number of a link, at most 16");
  EXPECT_EQ(bound(CenterOfMassTask<>{gains}), "robot has no mass: give the mass of at least one link");
}

TEST(Direction, difference_turns_one_to_the_other) {
  Random random(4);
  for (int trial = 0; trial < trials(1000); ++trial) {
    const Vector<3> x = Vector<3>(random.uniform(3, -1.0, 1.0)).normalized();
    Vector<3> y = Vector<3>(random.uniform(3, -1.0, 1.0)).normalized();
    if (trial % 10 == 0) y = -x;
    if (trial % 10 == 1) y = x;
    const Vector<3> d = Direction::difference<double>(x, y);
    EXPECT_LT((Direction::displace<double>(y, d) - x).norm(), 1e-7);
    EXPECT_LT(std::abs(d.dot(y)), 1e-12);
  }
}
/// From 1e-8 to 0.5 rad, where the series is used up to 0.125 rad, and for vectors of any length.
TEST(Direction, difference_is_the_rotation_vector_of_small_angles) {
  Random random(5);
  for (int trial = 0; trial < trials(1000); ++trial) {
    const Vector<3> y = Vector<3>(random.uniform(3, -1.0, 1.0)).normalized();
    const double angle = std::pow(10.0, random.uniform(-8.0, std::log10(0.5)));
    const Vector<3> turn = angle * cross(y, Vector<3>(random.uniform(3, -1.0, 1.0))).normalized();
    const Vector<3> x = rotation(turn) * y;
    EXPECT_LT((Direction::difference<double>(x, y) - turn).norm(), 2e-15 + 1e-14 * angle);
    EXPECT_LT((Direction::difference<double>(Vector<3>(3.0 * x), y) - turn).norm(), 2e-15 + 1e-14 * angle);
  }
}

/// Ticks of a stack of one pose task and of that task alone are equal. first: scheme of the stack, whose gains are in
/// gains.
template <typename First, typename Scheme>
void expect_ticks_of_the_task(const First& first, const TaskGains<>& gains, const Scheme& scheme) {
  const Vector<7> q0{0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785};
  const Stack stack(PoseTask<>{{kTip}, gains});
  auto tracker = stack_tracker(panda(), stack, first, q0);
  Tracker expected(SerialArm<7>(presets::panda()), Pose{}, scheme, q0);
  const WithRotation path(InPlane(Path(Circle(0.3), 1.5), Vector<3>::UnitY(), Vector<3>::UnitZ()));
  PathFollower follower(path, expected.tip());
  int limited = 0;
  for (int i = 0; i < 2000; ++i) {
    const Reference<Pose> reference = follower.ahead(0.0);
    auto joined = Reference<typename decltype(stack)::Space>::hold({reference.x});
    joined.xd = reference.xd;
    joined.xdd = reference.xdd;
    const auto one = expected.tick(reference);
    const auto same = tracker.tick(joined);
    follower.advance(kTick);
    limited += one.scale < 1.0 ? 1 : 0;
    ASSERT_LT((one.q - same.q).norm(), 1e-11) << i;  // Limited motions amplify round-off errors.
    ASSERT_NEAR(one.scale, same.scale, 1e-8) << i;
    ASSERT_EQ(one.status, same.status);
  }
  EXPECT_GT(limited, 100);
  Kinematics<Pose, 7> kinematics;
  expected.arm().kinematics(expected.state().q, kinematics);
  const double least = Eigen::MatrixXd(kinematics.J).jacobiSvd().singularValues()(5);
  EXPECT_LE(expected.sigma(), least);
  EXPECT_GE(expected.sigma(), least / std::sqrt(6.0));
}

TEST(Stack, of_one_level_is_the_tracker_of_that_task) {
  const Vector<7> ones = Vector<7>::Ones();
  const DiagonalWeights<7> weights(ones);
  const auto null_space = NullSpace<7>().with_damping(2.0);
  expect_ticks_of_the_task(Balanced<7>(0.6, weights, null_space), TaskGains<>(10.0, 25.0),
                           FPBM<7>(0.6, weights, 10.0, 25.0, null_space));
  expect_ticks_of_the_task(WMVN<7>(weights), TaskGains<>(5.0), WMVN<7>(weights, 5.0));
}

/// Random levels of 1, 2 and 3 rows.
struct Levels {
  Matrix<2, 7> first;
  Matrix<1, 7> second;
  Matrix<3, 7> third;

  explicit Levels(Random& random)
      : first(random.uniform(2, 7, -1.0, 1.0)),
        second(random.uniform(1, 7, -1.0, 1.0)),
        third(random.uniform(3, 7, -1.0, 1.0)) {}
};

template <typename... Matrices>
[[nodiscard]] TaskLevels<7, double, Matrices...> task_levels(const Matrices&... J) {
  return TaskLevels<7, double, Matrices...>(J...);
}

/// Motions of one, two and three levels within bounds, with rows and bounds on jerk.
template <Level kLevel>
void expect_no_interference() {
  JointLimits<7> bounds = panda().limits();
  const Limits<kLevel, 7> limits(bounds, kTick);
  const Limiter<kLevel, 7> limiter(limits);
  Random random(5);
  double worst = 0.0;
  int limited[3] = {};
  for (int trial = 0; trial < trials(3000); ++trial) {
    const Levels levels(random);
    State<7> state{random_posture(random), Vector<7>(0.02 * random.uniform(7, -1.0, 1.0))};
    const Vector<7> last = trial % 2 == 0 ? Vector<7>(Vector<7>::Zero()) : Vector<7>(random.uniform(7, -0.5, 0.5));
    const double size = random.uniform(0.2, 3.0);
    Vector<7> desired = size * bounds.acceleration.cwiseProduct(Vector<7>(random.uniform(7, -1.0, 1.0)));
    if constexpr (kLevel == Level::kVelocity) desired *= kTick;
    Rows<7, 2> rows{random.uniform(7, 2, -1.0, 1.0), {}, trial % 3};
    for (int k = 0; k < 2; ++k) {
      rows.b(k) = random.uniform(0.1, 1.0) * std::abs(rows.g.col(k).dot(desired)) + 0.1 * kTick;
    }
    const auto three =
        limiter.motion(task_levels(levels.first, levels.second, levels.third), state, desired, last, rows);
    const auto two = limiter.motion(task_levels(levels.first, levels.second), state, desired, last, rows);
    const auto one = limiter.motion(levels.first, state, desired, last, rows);
    const double unit = desired.norm() + one.u.norm();
    worst =
        std::max({worst, (levels.first * (three.u - one.u)).norm() / unit,
                  (levels.first * (two.u - one.u)).norm() / unit, (levels.second * (three.u - two.u)).norm() / unit});
    const Box<7> box = limits.box(state, last);
    EXPECT_TRUE(box.contains(three.u));
    // The excess over a row is at most the excess of the motion without jerk, or of the first level.
    const Vector<7> steady = kLevel == Level::kAcceleration ? last : Vector<7>(state.qd + kTick * last);
    const Vector<7> from = rows.near(box.nearest(steady), box);
    for (int k = 0; k < rows.count; ++k) {
      EXPECT_LE(rows.excess(k, three.u), std::max({rows.excess(k, one.u), rows.excess(k, from), 0.0}) + 1e-9 * unit);
    }
    EXPECT_EQ(three.scales[0], three.scale);
    EXPECT_NEAR(three.scale, one.scale, 1e-12);
    for (std::size_t k = 0; k < 3; ++k) limited[k] += three.scales[k] < 1.0 ? 1 : 0;
  }
  std::printf("higher levels differ by %.1e; limited %d, %d, %d\n", worst, limited[0], limited[1], limited[2]);
  EXPECT_LT(worst, 1e-10);
  EXPECT_GT(limited[0], trials(100));
  EXPECT_GT(limited[2], limited[0]);
}

TEST(Stack, no_level_disturbs_a_higher_one_within_limits) {
  expect_no_interference<Level::kAcceleration>();
  expect_no_interference<Level::kVelocity>();
}

TEST(Stack, no_level_disturbs_a_higher_one) {
  const auto stack = level_tip();
  const RobotTasks tasks(panda(), stack);
  const RobotTasks fewer(panda(), Stack(std::get<0>(stack.tasks()), std::get<1>(stack.tasks())));
  const ByLevels<decltype(balanced()), std::decay_t<decltype(stack)>> scheme(balanced());
  const ByLevels<decltype(balanced()), std::decay_t<decltype(fewer.stack())>> without(balanced());
  Random random(6);
  for (int trial = 0; trial < trials(500); ++trial) {
    const State<7> state{random_posture(random), Vector<7>(random.uniform(7, -1.0, 1.0))};
    Kinematics<decltype(stack)::Space, 7> kinematics;
    tasks.kinematics(state.q, state.qd, kinematics);
    auto reference = Reference<decltype(stack)::Space>::hold(kinematics.tip);
    reference.xdd = random.uniform(reference.xdd.size(), -1.0, 1.0);
    Kinematics<std::decay_t<decltype(fewer.stack())>::Space, 7> few;
    fewer.kinematics(state.q, state.qd, few);
    auto same = Reference<std::decay_t<decltype(fewer.stack())>::Space>::hold(few.tip);
    same.xdd = reference.xdd.head<6>();
    Vector<7> u;
    Vector<7> alone;
    ASSERT_EQ(scheme.resolve(kinematics, reference, state, u), Status::kOk);
    ASSERT_EQ(without.resolve(few, same, state, alone), Status::kOk);
    const double unit = 1.0 + u.norm() + alone.norm();
    EXPECT_LT((std::get<0>(kinematics.levels).J * (u - alone)).norm(), 1e-10 * unit);
    EXPECT_LT((std::get<1>(kinematics.levels).J * (u - alone)).norm(), 1e-10 * unit);
  }
}

/// A cup is carried upright while the position, the elbow and the posture reach their limits.
TEST(Stack, keeps_its_first_level_while_lower_ones_are_limited) {
  const Vector<7> q0{0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785};
  auto tracker = stack_tracker(panda(), level_tip(), balanced(), q0);
  const auto x0 = tracker.tip();
  const auto upright = Reference<Direction>::hold(std::get<0>(x0));
  const auto place = Reference<Position<3>>::hold(std::get<1>(x0) + Vector<3>(0.1, 0.5, -0.2));
  const auto height = Reference<Position<3>>::hold(std::get<2>(x0) + Vector<3>(0.0, 0.0, 0.1));
  const auto posture = Reference<JointSpace<7>>::hold(q0);
  double worst = 0.0;
  int limited = 0;
  double away = 0.0;
  for (int i = 0; i < 8000; ++i) {
    const auto tick = tracker.tick(upright, place, height, posture);
    worst = std::max(worst, tick.error.head<3>().norm());
    limited += tick.scale == 1.0 && tick.status == Status::kSlowed ? 1 : 0;
    away = tick.error.segment<3>(3).norm();
  }
  std::printf("tilt %.1e rad, %d ticks with limited lower levels\n", worst, limited);
  EXPECT_LT(worst, 1e-7);
  EXPECT_GT(limited, 50);
  EXPECT_LT(away, 1e-6);
}

/// Excess over the bounds on position, velocity, acceleration and jerk by differences of q, relative to the bounds.
template <int N>
class Excess {
 public:
  Excess(const JointLimits<N>& bounds, const Vector<N>& q0)
      : bounds_(bounds), q_(q0), qd_(Vector<N>::Zero(q0.size())), last_(qd_) {}

  template <typename Result>
  void see(const Result& tick) {
    for (Eigen::Index i = 0; i < q_.size(); ++i) {
      const double acceleration = (tick.qd(i) - qd_(i)) / kTick;
      worst = std::max({worst, tick.q(i) - bounds_.upper(i), bounds_.lower(i) - tick.q(i),
                        std::abs(tick.q(i) - q_(i)) / kTick / bounds_.velocity(i) - 1.0,
                        std::abs(acceleration) / bounds_.acceleration(i) - 1.0,
                        std::abs(acceleration - last_(i)) / kTick / bounds_.jerk(i) - 1.0});
      last_(i) = acceleration;
    }
    q_ = tick.q;
    qd_ = tick.qd;
  }
  double worst = -1.0;

 private:
  JointLimits<N> bounds_;
  Vector<N> q_;
  Vector<N> qd_;
  Vector<N> last_;
};

constexpr int kOpen = Eigen::Dynamic;

/// Robots of 4 to 8 joints, with and without bounds on jerk, on a rail, and in the plane.
[[nodiscard]] std::vector<std::pair<std::string, Chain<>>> robots() {
  Chain<> planar;
  for (int i = 0; i < 4; ++i) {
    Joint<> joint;
    if (i > 0) joint.placement.p = Vector<3>(0.3, 0.0, 0.0);
    joint.bounds = {-2.5, 2.5, 2.0, 10.0, 500.0};
    planar.joints.push_back(joint);
  }
  planar.tip.p = Vector<3>(0.3, 0.0, 0.0);
  Chain<> rail = panda_on_rail();
  return {{"panda", presets::panda()},
          {"gen3", presets::gen3()},
          {"ur5e", presets::ur5e()},
          {"rail", rail},
          {"planar", planar}};
}

/// Finite bounds for all joints.
[[nodiscard]] JointLimits<kOpen> finite(JointLimits<kOpen> limits) {
  for (Eigen::Index i = 0; i < limits.lower.size(); ++i) {
    limits.lower(i) = std::max(limits.lower(i), -3.0);
    limits.upper(i) = std::min(limits.upper(i), 3.0);
    limits.velocity(i) = std::min(limits.velocity(i), 3.0);
    limits.acceleration(i) = std::min(limits.acceleration(i), 20.0);
  }
  return limits;
}

/// Targets that jump, conflict, and are unreachable: bounds hold, and the robot stops by itself and on command. In a
/// third of the motions, a joint starts on its bound.
template <typename Tasks, typename Scheme>
void expect_to_keep_bounds(const std::string& name, const Chain<>& chain, const Tasks& stack, const Scheme& scheme) {
  using Space = typename Tasks::Space;
  constexpr int kSeconds = 40;
  const Robot<kOpen> robot(chain);
  const Limits<Scheme::kLevel, kOpen> limits(finite(robot.limits()), kTick);
  const auto& bounds = limits.bounds();
  const Vector<kOpen> none = Vector<kOpen>::Zero(robot.dof());
  int moving = 0;
  double worst = -1.0;
  const int motions = trials(30, trials(3));
  for (int k = 0; k < motions; ++k) {
    Random random(static_cast<std::uint32_t>(100 + k));
    Vector<kOpen> q0 = bounds.lower;
    for (Eigen::Index i = 0; i < q0.size(); ++i)
      q0(i) += random.uniform(0.15, 0.85) * (bounds.upper(i) - bounds.lower(i));
    if (k % 3 == 2) q0(k % robot.dof()) = bounds.upper(k % robot.dof());
    auto tracker = stack_tracker(robot, stack, scheme, State<kOpen>{q0, none}, TrackerOptions<>{}, limits);
    Excess<kOpen> excess(bounds, q0);
    const auto jump = [&](double size) {
      const Vector<Space::kRows> by = random.uniform(Space::kRows, -size, size);
      return Reference<Space>::hold(Space::template displace<double>(tracker.tip(), by));
    };
    auto reference = jump(1.2);
    double speed = 0.0;
    for (int i = 0; i < 1000 * kSeconds; ++i) {
      if (i == 500 || i == 900) reference = jump(0.6);
      if (i == 1500) reference = jump(1.2);
      const auto tick = tracker.tick(reference);
      excess.see(tick);
      if (i >= 1000 * (kSeconds - 1)) speed = std::max(speed, tick.qd.cwiseAbs().maxCoeff());
      ASSERT_TRUE(tick.q.allFinite());
    }
    // An arm that creeps along its bounds stops later: after a stall, or after a recovery.
    for (int second = 0; second < kSeconds && speed > 1e-3; ++second) {
      speed = 0.0;
      for (int i = 0; i < 1000; ++i) {
        const auto tick = tracker.tick(reference);
        excess.see(tick);
        speed = std::max(speed, tick.qd.cwiseAbs().maxCoeff());
      }
    }
    moving += speed > 1e-3 ? 1 : 0;
    reference = jump(1.2);
    for (int i = 0; i < 3000; ++i) {
      if (i == 300) tracker.stop();
      const auto tick = tracker.tick(reference);
      excess.see(tick);
      speed = tick.qd.norm();
    }
    EXPECT_LT(speed, 1e-9) << k;
    worst = std::max(worst, excess.worst);
  }
  std::printf("%s: %d motions, bounds exceeded by %.1e, %d not at rest\n", name.c_str(), motions, worst, moving);
  EXPECT_LT(worst, 1e-9);
  EXPECT_LE(moving, motions / 30);  // 1 of all 300 motions (docs/priority.md).
}

TEST(Stack, keeps_every_bound_and_comes_to_rest_by_acceleration) {
  const TaskGains<> gains(10.0, 25.0);
  const Stack stack(AxisTask<>{{kTip}, gains}, PositionTask<>{{kTip}, gains}, PositionTask<1>{{3}, gains, {2}},
                    PostureTask<4>{TaskGains<>(4.0, 4.0)});
  for (const auto& [name, chain] : robots()) {
    const auto n = static_cast<Eigen::Index>(chain.joints.size());
    const auto scheme = Balanced<kOpen>(0.6, DiagonalWeights<kOpen>(Vector<kOpen>(Vector<kOpen>::Ones(n))),
                                        NullSpace<kOpen>().with_damping(2.0));
    expect_to_keep_bounds(name + " by acceleration", chain, stack, scheme);
  }
}
TEST(Stack, keeps_every_bound_and_comes_to_rest_by_velocity) {
  const TaskGains<> gains(5.0);
  const Stack stack(PositionTask<2>{{kTip}, gains}, PositionTask<>{{3}, gains}, PostureTask<4>{TaskGains<>(2.0)});
  for (const auto& [name, chain] : robots()) {
    expect_to_keep_bounds(name + " by velocity", chain, stack, MVN<kOpen>());
  }
}

/// Two trackers of one stack move identically to a random target near the start.
template <typename Tracker, typename Other>
void expect_same_motion(Tracker tracker, Other other, std::uint32_t seed) {
  Random random(seed);
  const auto [place, axis] = tracker.tip();
  const auto position = Reference<Position<3>>::hold(place + Vector<3>(random.uniform(3, -0.1, 0.1)));
  const auto direction = Reference<Direction>::hold(rotation(Vector<3>(random.uniform(3, -0.2, 0.2))) * axis);
  for (int i = 0; i < 1500; ++i) {
    const auto tick = tracker.tick(position, direction);
    const auto expected = other.tick(position, direction);
    ASSERT_LT((tick.q - expected.q).norm(), 1e-9) << "seed " << seed << ", tick " << i;
    ASSERT_EQ(tick.status, expected.status) << "seed " << seed << ", tick " << i;
  }
}

/// Six joints, a position and an axis: code of fixed size resolves the level by its self-motion, other code by the rows
/// of J. Two robots, both levels, regular postures.
TEST(Stack, of_a_position_and_an_axis_moves_by_its_self_motion) {
  const auto stack_of = [](const TaskGains<>& gains) {
    return Stack(TaskLevel(PositionTask<>{{kTip}, gains}, AxisTask<>{{kTip}, gains}));
  };
  const Vector<6> weights = Vector<6>::LinSpaced(6, 1.0, 4.0);
  for (const Chain<>& chain : {presets::ur5e(), presets::ur10e()}) {
    for (std::uint32_t seed = 0; seed < 5; ++seed) {
      Random random(seed);
      const Vector<6> q0 = Vector<6>{0.0, -1.2, 1.4, -0.6, 1.2, 0.4} + Vector<6>(random.uniform(6, -0.2, 0.2));
      const auto by_acceleration = [&](auto size) {
        constexpr int N = decltype(size)::value;
        const auto scheme = Balanced<N>(0.6, DiagonalWeights<N>(Vector<N>(weights)), NullSpace<N>().with_damping(2.0));
        return stack_tracker(Robot<N>(chain), stack_of({10.0, 25.0}), scheme, Vector<N>(q0));
      };
      const auto by_velocity = [&](auto size) {
        constexpr int N = decltype(size)::value;
        const auto scheme = WMVN<N>(DiagonalWeights<N>(Vector<N>(weights)));
        return stack_tracker(Robot<N>(chain), stack_of(TaskGains<>(5.0)), scheme, Vector<N>(q0));
      };
      constexpr std::integral_constant<int, 6> kSix{};
      constexpr std::integral_constant<int, kOpen> kAny{};
      expect_same_motion(by_acceleration(kSix), by_acceleration(kAny), seed);
      expect_same_motion(by_velocity(kSix), by_velocity(kAny), seed);
    }
  }
}

/// The tasks of a cup with references, for the tests below.
struct Cup {
  const Vector<7> q0{0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785};
  decltype(stack_tracker(panda(), level_tip(), balanced(), Vector<7>())) tracker;
  Reference<Direction> upright;
  Reference<Position<3>> place;
  Reference<Position<3>> height;
  Reference<JointSpace<7>> posture;

  explicit Cup(const Vector<3>& by, const TrackerOptions<>& options = {})
      : tracker(stack_tracker(panda(), level_tip(), balanced(), q0, options)),
        upright(Reference<Direction>::hold(std::get<0>(tracker.tip()))),
        place(Reference<Position<3>>::hold(std::get<1>(tracker.tip()) + by)),
        height(Reference<Position<3>>::hold(std::get<2>(tracker.tip()))),
        posture(Reference<JointSpace<7>>::hold(q0)) {}

  auto tick() { return tracker.tick(upright, place, height, posture); }
  void run(int ticks) {
    for (int i = 0; i < ticks; ++i) (void)tick();
  }
  [[nodiscard]] double away() const { return (std::get<1>(tracker.tip()) - place.x).norm(); }
};

/// Each task has its own source of references, here a path and a target filter.
TEST(Stack, has_a_source_of_references_for_each_task) {
  const TaskGains<> gains(20.0, 100.0);
  const Vector<7> q0{0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785};
  auto tracker =
      stack_tracker(panda(), Stack(PositionTask<>{{kTip}, gains}, PositionTask<>{{4}, gains}), balanced(), q0);
  const auto [tip, elbow] = tracker.tip();
  PathFollower follower(InPlane(Path(Circle(0.05), 5.0), Vector<3>::UnitY(), Vector<3>::UnitZ()), tip);
  TargetFilter<Position<3>> filter(elbow, {0.2, 1.0, 20.0});
  filter.push(elbow + Vector<3>(0.0, 0.03, 0.0));
  double worst = 0.0;
  for (int i = 0; i < 3000; ++i) worst = std::max(worst, tracker.tick(follower, filter).error.head<3>().norm());
  EXPECT_NEAR(follower.time(), 3.0, 1e-9);
  EXPECT_LT(worst, 1e-6);
  EXPECT_LT((filter.reference().x - elbow - Vector<3>(0.0, 0.03, 0.0)).norm(), 1e-6);
  tracker.stop();
  for (int i = 0; i < 1000; ++i) (void)tracker.tick(follower, filter);
  EXPECT_NEAR(follower.time(), 3.0, 1e-9);
}

/// An infeasible task stops with scale 0, and follows its target again when the target returns.
TEST(Stack, reports_the_stopped_level) {
  Cup cup(Vector<3>(0.6, 0.8, 0.2));
  cup.run(20000);
  auto tick = cup.tick();
  EXPECT_LT(tick.qd.norm(), 1e-3);
  EXPECT_EQ(tick.status, Status::kSlowed);
  EXPECT_EQ(tick.scales[0], 1.0);
  EXPECT_EQ(tick.scales[1], 0.0);
  cup.place.x -= Vector<3>(0.5, 0.7, 0.2);
  cup.run(6000);
  EXPECT_LT(cup.away(), 1e-5);
  EXPECT_EQ(cup.tick().scales[1], 1.0);
}

/// The angle of an axis to its target satisfies θ̈ + k₁θ̇ + k₂θ = 0, while lower levels rotate the frame about the axis
/// (docs/kinematics.md, "Axis of a frame").
TEST(Stack, no_rotation_about_an_axis_disturbs_the_axis) {
  const TaskGains<> gains(10.0, 25.0);
  const Vector<7> q0{0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785};
  auto tracker = stack_tracker(panda(), Stack(AxisTask<>{{kTip}, gains}, PostureTask<7>{gains}), balanced(), q0);
  const auto [axis, posture] = tracker.tip();
  const auto target = Reference<Direction>::hold((axis + Vector<3>(0.05, 0.03, 0.0)).normalized());
  auto turned = Reference<JointSpace<7>>::hold(posture);
  turned.x(6) -= 1.5;
  const double angle = Direction::difference<double>(target.x, axis).norm();
  double spin = 0.0;
  for (int i = 0; i < 1500; ++i) {
    const double t = i * kTick;
    const auto tick = tracker.tick(target, turned);
    EXPECT_NEAR(tick.error.head<3>().norm(), angle * (1.0 + 5.0 * t) * std::exp(-5.0 * t), 2e-6) << i;
    spin = std::max(spin, std::abs(tick.qd(6)));
  }
  EXPECT_GT(spin, 0.2);
}

/// The integral of a stopped task causes no motion.
TEST(Stack, a_stopped_task_has_no_integral) {
  TrackerOptions<> options;
  options.integral_gain = 5.0;
  Cup cup(Vector<3>(0.6, 0.8, 0.2), options);
  cup.run(40000);
  EXPECT_LT(cup.tick().qd.norm(), 1e-3);
  cup.place.x -= Vector<3>(0.5, 0.7, 0.2);
  cup.run(40000);
  EXPECT_LT(cup.away(), 1e-4);
}

/// The state that holds lower levels during a stop or a failure is discarded: the same targets are reached afterwards.
TEST(Stack, continues_after_a_stop_and_after_a_failure) {
  for (const bool fails : {false, true}) {
    Cup cup(Vector<3>(0.0, 0.1, 0.0));
    cup.run(100);
    const Vector<3> axis = cup.upright.x;
    if (fails) {
      cup.upright.x(0) = std::numeric_limits<double>::quiet_NaN();
      EXPECT_TRUE(failed(cup.tick().status));
      EXPECT_EQ(cup.tick().scales[1], 0.0);
    } else {
      cup.tracker.stop();
    }
    cup.run(8000);
    EXPECT_GT(cup.away(), 0.05);
    cup.upright.x = axis;
    cup.tracker.resume();
    cup.run(5000);
    EXPECT_LT(cup.away(), 1e-6) << fails;
  }
}

/// A lower level without a finite reference does not corrupt the integral of the error.
TEST(Stack, an_integral_outlasts_a_reference_that_is_not_finite) {
  TrackerOptions<> options;
  options.integral_gain = 5.0;
  Cup cup(Vector<3>(0.0, 0.1, 0.0), options);
  const double z = cup.height.x(2);
  cup.height.x(2) = std::numeric_limits<double>::quiet_NaN();
  cup.run(500);
  cup.height.x(2) = z;
  cup.run(40000);  // The slowest root of s³ + 10 s² + 25 s + 5 is −0.22.
  EXPECT_LT(cup.away(), 1e-5);
  EXPECT_EQ(cup.tick().scales[2], 1.0);
}

/// A coordinate that a task does not select has no error: the other coordinates of a height target are arbitrary.
TEST(Stack, coordinates_that_are_not_selected_have_no_error) {
  TrackerOptions<> options;
  options.integral_gain = 5.0;
  Cup near(Vector<3>(0.0, 0.1, 0.0), options);
  Cup far(Vector<3>(0.0, 0.1, 0.0), options);
  far.height.x.head<2>() += Vector<2>(3.0, -2.0);
  for (int i = 0; i < 12000; ++i) {
    const auto tick = far.tick();
    EXPECT_LT((near.tick().q - tick.q).norm(), 1e-12) << i;
    EXPECT_EQ(tick.error.segment<2>(6).norm(), 0.0) << i;
  }
}

/// Contribution of the integral to the reference acceleration after 10 s of errors: 0.01 rad of an axis, and `place` on
/// the level below, whose task scale is `share`.
[[nodiscard]] Vector<6> integral(const Vector<3>& place, double share) {
  using Space = Stack<TaskLevel<AxisTask<>>, TaskLevel<PositionTask<>>>::Space;
  TrackerOptions<> options;
  options.integral_gain = 5.0;
  options.integral_bound = 0.1;
  Correction<Level::kAcceleration, Space> correction(options);
  Tick<Space, 7> tick{};
  tick.scales = {1.0, share};
  Vector<6> error;
  error << 0.01, 0.0, 0.0, place;
  for (int i = 0; i < 10000; ++i) {
    correction.begin(error, 1.0);
    correction.integrate(tick);
  }
  return correction(Reference<Space>::hold(Space::origin<double>())).xdd;
}

/// A steady-state error of a lower level does not reduce the integral of a higher level. Each integral has the whole
/// bound.
TEST(Stack, has_an_integral_for_each_task) {
  const double missing = std::numeric_limits<double>::quiet_NaN();
  const Vector<3> far(0.0, 0.09, 0.0);
  EXPECT_TRUE(integral(far, 1.0).isApprox((Vector<6>() << 0.1, 0.0, 0.0, 0.0, 0.1, 0.0).finished(), 1e-9));
  EXPECT_EQ(integral(far, 0.5).tail<3>(), Vector<3>::Zero().eval());
  EXPECT_EQ(integral(Vector<3>::Constant(missing), 1.0).tail<3>(), Vector<3>::Zero().eval());
  EXPECT_NEAR(integral(Vector<3>::Constant(missing), 1.0)(0), 0.1, 1e-9);
}

/// With measured states that are one tick old, the first level is kept while limits slow the other levels.
TEST(Stack, resolves_measured_states) {
  Cup cup(Vector<3>(0.1, 0.2, -0.1));
  auto targets =
      Reference<decltype(level_tip())::Space>::hold({cup.upright.x, cup.place.x, cup.height.x, cup.posture.x});
  State<7> state{cup.q0, Vector<7>::Zero()};
  State<7> seen = state;
  Excess<7> excess(panda().limits(), cup.q0);
  double tilt = 0.0;
  int slowed = 0;
  Tick<decltype(level_tip())::Space, 7> tick;
  for (int i = 0; i < 8000; ++i) {
    const auto answer = cup.tracker.resolve_measured(seen.q, seen.qd, targets);
    seen = state;
    state.q += kTick * (state.qd + 0.5 * kTick * answer.qdd);
    state.qd += kTick * answer.qdd;
    tick = answer;
    tick.q = state.q;
    tick.qd = state.qd;
    excess.see(tick);
    tilt = std::max(tilt, answer.error.head<3>().norm());
    slowed += answer.scales[1] < 1.0 || answer.scales[2] < 1.0 ? 1 : 0;
  }
  std::printf("measured: tilt %.1e rad, %d ticks slowed, %.1e m away, bounds exceeded by %.1e\n", tilt, slowed,
              tick.error.segment<3>(3).norm(), excess.worst);
  EXPECT_LT(tilt, 2e-3);
  EXPECT_GT(slowed, 10);
  EXPECT_LT(tick.error.segment<3>(3).norm(), 1e-4);
  EXPECT_LT(excess.worst, 1e-6);
}

TEST(Stack, a_level_without_a_finite_reference_stops_alone) {
  const Vector<7> q0{0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785};
  auto tracker = stack_tracker(panda(), level_tip(), balanced(), q0);
  const auto x0 = tracker.tip();
  const auto upright = Reference<Direction>::hold(std::get<0>(x0));
  const auto place = Reference<Position<3>>::hold(std::get<1>(x0) + Vector<3>(0.0, 0.1, 0.0));
  auto height = Reference<Position<3>>::hold(std::get<2>(x0));
  height.x(2) = std::numeric_limits<double>::quiet_NaN();
  const auto posture = Reference<JointSpace<7>>::hold(q0);
  for (int i = 0; i < 4000; ++i) {
    const auto tick = tracker.tick(upright, place, height, posture);
    ASSERT_TRUE(tick.q.allFinite());
    ASSERT_EQ(tick.scales[2], 0.0);
    ASSERT_FALSE(failed(tick.status));
  }
  EXPECT_LT((std::get<1>(tracker.tip()) - place.x).norm(), 1e-6);
  height.x = std::get<2>(tracker.tip());
  EXPECT_EQ(tracker.tick(upright, place, height, posture).scales[2], 1.0);
}

/// Levels are enabled and disabled while the robot moves: no bound is exceeded, and enabled levels are executed.
TEST(Stack, levels_are_enabled_and_disabled_at_run_time) {
  const Vector<7> q0{0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785};
  auto tracker = stack_tracker(panda(), level_tip(), balanced(), q0);
  const auto x0 = tracker.tip();
  const auto upright = Reference<Direction>::hold(std::get<0>(x0));
  const auto place = Reference<Position<3>>::hold(std::get<1>(x0) + Vector<3>(0.2, 0.3, -0.1));
  const auto height = Reference<Position<3>>::hold(std::get<2>(x0));
  const auto posture = Reference<JointSpace<7>>::hold(q0);
  Excess<7> excess(panda().limits(), q0);
  const auto run = [&](int ticks) {
    double tilt = 0.0;
    for (int i = 0; i < ticks; ++i) {
      const auto tick = tracker.tick(upright, place, height, posture);
      excess.see(tick);
      tilt = std::max(tilt, tick.error.head<3>().norm());
    }
    return tilt;
  };
  const auto away = [&] { return (std::get<1>(tracker.tip()) - place.x).norm(); };
  double tilt = run(300);
  tracker.enable(1, false);
  tracker.enable(2, false);
  tilt = std::max(tilt, run(6000));
  EXPECT_LT((tracker.state().q - q0).norm(), 0.05);  // The posture task moves the robot back.
  EXPECT_GT(away(), 0.2);
  tracker.enable(1, true);
  for (int i = 0; i < 20; ++i) {  // Frequent changes.
    tracker.enable(2 + i % 2, i % 3 == 0);
    tilt = std::max(tilt, run(50));
  }
  tracker.enable(2, false);
  tilt = std::max(tilt, run(5000));
  EXPECT_LT(away(), 1e-6);
  EXPECT_LT(tilt, 1e-5);
  EXPECT_LT(excess.worst, 1e-9);
}

TEST(Stack, rejects_invalid_arguments) {
  const Vector<7> q0 = 0.5 * (panda().limits().lower + panda().limits().upper);
  const TaskGains<> gains(10.0, 25.0);
  EXPECT_THROW(RobotTasks(panda(), Stack(PoseTask<>{{8}, gains})), std::invalid_argument);
  EXPECT_THROW(RobotTasks(panda(), Stack(PositionTask<1>{{kTip}, gains, {3}})), std::invalid_argument);
  EXPECT_THROW(RobotTasks(panda(), Stack(PostureTask<1>{gains, {7}})), std::invalid_argument);
  EXPECT_THROW(AxisTask<>({kTip}, gains, Vector<3>::Zero()), std::invalid_argument);
  EXPECT_THROW(RobotTasks(panda(), Stack(PositionTask<2>{{kTip}, gains, {1, 1}})), std::invalid_argument);
  EXPECT_THROW(RobotTasks(panda(), Stack(PostureTask<2>{gains, {1, 1}})), std::invalid_argument);
  EXPECT_THROW(RobotTasks(panda(), Stack(TaskLevel(PoseTask<>{{kTip}, gains}, AxisTask<>{{3}, gains}))),
               std::invalid_argument);
  Transform<> skew;
  skew.R(0, 1) = 0.1;
  EXPECT_THROW(LinkFrame<>(kTip, skew), std::invalid_argument);
  EXPECT_THROW(TaskGains<>(-1.0, 1.0), std::invalid_argument);
  const Stack stack(PositionTask<>{{kTip}, gains});
  EXPECT_THROW((void)stack_tracker(panda(), stack, FPBM<7>(0.6, UnitWeights{}, 10.0, 25.0), q0), std::invalid_argument);
  const Stack stiff(PositionTask<>{{kTip}, TaskGains<>(10.0, 1e8)});
  EXPECT_THROW((void)stack_tracker(panda(), stiff, balanced(), q0), std::invalid_argument);
  Cup cup(Vector<3>::Zero());
  for (const int level : {-1, 0, 4, 1000}) EXPECT_FALSE(cup.tracker.enable(level, false));
}

}  // namespace
}  // namespace fpbm::test::stack_laws
