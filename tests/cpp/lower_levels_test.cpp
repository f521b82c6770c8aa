#include "fpbm/realtime/detail/lower_levels.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <type_traits>
#include <vector>

#include "fpbm/any/any_stack.hpp"
#include "fpbm/model/detail/robot_presets.hpp"
#include "fpbm/model/presets.hpp"
#include "fpbm/realtime/stack_tracker.hpp"
#include "fpbm/scheme/schemes.hpp"
#include "support/random.hpp"

/// A task of a lower level whose target is unreachable stops, and stays where it stopped.
namespace fpbm::test::lower_levels {
namespace {

constexpr int N = Eigen::Dynamic;
const AnyFrameTask::Selection kAll{true, true, true, true, true, true};
const AnyFrameTask::Selection kHeight{false, false, true, false, false, false};
using Acceleration = std::integral_constant<Level, Level::kAcceleration>;
using Velocity = std::integral_constant<Level, Level::kVelocity>;

/// Motions of each robot and level. FPBM_MOTIONS=170 tests 1,020 motions. FPBM_TICK=0.001: length of
/// a tick [s].
[[nodiscard]] int motions() {
  const char* given = std::getenv("FPBM_MOTIONS");
  return given != nullptr ? std::atoi(given) : trials(6);
}
[[nodiscard]] double tick_length() {
  const char* given = std::getenv("FPBM_TICK");
  return given != nullptr ? std::atof(given) : 4e-3;
}

struct Subject {
  std::string name;
  Tree<> tree;
  Vector<N> posture;
};

[[nodiscard]] Tree<> panda() {
  Tree<> tree;
  add_arm(tree, presets::panda(), "arm", 0, {});
  return tree;
}
[[nodiscard]] std::vector<Subject> subjects() {
  const Vector<7> ready{0.0, -0.6, 0.0, -2.4, 0.0, 1.8, 0.785};
  Vector<N> both(14);
  both << ready, ready;
  Vector<N> body = Vector<N>::Zero(17);
  body(3) = body(10) = -0.3;
  body(4) = 0.3;
  body(11) = -0.3;
  body(6) = body(13) = 0.6;
  return {{"two Pandas", presets::two_pandas(), both},
          {"upper body", presets::g1_upper_body(), body},
          {"Panda", panda(), Vector<N>(ready)}};
}

/// Three levels of tasks of one robot.
template <typename Kind>
[[nodiscard]] AnyStack stack_of(Kind, int subject, const Tree<>& tree) {
  constexpr bool kSecondOrder = Kind::value == Level::kAcceleration;
  const auto gains = kSecondOrder ? TaskGains<>(20.0, 100.0) : TaskGains<>(5.0);
  const auto stiff = kSecondOrder ? TaskGains<>(100.0, 2500.0) : TaskGains<>(20.0);
  const auto level = [](const AnyFrameTask& task) { return AnyLevel(task, {}, {}); };
  const AnyLevel none({}, {}, {});
  const Vector<3> z(0.0, 0.0, 1.0);
  if (subject == 0) {
    const auto left = frame_of(tree, "left_tip");
    const auto right = frame_of(tree, "right_tip");
    return AnyStack(level({FrameCoordinates::kPose, left, stiff, kAll, false, z, right}),
                    level({FrameCoordinates::kPose, right, gains, kAll, false}),
                    level({FrameCoordinates::kPosition, LinkFrame<>(4), gains, kHeight, false}), none);
  }
  if (subject == 1) {
    const auto left = frame_of(tree, "left_wrist_yaw_link");
    const auto right = frame_of(tree, "right_wrist_yaw_link");
    return AnyStack(level({FrameCoordinates::kPosition, left, gains, kAll, false}),
                    level({FrameCoordinates::kPose, right, gains, kAll, false}),
                    level({FrameCoordinates::kPosition, LinkFrame<>(7), gains, kAll, false}), none);
  }
  const auto tip = frame_of(tree, "arm_tip");
  return AnyStack(level({FrameCoordinates::kAxis, tip, gains, kAll, false}),
                  level({FrameCoordinates::kPosition, tip, gains, kAll, false}),
                  level({FrameCoordinates::kPosition, LinkFrame<>(4), gains, kHeight, false}), none);
}

[[nodiscard]] auto scheme_of(Acceleration, const Vector<N>& q, double stiffness) {
  auto null_space = NullSpace<N>().with_damping(4.0);
  if (stiffness > 0.0) null_space = null_space.with_rest_posture(q, stiffness);
  return Balanced<N>(0.0, UnitWeights{}, null_space);
}
[[nodiscard]] auto scheme_of(Velocity, const Vector<N>& q, double stiffness) {
  NullSpace<N> null_space;
  if (stiffness > 0.0) null_space = null_space.with_rest_posture(q, stiffness / 4.0);
  return MVN<N>(0.0, null_space);
}

/// Index of the first task of a level in the points of an AnyStack.
template <std::size_t kLevel>
inline constexpr std::size_t kTask = 3 * kLevel;

/// Time at rest after which a motion ends [s]: longer than the 20 s after which all joints brake.
constexpr double kStill = 30.0;

struct Motion {
  double speed = 0.0;            ///< Largest joint velocity after 80 s [rad/s].
  std::array<double, 2> away{};  ///< Distance of each lower level from the point where it stopped.
};

template <typename Kind>
[[nodiscard]] Motion motion(Kind kind, int index, const Subject& subject, int k, double h) {
  Random random(static_cast<std::uint32_t>(k));
  Vector<N> q0 = subject.posture;
  for (double& q : q0) q += random.uniform(-0.3, 0.3);
  const bool rests = random.uniform(0.0, 1.0) < 0.7;
  const bool jerk = random.uniform(0.0, 1.0) < 0.4;
  const int far = static_cast<int>(random.uniform(1.0, 4.0));  // Bits of the lower levels with unreachable targets.
  const Robot<N> robot(subject.tree);
  JointLimits<N> bounds = robot.limits();
  q0 = q0.cwiseMax(bounds.lower).cwiseMin(bounds.upper);
  if (jerk) bounds.jerk = random.uniform(30.0, 300.0) * bounds.acceleration;
  TrackerOptions<> options;
  options.dt = h;
  options.keep_first_level = random.uniform(0.0, 1.0) < 0.3;
  const AnyStack stack = stack_of(kind, index, subject.tree);
  auto tracker = stack_tracker(robot, stack, scheme_of(kind, q0, rests ? 4.0 : 0.0),
                               State<N>{q0, Vector<N>::Zero(q0.size())}, options, Limits<Kind::value, N>(bounds, h));
  auto target = decltype(tracker)::Target::hold(tracker.tip());
  const auto displace = [&](auto& point, double size) {
    point.at.p += size * random.uniform(3, -1.0, 1.0).normalized();
    point.at.R = rotation(Vector<3>(random.uniform(3, -0.4, 0.4))) * point.at.R;
  };
  displace(std::get<kTask<1>>(target.x), (far & 1) != 0 ? random.uniform(2.0, 4.0) : 0.05);
  displace(std::get<kTask<2>>(target.x), (far & 2) != 0 ? random.uniform(2.0, 4.0) : 0.05);
  if (index == 0 && (far & 2) != 0) std::get<kTask<2>>(target.x).at.p(2) += random.uniform(0.0, 1.0) < 0.5 ? 2.0 : -2.0;
  using Space = AnyStack::Space;
  const RobotTasks<Robot<N>, AnyStack> tasks(robot, stack);
  LowerLevels<Space> watch(options.stall_time, h);  // Decides as the tracker does.
  Correction<Kind::value, Space> correction(options);
  Kinematics<Space, N> kinematics;
  Motion found;
  std::array<bool, 2> stopped{};
  int still = 0;
  const auto ticks = static_cast<int>(std::lround(82.0 / h));
  for (int i = 0; i < ticks; ++i) {
    tasks.points(tracker.state().q, kinematics);
    auto references = TickReferences<Space>::of([&](double) { return target; }, h);
    (void)watch.hold(references, kinematics, task_error(kinematics, target.x), correction);
    const auto tick = tracker.tick(target);
    auto seen = tick;
    seen.scales.fill(1.0);
    watch.report(seen);
    watch.end_tick(!failed(tick.status), tick.qd, 0.0, kinematics.length);
    const double speed = tick.qd.cwiseAbs().maxCoeff();
    still = speed < 1e-9 ? still + 1 : 0;
    const bool ends = i + 1 == ticks || still * h > kStill;
    if (ends || i * h >= 80.0) found.speed = std::max(found.speed, speed);
    if (!ends) continue;
    const auto held = task_error(kinematics, references.stages[0].x);
    for (std::size_t j = 0; j < 2; ++j) {
      stopped[j] = seen.scales[1 + j] == 0.0;
      const auto row = static_cast<Eigen::Index>((1 + j) * (12 + kMaxDof));
      found.away[j] = stopped[j] ? held.segment(row, 6).norm() : 0.0;
    }
    break;
  }
  if (std::getenv("FPBM_PRINT") != nullptr) {
    std::printf("%s %d: rest %d jerk %d far %d keep %d: speed %.1e away %.1e %.1e stopped %d %d\n",
                subject.name.c_str(), k, rests, jerk, far, options.keep_first_level, found.speed, found.away[0],
                found.away[1], stopped[0], stopped[1]);
  }
  return found;
}

template <typename Kind>
void expect_stops(Kind kind) {
  const double h = tick_length();
  int index = 0;
  for (const Subject& subject : subjects()) {
    int moving = 0;
    int dragged = 0;
    double away = 0.0;
    for (int k = 0; k < motions(); ++k) {
      const Motion found = motion(kind, index, subject, k, h);
      const double most = std::max(found.away[0], found.away[1]);
      moving += found.speed > 1e-3 ? 1 : 0;
      dragged += most > 1e-4 ? 1 : 0;
      away = std::max(away, most);
    }
    std::printf(
        "%s, %s level, %d motions: %d faster than 1e-3 rad/s after 80 s, %d farther from a target than where the task "
        "stopped, by %.1e\n",
        subject.name.c_str(), Kind::value == Level::kAcceleration ? "acceleration" : "velocity", motions(), moving,
        dragged, away);
    EXPECT_EQ(moving, 0);
    EXPECT_EQ(dragged, 0);
    ++index;
  }
}

TEST(LowerLevels, stay_where_they_stopped_at_acceleration_level) {
  expect_stops(Acceleration{});
}
TEST(LowerLevels, stay_where_they_stopped_at_velocity_level) {
  expect_stops(Velocity{});
}

/// A position below the axis of the tip of a Panda jumps or moves out of the workspace, and returns.
TEST(LowerLevels, reach_their_targets_again) {
  const Robot<N> robot(panda());
  const auto tip = frame_of(panda(), "arm_tip");
  const TaskGains<> gains(10.0, 25.0);
  const auto level = [](const AnyFrameTask& task) { return AnyLevel(task, {}, {}); };
  const AnyStack stack(level({FrameCoordinates::kAxis, tip, gains, kAll, false}),
                       level({FrameCoordinates::kPosition, tip, gains, kAll, false}),
                       level({FrameCoordinates::kPosition, LinkFrame<>(4), gains, kHeight, false}),
                       AnyLevel({}, {}, AnyPostureTask({0, 1, 2, 3, 4, 5, 6}, TaskGains<>(4.0, 4.0))));
  const auto scheme = Balanced<N>(0.6, UnitWeights{}, NullSpace<N>().with_damping(2.0));
  const int count = trials(120, trials(12));
  int reached = 0;
  for (int seed = 0; seed < count; ++seed) {
    Random random(static_cast<std::uint32_t>(seed));
    Vector<N> q0 = Vector<7>{0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785};
    for (Eigen::Index i = 0; i < 7; ++i) q0(i) += random.uniform(-0.3, 0.3);
    auto tracker = stack_tracker(robot, stack, scheme, State<N>{q0, Vector<N>::Zero(7)}, TrackerOptions<>{},
                                 Limits<Level::kAcceleration, N>(robot.limits(), TrackerOptions<>{}.dt));
    auto target = decltype(tracker)::Target::hold(tracker.tip());
    Vector<3>& place = std::get<kTask<1>>(target.x).at.p;
    const Vector<3> home = place;
    Vector<3> out = random.uniform(3, -1.0, 1.0);
    out *= random.uniform(0.6, 1.2) / out.norm();
    const int ramp = random.uniform(0.0, 1.0) < 0.5 ? 1 : 3000;
    const auto go = [&](const Vector<3>& to, int ticks) {
      const Vector<3> from = place;
      for (int k = 1; k <= ticks; ++k) {
        place = from + (to - from) * std::min(1.0, static_cast<double>(k) / ramp);
        (void)tracker.tick(target);
      }
    };
    go(home + out, 8000);
    go(home, 10000);
    reached += (std::get<kTask<1>>(tracker.tip()).at.p - home).norm() < 1e-3 ? 1 : 0;
  }
  std::printf("%d of %d positions are reached again\n", reached, count);
  EXPECT_GE(reached, count - std::max(count / 12, 2));
}

}  // namespace
}  // namespace fpbm::test::lower_levels
