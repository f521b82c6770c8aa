#include "fpbm/bound/task_bounds.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "fpbm/bound/speed_bounds.hpp"
#include "fpbm/realtime/tracker.hpp"
#include "support/arms.hpp"
#include "support/wild_reference.hpp"

/// Bounds of tasks: a wall for any point of the robot, a cone for any axis, and a speed.
namespace fpbm::test::task_bounds_laws {
namespace {

constexpr int kOpen = Eigen::Dynamic;
constexpr int kTip = -1;
constexpr double kTick = 1e-3;
constexpr double kSlack = 1e-9;

template <Level kLevel>
[[nodiscard]] auto scheme() {
  if constexpr (kLevel == Level::kVelocity) {
    return MVN<kOpen>(5.0);
  } else {
    return FPBM<kOpen>(0.5, UnitWeights{}, 20.0, 100.0, NullSpace<kOpen>().with_damping(2.0));
  }
}

template <Level kLevel, typename Bound>
using BoundedTracker = Tracker<AnyArm<Position<3>>, Position<3>, decltype(scheme<kLevel>()), Bounds<Bound>>;

template <Level kLevel, typename Bound>
[[nodiscard]] BoundedTracker<kLevel, Bound> tracker_of(const AnyArm<Position<3>>& arm, const Vector<kOpen>& q,
                                                       const Bound& bound, double tick = kTick) {
  return {arm,
          Position<3>{},
          scheme<kLevel>(),
          State<kOpen>{q, 0.0 * q},
          TrackerOptions<>{tick},
          Limits<kLevel, kOpen>(arm.limits(), tick),
          Vector<kOpen>(0.0 * q),
          Bounds(bound)};
}

/// A frame on a link. The pose of the frame is independent of the kinematics of the clearance.
struct Frame {
  LinkFrame<> frame;
  Chain<> chain;

  Frame(const Chain<>& chain_, int link, const Transform<>& offset) : frame(link, offset), chain(chain_) {}

  /// By products of the transformations of the joints, without Robot.
  [[nodiscard]] Transform<> at(const Vector<kOpen>& q) const {
    Transform<> pose;
    const auto count = frame.link() == kTip ? static_cast<Eigen::Index>(chain.joints.size()) : frame.link();
    for (Eigen::Index i = 0; i < count; ++i) {
      const Joint<>& joint = chain.joints[static_cast<std::size_t>(i)];
      const int leader = joint.mimic.joint < 0 ? static_cast<int>(i) : joint.mimic.joint;
      const double position = (joint.mimic.joint < 0 ? 1.0 : joint.mimic.ratio) * q(leader) + joint.mimic.offset;
      Transform<> moved;
      const Vector<3> axis = joint.axis.normalized();
      if (joint.type == JointType::kPrismatic) {
        moved.p = position * axis;
      } else {
        moved.R = rotation(Vector<3>(position * axis));
      }
      pose = pose * joint.placement * moved;
    }
    if (frame.link() == kTip) pose = pose * chain.tip;
    return pose * frame.offset();
  }
};

struct Excess {
  double place = -1.0;  ///< Excess over a wall [m], and over a cone [rad]. Negative inside.
  double angle = -10.0;
  double joints = 0.0;
  int blocked = 0;
};

/// Moves an arm for 4 s with jumping references. Walls bound a point of a link, and a cone bounds an axis of another
/// link.
template <Level kLevel>
[[nodiscard]] Excess pull(const Chain<>& chain, std::uint32_t seed, double h) {
  Random random(seed);
  const AnyArm<Position<3>> arm = any_arm(chain);
  const Vector<kOpen> q0 = spread_posture(arm.limits(), static_cast<int>(seed % 7) + 1);
  const auto joints = static_cast<int>(chain.joints.size());
  const auto link = [&](bool tip) { return tip ? kTip : std::max(2, joints - 1 - static_cast<int>(seed % 3)); };
  const auto offset = [&] {
    return Transform<>{random.uniform(3, -0.1, 0.1), rotation(Vector<3>(random.uniform(3, -1.0, 1.0)))};
  };
  const Frame point(chain, link(seed % 2 == 0), offset());
  const Frame turned(chain, link(seed % 2 != 0), offset());
  const Vector<3> p0 = point.at(q0).p;
  const Vector<3> axis = random.uniform(3, -1.0, 1.0).normalized();
  const Vector<3> a0 = turned.at(q0).R * axis;
  const Vector<3> away = random.uniform(3, -0.3, 0.3);
  const Vector<3> d = rotation(away).lazyProduct(a0);
  const double least = std::acos(std::min(1.0, a0.dot(d)));

  PositionBounds<> walls{point.frame};
  for (int i = 0; i < 3; ++i) {
    if (random.uniform(0.0, 1.0) < 0.7) walls.lower(i) = p0(i) - random.uniform(0.01, 0.2);
    if (random.uniform(0.0, 1.0) < 0.7) walls.upper(i) = p0(i) + random.uniform(0.01, 0.2);
  }
  if (seed % 3 == 0) walls.deceleration = 2.0;
  AxisBounds<> cone{turned.frame, axis, d};
  cone.upper = least + random.uniform(0.02, 0.5);
  if (seed % 4 == 0) cone.lower = std::max(0.0, least - random.uniform(0.02, 0.1));
  TaskBounds<kOpen> kept(chain);
  kept.keep(walls);
  kept.keep(cone);

  auto tracker = tracker_of<kLevel>(arm, q0, kept, h);
  const auto& bounds = arm.limits();
  Excess excess;
  Vector<kOpen> q = q0;
  Vector<kOpen> qd = 0.0 * q0;
  auto target = Reference<Position<3>>::hold(tracker.tip());
  const Vector<3> tip = tracker.tip();
  for (int k = 0; k * h < 4.0; ++k) {
    if (k % static_cast<int>(std::lround(0.4 / h)) == 0) target.x = tip + Vector<3>(random.uniform(3, -0.6, 0.6));
    const auto tick = tracker.tick(target);
    excess.blocked += tick.status == Status::kBlocked ? 1 : 0;
    const Vector<3> p = point.at(tick.q).p;
    excess.place = std::max({excess.place, (walls.lower - p).maxCoeff(), (p - walls.upper).maxCoeff()});
    const double angle = std::acos(std::clamp(d.dot(turned.at(tick.q).R * axis), -1.0, 1.0));
    excess.angle = std::max({excess.angle, angle - cone.upper, cone.lower - angle});
    const Vector<kOpen> rate = (tick.q - q) / h;
    const Vector<kOpen> change = (tick.qd - qd) / h;
    excess.joints = std::max({excess.joints, (tick.q - bounds.upper).maxCoeff(), (bounds.lower - tick.q).maxCoeff(),
                              (rate.cwiseAbs() - bounds.velocity).maxCoeff(),
                              h * (change.cwiseAbs() - bounds.acceleration).maxCoeff()});
    q = tick.q;
    qd = tick.qd;
  }
  return excess;
}

template <Level kLevel>
void expect_bounds_hold(int motions, double tick) {
  Excess worst;
  int reached = 0;
  for (int seed = 0; seed < motions; ++seed) {
    for (const auto& chain : {presets::panda(), presets::ur5e(), panda_on_rail(), coupled_panda()}) {
      const Excess excess = pull<kLevel>(chain, static_cast<std::uint32_t>(seed), tick);
      EXPECT_LE(excess.place, kSlack) << "seed " << seed << ", joints " << chain.joints.size();
      EXPECT_LE(excess.angle, 1e-7) << "seed " << seed << ", joints " << chain.joints.size();  // acos near 0.
      worst.place = std::max(worst.place, excess.place);
      worst.angle = std::max(worst.angle, excess.angle);
      worst.joints = std::max(worst.joints, excess.joints);
      reached += excess.blocked > 0 ? 1 : 0;
    }
  }
  std::printf("walls %.2g m, cones %.2g rad, joints %.2g; %d of %d motions met a bound\n", worst.place, worst.angle,
              worst.joints, reached, 4 * motions);
  EXPECT_LE(worst.joints, 1e-9);
  EXPECT_GE(reached, 2 * motions);
  EXPECT_GE(worst.place, -1e-3);  // Bounds are reached, not only kept.
  EXPECT_GE(worst.angle, -1e-2);
}
TEST(TaskBounds, hold_at_every_tick) {
  for (const double tick : {1e-3, 4e-3, 2e-2}) {
    SCOPED_TRACE(tick);
    expect_bounds_hold<Level::kAcceleration>(trials(12) + 3, tick);
    expect_bounds_hold<Level::kVelocity>(trials(12) + 3, tick);
  }
}

/// A point that moves straight toward a wall brakes with the given deceleration, and stops at the wall.
template <Level kLevel>
void expect_gentle_stop() {
  const Chain<> chain = presets::panda();
  const AnyArm<Position<3>> arm = any_arm(chain);
  const Vector<kOpen> q0 = Vector<7>{0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785};
  const Frame point(chain, kTip, {});
  constexpr double kDeceleration = 0.5;
  const double wall = point.at(q0).p(1) + 0.2;
  PositionBounds<> bounds{point.frame};
  bounds.upper(1) = wall;
  bounds.deceleration = kDeceleration;
  TaskBounds<kOpen> kept(chain);
  kept.keep(bounds);
  auto tracker = tracker_of<kLevel>(arm, q0, kept);
  auto target = Reference<Position<3>>::hold(tracker.tip());
  target.x(1) += 0.4;
  double y = tracker.tip()(1);
  double speed = 0.0;
  double fastest = 0.0;
  double hardest = 0.0;
  double before = 0.0;
  for (int k = 0; k < 8000; ++k) {
    (void)tracker.tick(target);
    const double now = (tracker.tip()(1) - y) / kTick;
    y += kTick * now;
    if (k % 20 == 0) {  // Over several ticks: by velocity, differences over one tick are inaccurate.
      if (before > 0.0) hardest = std::max(hardest, (before - now) / (20 * kTick));
      before = now;
    }
    speed = now;
    fastest = std::max(fastest, speed);
    EXPECT_LE(y, wall + kSlack);
    EXPECT_LE(speed * speed / 2.0, kDeceleration * (wall - y) + 1e-6);
  }
  std::printf("deceleration %.3f of %.1f m/s2 from %.2f m/s; %.1e m from the wall, at %.1e m/s\n", hardest,
              kDeceleration, fastest, wall - y, speed);
  EXPECT_GE(fastest, 0.25);
  EXPECT_LE(hardest, 1.1 * kDeceleration);
  EXPECT_LE(wall - y, 1e-3);
  EXPECT_LE(std::abs(speed), 1e-4);
}
TEST(TaskBounds, stop_gently_before_a_wall) {
  expect_gentle_stop<Level::kAcceleration>();
  expect_gentle_stop<Level::kVelocity>();
}

/// The speed of an axis, and of one coordinate of a point of a link, is kept if the joint bounds admit it.
TEST(TaskBounds, keep_speeds) {
  const Chain<> chain = presets::panda();
  const AnyArm<Position<3>> arm = any_arm(chain);
  const Vector<kOpen> q0 = Vector<7>{0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785};
  const Frame elbow(chain, 4, {});
  const Frame hand(chain, kTip, {});
  SpeedBounds<kOpen> speeds(chain);
  speeds.keep({elbow.frame, 0.05, {false, false, true}});
  speeds.keep({hand.frame, 0.2, {true, true, true}, Vector<3>::UnitZ()});
  auto tracker = tracker_of<Level::kAcceleration>(arm, q0, speeds);
  Random random(1);
  const Vector<3> tip = tracker.tip();
  auto target = Reference<Position<3>>::hold(tip);
  double fastest[2] = {0.0, 0.0};
  Transform<> at[2] = {elbow.at(q0), hand.at(q0)};
  for (int k = 0; k < 10000; ++k) {
    if (k % 1000 == 0) target.x = tip + Vector<3>(random.uniform(3, -0.2, 0.2));
    const auto tick = tracker.tick(target);
    const Transform<> next[2] = {elbow.at(tick.q), hand.at(tick.q)};
    if (tick.saturated != 0) {
      at[0] = next[0];
      at[1] = next[1];
      continue;
    }
    fastest[0] = std::max(fastest[0], std::abs(next[0].p(2) - at[0].p(2)) / kTick);
    fastest[1] = std::max(fastest[1], (next[1].R.col(2) - at[1].R.col(2)).norm() / kTick);
    at[0] = next[0];
    at[1] = next[1];
  }
  std::printf("elbow %.4f of 0.05 m/s, axis %.4f of 0.2 rad/s\n", fastest[0], fastest[1]);
  EXPECT_LE(fastest[0], 1.02 * 0.05);
  EXPECT_GE(fastest[0], 0.99 * 0.05);
  EXPECT_LE(fastest[1], 1.05 * 0.2);  // The direction changes in a tick.
  EXPECT_GE(fastest[1], 0.99 * 0.2);
}

/// Invalid bounds are rejected, and the message names the error.
TEST(TaskBounds, name_the_invalid_argument) {
  const Chain<> chain = presets::panda();
  const auto with = [&](const auto& bounds) { return complaint([&] { TaskBounds<7>(chain).keep(bounds); }); };
  AxisBounds<> cone{{kTip}, Vector<3>::UnitZ(), Vector<3>::Zero()};
  EXPECT_EQ(with(cone), "direction = 0: must be a nonzero vector");
  cone.direction = Vector<3>::UnitX();
  cone.lower = -0.1;
  EXPECT_EQ(with(cone), "lower = -0.1: must be finite and not negative");
  cone.lower = 1.0;
  cone.upper = 0.5;
  EXPECT_EQ(with(cone), "lower = 1: must be below upper");
  cone.upper = 2.0;
  cone.deceleration = 0.0;
  EXPECT_EQ(with(cone), "deceleration = 0: must be positive, or infinite");
}

}  // namespace
}  // namespace fpbm::test::task_bounds_laws
