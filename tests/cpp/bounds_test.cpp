#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "fpbm/bound/bounds.hpp"
#include "fpbm/bound/preset_capsules.hpp"
#include "fpbm/bound/task_bounds.hpp"
#include "fpbm/model/robot.hpp"
#include "fpbm/realtime/stack_tracker.hpp"
#include "fpbm/realtime/tracker.hpp"
#include "fpbm/task/position_task.hpp"
#include "fpbm/task/posture_task.hpp"
#include "support/arms.hpp"
#include "support/bodies.hpp"
#include "support/wild_reference.hpp"

/// The bounds of a tracker: for every reference, no pair comes closer than its margin, and no wall is passed.
namespace fpbm::test::bounds_laws {
namespace {

constexpr int kOpen = Eigen::Dynamic;

/// MVN, or MAN with null-space damping at acceleration level.
template <Level kLevel, int N>
[[nodiscard]] auto least_norm_scheme() {
  if constexpr (kLevel == Level::kVelocity) {
    return MVN<N>();
  } else {
    return Balanced<N>(0.0, UnitWeights{}, NullSpace<N>().with_damping(2.0));
  }
}
constexpr double kTick = 1e-3;
constexpr double kTicks[] = {1e-3, 4e-3, 2e-2};  ///< [s]
constexpr double kSlack = 1e-9;

/// Calls check(level, tick) for both levels and all ticks. The level is a constant of the type of its argument.
template <typename Check>
void at_both_levels(const Check& check) {
  for (const double tick : kTicks) {
    SCOPED_TRACE(tick);
    check(std::integral_constant<Level, Level::kAcceleration>{}, tick);
    check(std::integral_constant<Level, Level::kVelocity>{}, tick);
  }
}

template <Level kLevel>
[[nodiscard]] auto scheme() {
  if constexpr (kLevel == Level::kVelocity) {
    return MVN<kOpen>(5.0);
  } else {
    return FPBM<kOpen>(0.5, UnitWeights{}, 20.0, 100.0, NullSpace<kOpen>().with_damping(2.0));
  }
}

template <Level kLevel, typename Bounds_ = Bounds<Clearance<kOpen>>>
using BoundedTracker = Tracker<AnyArm<Position<3>>, Position<3>, decltype(scheme<kLevel>()), Bounds_>;

/// The clearance of a tracker.
template <typename Tracker_>
[[nodiscard]] auto& clearance_of(Tracker_& tracker) {
  return tracker.bounds().template get<Clearance<Tracker_::N>>();
}

/// Tracker from a state after a tick with the acceleration qdd0.
template <Level kLevel, typename... Each>
[[nodiscard]] BoundedTracker<kLevel, Bounds<Each...>> tracker_from(const AnyArm<Position<3>>& arm,
                                                                   const State<kOpen>& start, const Vector<kOpen>& qdd0,
                                                                   double tick, const Each&... bounds) {
  return {arm,   Position<3>{},          scheme<kLevel>(),
          start, TrackerOptions<>{tick}, Limits<kLevel, kOpen>(arm.limits(), tick),
          qdd0,  Bounds(bounds...)};
}

/// Tracker from a posture at rest, or in random motion from which the arm can stop.
template <Level kLevel, typename... Each>
[[nodiscard]] auto tracker_from(const AnyArm<Position<3>>& arm, const Vector<kOpen>& q, bool at_rest, Random& random,
                                double tick, const Each&... bounds) {
  const Vector<kOpen> zero = Vector<kOpen>::Zero(q.size());
  if (at_rest) return tracker_from<kLevel>(arm, State<kOpen>{q, zero}, zero, tick, bounds...);
  Vector<kOpen> qd = Vector<kOpen>(random.uniform(q.size(), -0.3, 0.3)).cwiseProduct(arm.limits().velocity);
  Vector<kOpen> qdd = Vector<kOpen>(random.uniform(q.size(), -0.3, 0.3)).cwiseProduct(arm.limits().acceleration);
  for (;; qd *= 0.3, qdd *= 0.3) {
    try {
      return tracker_from<kLevel>(arm, State<kOpen>{q, qd}, qdd, tick, bounds...);
    } catch (const std::invalid_argument&) {
      if (qd.norm() < 1e-6) throw;
    }
  }
}

struct Run {
  double nearest = 1e9;  ///< Smallest distance beyond the margin [m].
  double joints = 0.0;   ///< Largest relative excess over a joint bound.
  double within = 0.0;   ///< Largest deviation of a posture from a tick of one acceleration [rad] or [m].
  int blocked = 0;
  int ticks = 0;
};

/// A random start posture that keeps the margin to all shapes, among three random obstacles.
struct Scene {
  Clearance<kOpen> clearance;
  Vector<kOpen> q;
};

[[nodiscard]] Scene random_scene(const Chain<>& chain, Random& random, double margin) {
  const auto arm = any_arm(chain);
  Kinematics<Position<3>, kOpen> kinematics;
  for (;;) {
    Vector<kOpen> q(arm.dof());
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      const double low = std::max(arm.limits().lower(i), -2.5);
      const double high = std::min(arm.limits().upper(i), 2.5);
      q(i) = low + random.uniform(0.1, 0.9) * (high - low);
    }
    arm.kinematics(q, kinematics);
    std::vector<Obstacle<>> obstacles;
    for (int k = 0; k < 3; ++k) obstacles.push_back(random_obstacle(random, kinematics.length, k));
    Clearance<kOpen> clearance(chain, sticks(chain, 0.04 * kinematics.length), obstacles, margin);
    if (clearance.nearest_pair(q).second > margin) return {clearance, q};
  }
}

/// Moves an arm for 4 s with jumping references and with references that pass through the shapes.
template <Level kLevel>
void pull(const Chain<>& chain, std::uint32_t seed, double h, Run& run) {
  Random random(seed);
  const auto is_at = [h](int k, double period, double offset) {
    return k % static_cast<int>(std::lround(period / h)) == static_cast<int>(std::lround(offset / h));
  };
  const double margin = seed % 2 == 0 ? 0.01 : 0.0;
  Scene scene = random_scene(chain, random, margin);
  const auto arm = any_arm(chain);
  const Limits<kLevel, kOpen> limits(arm.limits(), h);
  auto tracker = tracker_from<kLevel>(arm, scene.q, seed % 3 != 1, random, h, scene.clearance);
  const auto& bounds = limits.bounds();
  auto target = Reference<Position<3>>::hold(tracker.tip());
  Vector<kOpen> q = scene.q;
  Vector<kOpen> qd = tracker.state().qd;
  Vector<kOpen> last = tracker.acceleration();
  for (int k = 0; k * h < 4.0; ++k) {
    if (is_at(k, 0.5, 0.0)) {
      const Vector<3> displacement = random.uniform(3, -1.0, 1.0);
      target = Reference<Position<3>>::hold(Vector<3>(tracker.tip() + displacement));
      if (is_at(k, 1.5, 1.0)) target = wild_reference<Position<3>>(random, tracker.tip());
    }
    if (is_at(k, 3.0, 2.5)) tracker.stop();
    if (is_at(k, 3.0, 2.7)) tracker.resume();
    const auto tick = tracker.tick(target);
    for (int part = 1; part <= 4; ++part) {
      const double t = part * h / 4.0;
      Vector<kOpen> between = q + (part / 4.0) * (tick.q - q);
      if (kLevel == Level::kAcceleration) between = q + t * qd + t * t / 2.0 * tick.qdd;
      if (part == 4) run.within = std::max(run.within, (between - tick.q).cwiseAbs().maxCoeff());
      run.nearest = std::min(run.nearest, scene.clearance.nearest_pair(between).second - margin);
    }
    ++run.ticks;
    if (tick.status == Status::kBlocked) ++run.blocked;
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      const double range = std::isfinite(bounds.upper(i)) ? bounds.upper(i) - bounds.lower(i) : 1.0;
      run.joints = std::max({run.joints, (tick.q(i) - bounds.upper(i)) / range, (bounds.lower(i) - tick.q(i)) / range,
                             std::abs(tick.qd(i)) / bounds.velocity(i) - 1.0});
      if (std::isfinite(bounds.acceleration(i))) {
        run.joints = std::max(run.joints, std::abs(tick.qdd(i)) / bounds.acceleration(i) - 1.0);
      }
      if (std::isfinite(bounds.jerk(i))) {
        run.joints = std::max(run.joints, std::abs(tick.qdd(i) - last(i)) / (bounds.jerk(i) * h) - 1.0);
      }
    }
    q = tick.q;
    qd = tick.qd;
    last = tick.qdd;
  }
}

[[nodiscard]] Chain<> with_jerk(Chain<> chain, double rate) {
  for (auto& joint : chain.joints) joint.bounds.jerk = rate * joint.bounds.acceleration;
  return chain;
}

template <Level kLevel>
void expect_to_keep_clear(double tick) {
  constexpr auto kSeeds = static_cast<std::uint32_t>(trials(10));
  const std::vector<std::pair<std::string, Chain<>>> chains = {{"panda", presets::panda()},
                                                               {"panda without jerk", panda_without_jerk()},
                                                               {"soft panda", with_jerk(presets::panda(), 20.0)},
                                                               {"fr3", presets::fr3()},
                                                               {"ur5e", presets::ur5e()},
                                                               {"rail", panda_on_rail()},
                                                               {"coupled", coupled_panda()}};
  for (const auto& [name, chain] : chains) {
    Run run;
    for (std::uint32_t seed = 0; seed < kSeeds; ++seed) {
      pull<kLevel>(chain, seed, tick, run);
      ASSERT_GE(run.nearest, -kSlack) << name << ", seed " << seed;
    }
    EXPECT_LE(run.joints, 1e-9) << name;
    EXPECT_LE(run.within, 1e-12) << name;
    if (kSeeds >= 10) {  // With few seeds, an arm may meet no shape.
      EXPECT_GE(run.blocked, run.ticks / 50) << name;
    }
    std::printf("%s: nearest %.1e beyond the margin, joints' bounds %.1e, blocked %d of %d ticks\n", name.c_str(),
                run.nearest, run.joints, run.blocked, run.ticks);
  }
}

TEST(Bounds, no_pair_is_closer_than_its_margin) {
  at_both_levels([](auto level, double tick) { expect_to_keep_clear<level()>(tick); });
}

/// An arm of presets.hpp with its capsules, at rest or in motion in a random posture.
struct PresetArm {
  Chain<> chain;
  std::vector<LinkCapsule<>> capsules;
  std::vector<presets::never_collide::LinkNames> allowed;
  double margin;
  Vector<kOpen> q;
  Vector<3> tip;

  [[nodiscard]] Clearance<kOpen> among(const std::vector<Obstacle<>>& obstacles) const {
    return {chain, capsules, obstacles, margin, allowed};
  }
  /// Offset of the half-space with the normal n that is nearer to the arm than `gap` beyond the margin [m].
  [[nodiscard]] double offset_at(const Vector<3>& n, double gap) const {
    const auto clearance = among({});
    auto placed = clearance.placement();
    clearance.place(q, placed);
    double least = 1e9;
    for (std::size_t i = 0; i < placed.bodies.size(); ++i) {
      if (clearance.bodies()[i].link == 0) continue;
      least = std::min(least, std::min(n.dot(placed.bodies[i].a), n.dot(placed.bodies[i].b)) - placed.bodies[i].radius);
    }
    return least - margin - gap;
  }
};

/// jerk: bounds on jerk divided by the bounds on acceleration [1/s]. clear: distance of all pairs beyond the margin
/// [m].
[[nodiscard]] PresetArm preset_arm(const presets::PresetCapsules& its, double jerk, double margin, double clear,
                                   Random& random) {
  PresetArm result{{}, its.capsules(), its.never_collide(), margin, {}, {}};
  for (const presets::Preset& arm : presets::kAll) {
    if (std::string(arm.name) == its.name) result.chain = with_jerk(arm.chain(), jerk);
  }
  const auto arm = any_arm(result.chain);
  const auto clearance = result.among({});
  Kinematics<Position<3>, kOpen> kinematics;
  result.q.resize(arm.dof());
  do {
    for (Eigen::Index i = 0; i < arm.dof(); ++i) {
      const double low = std::max(arm.limits().lower(i), -2.5);
      result.q(i) = low + random.uniform(0.1, 0.9) * (std::min(arm.limits().upper(i), 2.5) - low);
    }
  } while (!(clearance.nearest_pair(result.q).second > margin + clear));
  arm.kinematics(result.q, kinematics);
  result.tip = kinematics.tip;
  return result;
}

/// Shape whose nearest point to x is about 0.05 m ahead of x along the direction m.
[[nodiscard]] WorldShape<> shape_at(int kind, const Vector<3>& x, const Vector<3>& m) {
  const Vector<3> across = cross(m, Vector<3>(0.3, 0.5, 0.8)).normalized();
  if (kind == 0) return HalfSpace<>{m, m.dot(x) + 0.05};
  if (kind == 1) return Cuboid<>{{x, rotation(Vector<3>(3.0 * m))}, {0.12, 0.12, 0.03}};
  if (kind == 2) return Capsule<>{x - 0.2 * across, x + 0.2 * across, 0.04};
  return Capsule<>{x, x, 0.08};
}

/// Smallest slack of the bounds on static shapes, walls and cones, while a moving obstacle presses the arm against them
/// for 3 s [m].
template <Level kLevel>
[[nodiscard]] double press(const presets::PresetCapsules& its, double jerk, double h, std::uint32_t seed) {
  Random random(seed);
  const double margins[] = {0.01, 0.001, 0.0};
  const PresetArm subject = preset_arm(its, jerk, margins[seed % 3], 0.002, random);
  const auto arm = any_arm(subject.chain);
  const Vector<3> n = seed % 2 == 0 ? random_direction(random) : Vector<3>(Vector<3>::UnitZ());
  const Vector<3> m = seed % 4 < 2 ? Vector<3>(-n) : random_direction(random);
  const Obstacle<> floor("floor", HalfSpace<>{n, subject.offset_at(n, std::pow(10.0, random.uniform(-4.0, -1.3)))});
  const double speed = seed % 5 == 0 ? 0.0 : std::pow(10.0, random.uniform(-2.0, -0.3));
  const double far = subject.offset_at(m, 0.25);
  const auto presser = [&](double displacement) {
    const Vector<3> x = subject.tip + (far - m.dot(subject.tip) + displacement) * m;
    return shape_at(static_cast<int>(seed % 7 % 4), x, m);
  };
  auto fixed = subject.among({floor});
  auto both = subject.among({floor, {"presser", presser(0.0), Vector<3>(speed * m)}});
  PositionBounds<> walls{{Robot<kOpen>::kTip}};
  walls.lower = subject.tip.array() - 0.02;
  walls.upper = subject.tip.array() + 0.03;
  if (seed % 12 < 6) walls.deceleration = 1.0;
  auto placed = both.placement();
  both.place(subject.q, placed);
  const Vector<3> axis = placed.state.R[subject.chain.joints.size()].col(2);
  AxisBounds<> cone{{static_cast<int>(subject.chain.joints.size())}, Vector<3>::UnitZ(), axis};
  cone.upper = 0.05;
  const bool has_walls = seed % 6 < 3;
  const bool has_cone = seed % 6 == 2 || seed % 6 == 4;
  TaskBounds<kOpen> kept(subject.chain);
  if (has_walls) kept.keep(walls);
  if (has_cone) kept.keep(cone);
  auto tracker = tracker_from<kLevel>(arm, subject.q, seed % 8 < 4, random, h, both, kept);
  auto memory = fixed.placement();
  auto target = Reference<Position<3>>::hold(tracker.tip());
  State<kOpen> before = tracker.state();
  const int ticks = static_cast<int>(3.0 / h);
  double nearest = 1e9;
  for (int k = 0; k < ticks; ++k) {
    EXPECT_TRUE(clearance_of(tracker).move(1, presser(k * h * speed), Vector<3>(speed * m)));
    if (seed % 9 < 5 && k % (ticks / 6) == 0) target.x = subject.tip + Vector<3>(random.uniform(3, -0.3, 0.3));
    if (k % (ticks / 3) == ticks / 5) tracker.stop();
    if (k % (ticks / 3) == ticks / 4) tracker.resume();
    const auto tick = tracker.tick(target);
    for (const double part : {0.5, 1.0}) {
      Vector<kOpen> between = before.q + part * (tick.q - before.q);
      if (kLevel == Level::kAcceleration && part < 1.0)
        between = before.q + h / 2.0 * before.qd + h * h / 8.0 * tick.qdd;
      fixed.place(between, memory);
      nearest = std::min(nearest, fixed.nearest_pair(memory).second - subject.margin);
      Kinematics<Position<3>, kOpen> kinematics;
      arm.kinematics(between, kinematics);
      const Vector<3>& p = kinematics.tip;
      const double cosine = axis.dot(memory.state.R[subject.chain.joints.size()].col(2));
      if (has_walls) nearest = std::min({nearest, (p - walls.lower).minCoeff(), (walls.upper - p).minCoeff()});
      if (has_cone) nearest = std::min(nearest, cosine - std::cos(cone.upper));
    }
    before = tracker.state();
  }
  return nearest;
}

/// Calls motion(arm, jerk, seed) for all presets with capsules, without bounds on jerk, and with bounds from which an
/// acceleration needs 3 ms and 50 ms to decrease to zero.
template <typename Motion>
void on_presets(std::uint32_t& seed, int each, const Motion& motion) {
  for (const double jerk : {std::numeric_limits<double>::infinity(), 300.0, 20.0}) {
    for (const auto& arm : presets::kAllCapsules) {
      for (int k = 0; k < each; ++k) motion(arm, jerk, seed++);
    }
  }
}

/// Static shapes, walls and cones hold while an obstacle presses the arm against them, so that the rows conflict and
/// only the proof keeps the margin.
TEST(Bounds, keeps_the_margin_of_an_arm_that_is_pressed) {
  std::uint32_t seed = 0;
  int motions = 0;
  at_both_levels([&](auto level, double tick) {
    double nearest = 1e9;
    on_presets(seed, trials(10, 2), [&](const auto& arm, double jerk, std::uint32_t its_seed) {
      const double slack = press<level()>(arm, jerk, tick, its_seed);
      EXPECT_GE(slack, -kSlack) << arm.name << ", jerk " << jerk << ", seed " << its_seed;
      nearest = std::min(nearest, slack);
      ++motions;
    });
    std::printf("%s, tick %g s: nearest %.1e m beyond the margin\n",
                level() == Level::kVelocity ? "velocity" : "acceleration", tick, nearest);
  });
  std::printf("%d motions\n", motions);
}

/// Smallest distance from an obstacle with a constant velocity beyond the margin, as long as no joint is at a bound and
/// no other pair is at the margin [m].
template <Level kLevel>
[[nodiscard]] double chase(const presets::PresetCapsules& its, double jerk, double h, std::uint32_t seed) {
  Random random(seed);
  const double margins[] = {0.02, 0.001, 0.0};
  const PresetArm subject = preset_arm(its, jerk, margins[seed % 3], 0.004, random);
  const auto arm = any_arm(subject.chain);
  const Vector<3> m = random_direction(random);
  const Vector<3> aside = random.uniform(3, -0.1, 0.1);
  const double speed = std::pow(10.0, random.uniform(-1.5, -0.6));
  const auto shape = [&](double displacement) {
    return shape_at(1 + static_cast<int>(seed % 4 % 3), subject.tip + aside + (displacement - 0.35) * m, m);
  };
  auto clearance = subject.among({{"obstacle", shape(0.0), Vector<3>(speed * m)}});
  auto memory = clearance.placement();
  const auto nearest_of = [&](const Vector<kOpen>& q, bool world) {
    clearance.place(q, memory);
    double nearest = 1e9;
    for (const ShapePair& pair : clearance.pairs()) {
      if (pair.world == world) nearest = std::min(nearest, clearance.nearest_of(memory, pair).distance);
    }
    return nearest - subject.margin;
  };
  if (nearest_of(subject.q, true) < 0.05) return 1e9;
  const Limits<kLevel, kOpen> limits(arm.limits(), h);
  auto tracker = tracker_from<kLevel>(arm, subject.q, true, random, h, clearance);
  const auto target = Reference<Position<3>>::hold(tracker.tip());
  Vector<kOpen> last = 0.0 * subject.q;
  double nearest = 1e9;
  for (int k = 0; k * h * speed < 0.6; ++k) {
    EXPECT_TRUE(clearance_of(tracker).move(0, shape(k * h * speed), Vector<3>(speed * m)));
    const auto tick = tracker.tick(target);
    const auto& most = limits.bounds();
    double used = std::max(tick.qd.cwiseQuotient(most.velocity).cwiseAbs().maxCoeff(),
                           tick.qdd.cwiseQuotient(most.acceleration).cwiseAbs().maxCoeff());
    if (std::isfinite(jerk))
      used = std::max(used, (tick.qdd - last).cwiseQuotient(h * most.jerk).cwiseAbs().maxCoeff());
    if (used > 0.9 || tick.saturated != 0 || nearest_of(tick.q, false) < 0.002) break;
    EXPECT_TRUE(clearance.move(0, shape((k + 1) * h * speed), Vector<3>(speed * m)));
    nearest = std::min(nearest, nearest_of(tick.q, true));
    last = tick.qdd;
  }
  return nearest;
}

/// The arm keeps the margin of an obstacle with a constant velocity as long as no joint is at a bound.
TEST(Bounds, keeps_the_margin_of_a_moving_obstacle) {
  std::uint32_t seed = 0;
  int met = 0;
  int motions = 0;
  at_both_levels([&](auto level, double tick) {
    double nearest = 1e9;
    on_presets(seed, trials(6, 1), [&](const auto& arm, double jerk, std::uint32_t its_seed) {
      const double slack = chase<level()>(arm, jerk, tick, its_seed);
      EXPECT_GE(slack, -kSlack) << arm.name << ", jerk " << jerk << ", seed " << its_seed;
      nearest = std::min(nearest, slack);
      met += slack < 0.005 ? 1 : 0;
      ++motions;
    });
    std::printf("%s, tick %g s: nearest %.1e m beyond the margin\n",
                level() == Level::kVelocity ? "velocity" : "acceleration", tick, nearest);
  });
  std::printf("%d of %d motions near the margin\n", met, motions);
  EXPECT_GE(met, motions / 3);
}

using Panda = AnyArm<Position<3>>;

[[nodiscard]] Vector<kOpen> ready() {
  return (Vector<7>() << 0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785).finished();
}

/// Tracker of positions for a Panda with a hand of 10 cm, at rest in the ready posture.
template <Level kLevel = Level::kAcceleration>
[[nodiscard]] auto panda_tracker(const std::vector<Obstacle<>>& obstacles, double tick = kTick) {
  const Chain<> chain = presets::panda();
  const Panda arm = any_arm(chain);
  const std::vector<LinkCapsule<>> hand = {{7, {Vector<3>::Zero(), chain.tip.p, 0.05}, "hand"}};
  const Clearance<kOpen> clearance(chain, hand, obstacles, 0.01);
  return tracker_from<kLevel>(arm, State<kOpen>{ready(), Vector<7>::Zero()}, Vector<7>::Zero(), tick, clearance);
}

struct Slide {
  double along = 0.0;  ///< Largest error along the wall [m].
  double jerk = 0.0;   ///< Root mean square of the joint jerks [rad/s³].
  double nearest = 1e9;
  int held = 0;
};

/// Moves the target sinusoidally along y at a constant x. Errors and jerk are measured from 2 s on.
template <typename Tracker_>
[[nodiscard]] Slide swing(Tracker_&& tracker, double x, double h) {
  const Vector<3> home = tracker.tip();
  Slide slide;
  Vector<kOpen> last = Vector<7>::Zero();
  double sum = 0.0;
  int count = 0;
  for (int k = 0; k * h < 8.0; ++k) {
    const double s = k * h;
    auto target = Reference<Position<3>>::hold(home);
    const double blend = std::min(s, 1.0);
    const double w = 2.0;
    target.x += Vector<3>(blend * (x - home(0)), 0.25 * std::sin(w * s), 0.0);
    target.xd = {s < 1.0 ? x - home(0) : 0.0, 0.25 * w * std::cos(w * s), 0.0};
    target.xdd(1) = -0.25 * w * w * std::sin(w * s);
    const auto tick = tracker.tick(target);
    auto clearance = clearance_of(tracker);
    slide.nearest = std::min(slide.nearest, clearance.nearest_pair(tick.q).second);
    const Vector<kOpen> jerk = (tick.qdd - last) / h;
    last = tick.qdd;
    if (s < 2.0) continue;
    slide.along = std::max(slide.along, std::hypot(tick.error(1), tick.error(2)));
    sum += jerk.squaredNorm();
    ++count;
    slide.held += tick.scale == 0.0;
  }
  slide.jerk = std::sqrt(sum / count);
  return slide;
}

/// If the target is behind a wall, the tip slides along the wall: the error is normal to the wall. No joint chatters,
/// whether self-motion can reduce the error slightly or not.
template <Level kLevel>
void expect_to_slide(double h) {
  const auto wall_at = [](double x) { return Obstacle<>{"wall", HalfSpace<>{-Vector<3>::UnitX(), -x}}; };
  for (const double x : {0.36, 0.48}) {
    const Slide free = swing(panda_tracker<kLevel>({wall_at(2.0)}, h), x, h);
    for (const double beyond : {0.005, 0.05, 0.1}) {
      const Slide slide = swing(panda_tracker<kLevel>({wall_at(x + 0.06)}, h), x + beyond, h);
      if (kLevel == Level::kAcceleration) {  // At velocity level, the arm may oscillate (docs/clearance.md).
        EXPECT_LE(slide.along, 1e-3) << x << ", " << beyond;
        EXPECT_LE(slide.jerk, 1.2 * free.jerk) << x << ", " << beyond;
      }
      EXPECT_GE(slide.nearest, 0.01 - kSlack);
      EXPECT_EQ(slide.held, 0) << x << ", " << beyond;
      std::printf(
          "tip held at %g m, %g m behind: %.1e m along the wall, jerk %.1f against %.1f rad/s^3, nearest %.1e m\n", x,
          beyond, slide.along, slide.jerk, free.jerk, slide.nearest - 0.01);
    }
  }
}
TEST(Bounds, slides_along_a_wall) {
  at_both_levels([](auto level, double tick) { expect_to_slide<level()>(tick); });
}

/// The hand keeps the margin of a moving post, and the tip returns after the post has passed.
template <Level kLevel>
void expect_to_avoid_a_post(double h) {
  for (const double speed : {0.1, 0.25, 0.5}) {
    const auto post_at = [](double y) { return Capsule<>{{0.35, y, 0.3}, {0.35, y, 1.0}, 0.03}; };
    auto tracker = panda_tracker<kLevel>({{"post", post_at(-0.6)}}, h);
    const auto home = Reference<Position<3>>::hold(tracker.tip());
    auto clearance = clearance_of(tracker);
    double nearest = 1e9;
    double away = 0.0;
    double y = -0.6;
    for (int k = 0; k * h < 16.0; ++k) {
      ASSERT_TRUE(clearance_of(tracker).move(0, post_at(y), Vector<3>(0.0, speed, 0.0)));
      const auto tick = tracker.tick(home);
      y += h * speed;
      ASSERT_TRUE(clearance.move(0, post_at(y), Vector<3>(0.0, speed, 0.0)));  // At the end of the tick.
      nearest = std::min(nearest, clearance.nearest_pair(tick.q).second - clearance.margin());
      away = std::max(away, tick.error.norm());
    }
    EXPECT_GE(nearest, -kSlack) << speed;
    EXPECT_GE(away, 0.02) << speed;
    EXPECT_LE((tracker.tip() - home.x).norm(), 1e-3) << speed;
    std::printf("%g m/s: nearest %.1e m beyond the margin, tip away by %.3f m\n", speed, nearest, away);
  }
}
TEST(Bounds, avoids_a_moving_post) {
  at_both_levels([](auto level, double tick) { expect_to_avoid_a_post<level()>(tick); });
}

/// Posts that cross the workspace anywhere except at the first axis do not touch an arm. The hand has many capsules, so
/// that more rows apply than a tick can use.
template <Level kLevel>
void expect_to_avoid_posts(double h) {
  const Chain<> chain = presets::panda();
  auto capsules = presets::capsules::panda();
  for (const double side : {-1.0, 1.0}) {
    const auto across = [side](double x, double z) { return Vector<3>(side * x, side * x, z); };
    capsules.push_back({7, {across(-0.01, 0.115), across(0.056, 0.124), 0.036}, "hand"});
    capsules.push_back({7, {across(0.0, 0.153), across(0.059, 0.153), 0.026}, "hand"});
    capsules.push_back({7, {across(0.007, 0.213), across(0.013, 0.173), 0.015}, "finger"});
  }
  std::vector<std::pair<std::string, std::string>> allowed = presets::never_collide::panda();
  for (const char* part : {"hand", "finger"}) {
    for (const char* link : {"panda_link4", "panda_link5"}) allowed.emplace_back(part, link);
  }
  const Panda arm = any_arm(chain);
  TrackerOptions<> options{h};
  options.stall_time = std::numeric_limits<double>::infinity();
  const Vector<3> elbow(0.0, 0.0, 0.6);
  Kinematics<Position<3>, kOpen> kinematics;
  arm.kinematics(ready(), kinematics);
  const Vector<3> wrist = kinematics.tip;
  for (std::uint32_t seed = 0; seed < static_cast<std::uint32_t>(trials(h > kTick ? 10 : 4)); ++seed) {
    Random random(seed);
    Vector<3> nearest_to_axis;
    Vector<3> direction;
    do {
      const double angle = random.uniform(-3.14, 3.14);
      direction = {std::cos(angle), std::sin(angle), 0.0};
      nearest_to_axis = elbow + random.uniform(0.4, 1.1) * (wrist - elbow) + random.uniform(3, -0.05, 0.05);
      nearest_to_axis(2) = 0.0;
      nearest_to_axis -= nearest_to_axis.dot(direction) * direction;
    } while (nearest_to_axis.norm() < 0.25);
    for (const double speed : {0.1, 0.25, 0.5}) {
      const auto post_at = [&](int k) {
        const Vector<3> foot = nearest_to_axis + (k * h * speed - 0.95) * direction;
        return Capsule<>{foot, foot + 1.1 * Vector<3>::UnitZ(), 0.04};
      };
      BoundedTracker<kLevel> tracker(arm, Position<3>{}, scheme<kLevel>(), State<kOpen>{ready(), Vector<7>::Zero()},
                                     options, Limits<kLevel, kOpen>(arm.limits(), h), Vector<7>::Zero(),
                                     Bounds(Clearance<kOpen>(chain, capsules, {{"post", post_at(0)}}, 0.02, allowed)));
      const auto home = Reference<Position<3>>::hold(tracker.tip());
      double nearest = 1e9;
      for (int k = 0; k * h * speed < 1.9; ++k) {
        (void)clearance_of(tracker).move(0, post_at(k), Vector<3>(speed * direction));
        const auto tick = tracker.tick(home);
        auto clearance = clearance_of(tracker);
        nearest = std::min(nearest, clearance.nearest_pair(tick.q).second);
      }
      EXPECT_GE(nearest, 0.0) << "seed " << seed << ", " << speed << " m/s";
    }
  }
}
TEST(Bounds, avoids_posts_from_all_sides) {
  at_both_levels([](auto level, double tick) { expect_to_avoid_posts<level()>(tick); });
}

/// An arm that an obstacle displaces from its target stalls at rest. If the obstacle moves on, the arm moves away at
/// low speed. The arm returns only after the obstacle has left.
template <Level kLevel>
void expect_to_return(double h) {
  const auto post_at = [](double y) { return Capsule<>{{0.3, y, 0.3}, {0.3, y, 1.0}, 0.1}; };
  auto tracker = panda_tracker<kLevel>({{"post", post_at(-0.7)}}, h);
  const auto home = Reference<Position<3>>::hold(tracker.tip());
  double y = -0.7;
  for (int k = 0; k * h < 24.0; ++k) {
    const double t = k * h;
    const double speed = t < 3.5 ? 0.2 : t >= 10.0 && t < 11.0 ? 0.1 : t >= 15.0 && t < 19.0 ? -0.2 : 0.0;
    y += h * speed;
    ASSERT_TRUE(clearance_of(tracker).move(0, post_at(y), Vector<3>(0.0, speed, 0.0)));
    const auto tick = tracker.tick(home);
    if (h < 0.02 && ((t >= 9.5 && t < 10.0) || (t >= 14.5 && t < 15.0))) {
      ASSERT_EQ(tick.status, Status::kStalled) << t;
      ASSERT_EQ(tick.qd.norm(), 0.0) << t;
      ASSERT_GE(tick.error.norm(), 0.05) << t;
    }
    if (t >= 10.0 && t < 15.0) {
      auto clearance = clearance_of(tracker);
      ASSERT_GE(clearance.nearest_pair(tick.q).second, 0.005) << t;
      if (h < 0.02) {
        ASSERT_LE(tick.qd.cwiseAbs().maxCoeff(), 0.5) << t;
      }
    }
  }
  EXPECT_LE((tracker.tip() - home.x).norm(), 1e-3);
}
TEST(Bounds, returns_when_a_shape_leaves) {
  at_both_levels([](auto level, double tick) { expect_to_return<level()>(tick); });
}

/// If an obstacle jumps closer than the margin, or into the arm, the arm only moves away from it.
template <Level kLevel>
void expect_to_move_away(double h) {
  for (const double nearer : {1e-6, 1e-3, 8e-3, 0.03}) {
    const auto post_at = [](double y) { return Capsule<>{{0.3, y, 0.3}, {0.3, y, 1.0}, 0.1}; };
    auto tracker = panda_tracker<kLevel>({{"post", post_at(-0.7)}}, h);
    const auto home = Reference<Position<3>>::hold(tracker.tip());
    auto& clearance = clearance_of(tracker);
    const double room = clearance.nearest_pair(tracker.state().q).second - clearance.margin();
    (void)clearance.move(0, post_at(-0.7 + room + nearer), Vector<3>::Zero());
    double before = -1.0;
    for (int k = 0; k * h < 2.0; ++k) {
      const auto tick = tracker.tick(home);
      const double now = clearance.nearest_pair(tick.q).second - clearance.margin();
      if (before < 0.0) {
        ASSERT_GE(now, before - 1e-9) << nearer << " m, tick " << k;
      } else {
        ASSERT_GE(now, -kSlack) << nearer << " m, tick " << k;
      }
      before = now;
    }
    EXPECT_GE(before, -1e-5) << nearer;
    std::printf("%g m nearer than the margin: %.1e m beyond it after 2 s\n", nearer, before);
  }
}
TEST(Bounds, moves_away_from_a_shape_that_jumped) {
  at_both_levels([](auto level, double tick) { expect_to_move_away<level()>(tick); });
}

/// Null-space motion away from shapes does not move the tip.
template <Level kLevel>
void expect_self_motion(double h) {
  const Chain<> chain = presets::panda();
  const std::vector<Obstacle<>> post = {{"post", Capsule<>{{0.2, 0.3, 0.0}, {0.2, 0.3, 1.0}, 0.05}}};
  const std::vector<LinkCapsule<>> elbow = {{3, {{0.0825, 0.0, 0.0}, {0.0825, 0.0, 0.0}, 0.1}, "elbow"}};
  const auto settle = [&](double gain) {
    const Panda arm = any_arm(chain);
    Vector<kOpen> q = ready();
    q(0) = 0.6;
    q(2) = -0.6;
    Clearance<kOpen> apart(chain, elbow, post, 0.0);
    apart.keep_away({gain, 0.6});
    auto tracker = tracker_from<kLevel>(arm, State<kOpen>{q, Vector<7>::Zero()}, Vector<7>::Zero(), h, apart);
    const auto home = Reference<Position<3>>::hold(tracker.tip());
    double error = 0.0;
    for (int k = 0; k * h < 5.0; ++k) error = std::max(error, tracker.tick(home).error.norm());
    auto clearance = clearance_of(tracker);
    return std::pair(clearance.nearest_pair(tracker.state().q).second, error);
  };
  const auto [without, still] = settle(0.0);
  const auto [with, error] = settle(40.0);
  std::printf("elbow %.3f m from the post, %.3f m without\n", with, without);
  EXPECT_GE(with, without + 0.05);
  EXPECT_LE(still, 1e-9);
  EXPECT_LE(error, std::max(1e-4, h * h));  // Second-order error of a tick.
}
TEST(Bounds, self_motion_keeps_away_in_time) {
  at_both_levels([](auto level, double tick) { expect_self_motion<level()>(tick); });
}

/// Position bounds of the tip hold, and do not apply to other parts of the arm.
template <Level kLevel>
void expect_within_box(double h) {
  const Chain<> chain = presets::panda();
  const Panda arm = any_arm(chain);
  TaskBounds<kOpen> box(chain);
  box.keep(PositionBounds<>{{Robot<7>::kTip}, {0.2, -0.2, 0.3}, {0.4, 0.2, 0.7}});
  EXPECT_EQ(box.coordinates().size(), 6U);
  auto tracker = tracker_from<kLevel>(arm, State<kOpen>{ready(), Vector<7>::Zero()}, Vector<7>::Zero(), h, box);
  Random random(1);
  auto target = Reference<Position<3>>::hold(tracker.tip());
  for (int k = 0; k * h < 20.0; ++k) {
    if (k % static_cast<int>(std::lround(0.5 / h)) == 0)
      target = Reference<Position<3>>::hold(random.uniform(3, -0.5, 1.0));
    (void)tracker.tick(target);
    const Vector<3> tip = tracker.tip();
    ASSERT_TRUE((tip.array() >= Eigen::Array3d(0.2, -0.2, 0.3) - kSlack).all() &&
                (tip.array() <= Eigen::Array3d(0.4, 0.2, 0.7) + kSlack).all())
        << "tick " << k;
  }
}
TEST(Bounds, keeps_the_tip_within_its_box) {
  at_both_levels([](auto level, double tick) { expect_within_box<level()>(tick); });
}

/// If only joint limits restrict the motion, the tip moves at its speed bound and not faster.
template <Level kLevel>
void expect_slow_tip() {
  for (const auto& chain :
       {presets::panda(), panda_without_jerk(), presets::ur5e(), panda_on_rail(), coupled_panda()}) {
    SpeedBounds<kOpen> speeds(chain);
    constexpr double kSpeed = 0.25;
    speeds.keep({{Robot<7>::kTip}, kSpeed});
    const auto arm = any_arm(chain);
    Random random(3);
    const Vector<kOpen> q = spread_posture(arm.limits(), 3);
    auto tracker = tracker_from<kLevel>(arm, State<kOpen>{q, 0.0 * q}, 0.0 * q, kTick, speeds);
    Vector<3> tip = tracker.tip();
    auto target = Reference<Position<3>>::hold(tip);
    double fastest = 0.0;
    double hindered = 0.0;
    for (int k = 0; k < trials(20000); ++k) {
      if (k % 500 == 0) target = Reference<Position<3>>::hold(Vector<3>(tip + random.uniform(3, -0.5, 0.5)));
      const bool free = tracker.tick(target).saturated == 0;
      double& most = free ? fastest : hindered;
      most = std::max(most, (tracker.tip() - tip).norm() / kTick);
      tip = tracker.tip();
    }
    std::printf("tip at %.4f of %.2f m/s, %.4f where joints are at their bounds\n", fastest, kSpeed, hindered);
    EXPECT_LE(fastest, 1.05 * kSpeed);  // The direction changes in a tick.
    EXPECT_GE(fastest, 0.99 * kSpeed);
  }
}
TEST(Bounds, keeps_the_tip_s_speed) {
  expect_slow_tip<Level::kAcceleration>();
  expect_slow_tip<Level::kVelocity>();
}

/// Both hands of two Pandas jump between targets 0.2 m apart, across each other, with and without a torso.
template <int N, Level kLevel>
void expect_arms_apart(bool with_torso) {
  const Tree<> tree = two_pandas(with_torso);
  const Robot<N> robot(tree);
  constexpr double kMargin = 0.01;
  const Limits<kLevel, N> limits(robot.limits(), kTick);
  const auto scheme = least_norm_scheme<kLevel, N>();
  const TaskGains<> gains = kLevel == Level::kVelocity ? TaskGains<>(5.0) : TaskGains<>(10.0, 25.0);
  const Stack stack(
      TaskLevel(PositionTask<>{frame_of(tree, "right_tip"), gains}, PositionTask<>{frame_of(tree, "left_tip"), gains}),
      PostureTask<N>{gains});
  double nearest = 1e9;
  double joints = 0.0;
  int blocked = 0;
  for (int seed = 0; seed < trials(4); ++seed) {
    Random random(static_cast<std::uint32_t>(seed));
    Vector<N> q = Vector<N>::Zero();
    for (int i = 0; i < 14; ++i) q(N - 14 + i) = ready()(i % 7) + random.uniform(-0.3, 0.3);
    Clearance<N> clearance(tree, sticks(tree, 0.05), {}, kMargin);
    auto tracker = stack_tracker(robot, stack, scheme, State<N>{q, 0.0 * q}, TrackerOptions<>{kTick}, limits,
                                 Vector<N>(0.0 * q), Bounds(clearance));
    auto target = decltype(tracker)::Target::hold(tracker.tip());
    Vector<N> before = q;
    for (int k = 0; k < 3000; ++k) {
      if (k % 600 == 0) {
        const Vector<3> middle = random.uniform(3, -0.3, 0.3);
        const Vector<3> center = middle + Vector<3>(0.5, 0.0, with_torso ? 0.8 : 0.4);
        std::get<0>(target.x) = center + Vector<3>(0.0, 0.1, 0.0);
        std::get<1>(target.x) = center - Vector<3>(0.0, 0.1, 0.0);
      }
      const auto tick = tracker.tick(target);
      blocked += tick.status == Status::kBlocked ? 1 : 0;
      for (int part = 1; part <= 2; ++part) {
        nearest = std::min(nearest, clearance.nearest_pair(q + (part / 2.0) * (tick.q - q)).second - kMargin);
      }
      for (int i = 0; i < N; ++i) {
        const double change = (tick.q(i) - 2.0 * q(i) + before(i)) / (kTick * kTick);
        joints = std::max({joints, tick.q(i) - robot.limits().upper(i), robot.limits().lower(i) - tick.q(i),
                           std::abs(tick.q(i) - q(i)) / (kTick * robot.limits().velocity(i)) - 1.0,
                           std::abs(change) / robot.limits().acceleration(i) - 1.0});
      }
      before = q;
      q = tick.q;
    }
  }
  std::printf("two arms of %d joints: nearest %.1e beyond the margin, joints' bounds %.1e, blocked %d\n", N, nearest,
              joints, blocked);
  EXPECT_GE(nearest, -kSlack);
  EXPECT_LE(joints, 1e-9);
  EXPECT_GT(blocked, 0);
}
TEST(Bounds, keeps_two_arms_apart) {
  expect_arms_apart<14, Level::kVelocity>(false);
  expect_arms_apart<16, Level::kAcceleration>(true);
}

/// Postures of a motion. A wall and the arm's own shapes block this motion. The number of joints is known at compile
/// time or at run time.
template <int N, int Joints, Level kLevel>
[[nodiscard]] std::vector<Vector<N>> blocked_motion(const Tree<>& tree, const Vector<N>& q, double y_most, double jerk,
                                                    int& pressed) {
  const Robot<N, double, Joints> robot(tree);
  auto bounds = robot.limits();
  bounds.jerk = jerk * bounds.acceleration;
  const Limits<kLevel, N> limits(bounds, kTick);
  const auto scheme = least_norm_scheme<kLevel, N>();
  const TaskGains<> gains = kLevel == Level::kVelocity ? TaskGains<>(5.0) : TaskGains<>(10.0, 25.0);
  const Stack stack(PositionTask<>{frame_of(tree, "tip"), gains}, PostureTask<N>{gains});
  const Obstacle<> post("post", Capsule<>{{0.4, -0.45, 0.0}, {0.4, -0.45, 1.0}, 0.05});
  using Kept = Clearance<N, double, Joints>;
  const Kept clearance(tree, sticks(tree, 0.04), {post}, 0.01);
  PositionBounds<> wall{{tree.frames.front().link}};
  wall.upper(1) = y_most;
  wall.deceleration = 1.0;
  TaskBounds<N, double, Joints> walls(tree);
  walls.keep(wall);
  auto tracker = stack_tracker(robot, stack, scheme, State<N>{q, 0.0 * q}, TrackerOptions<>{kTick}, limits,
                               Vector<N>(0.0 * q), Bounds(clearance, walls));
  auto target = decltype(tracker)::Target::hold(tracker.tip());
  const Vector<3> home = std::get<0>(target.x);
  Random random(11);
  std::vector<Vector<N>> motion;
  for (int k = 0; k < 2000; ++k) {
    if (k % 250 == 0) std::get<0>(target.x) = home + Vector<3>(random.uniform(3, -0.4, 0.4));
    const double y = -0.45 + 0.1 * std::sin(2e-3 * k);
    if (k % 7 == 0) {
      const Capsule<> moved{{0.4, y, 0.0}, {0.4, y, 1.0}, 0.05};
      EXPECT_TRUE(tracker.bounds().template get<Kept>().move(0, moved, Vector<3>(0.0, 0.2 * std::cos(2e-3 * k), 0.0)));
    }
    const auto tick = tracker.tick(target);
    pressed += tick.status == Status::kBlocked || std::get<0>(tracker.tip())(1) > y_most - 2e-3 ? 1 : 0;
    motion.push_back(tick.q);
  }
  return motion;
}

template <int N, int Joints, Level kLevel>
void expect_same_for_both_sizes(const Chain<>& chain, const Vector<N>& q, double y_most) {
  const Tree<> tree = tree_of(chain);
  for (const double jerk : {std::numeric_limits<double>::infinity(), 100.0}) {
    if (kLevel == Level::kVelocity && std::isfinite(jerk)) continue;
    int pressed = 0;
    const auto fixed = blocked_motion<N, Joints, kLevel>(tree, q, y_most, jerk, pressed);
    const auto open = blocked_motion<N, kOpen, kLevel>(tree, q, y_most, jerk, pressed);
    double apart = 0.0;
    for (std::size_t k = 0; k < fixed.size(); ++k) {
      apart = std::max(apart, (fixed[k] - open[k]).cwiseAbs().maxCoeff());
    }
    EXPECT_LE(apart, 1e-9) << "jerk " << jerk;
    EXPECT_GT(pressed, 200);
    std::printf("%d drives, %d joints: apart by %.1e, %d ticks blocked\n", N, Joints, apart, pressed);
  }
}
TEST(Bounds, is_the_same_for_joints_counted_at_run_time) {
  const Vector<7> coupled{0.1, 0.2, -0.3, 0.1, -2.0, 0.1, 1.9};
  expect_same_for_both_sizes<7, 7, Level::kAcceleration>(presets::panda(), ready(), 0.1);
  expect_same_for_both_sizes<7, 7, Level::kVelocity>(presets::panda(), ready(), 0.1);
  expect_same_for_both_sizes<7, 8, Level::kAcceleration>(coupled_panda(), coupled, 0.3);
}

/// A joint that follows with a negative ratio approaches a wall as its leader moves away: the pair needs a row.
TEST(Bounds, has_a_row_for_a_joint_that_follows_with_a_negative_ratio) {
  Chain<> chain;
  chain.joints.resize(2);
  chain.joints[0].bounds = {-1.0, 1.0, 1.0, 5.0};
  chain.joints[1].type = JointType::kPrismatic;
  chain.joints[1].axis = Vector<3>::UnitX();
  chain.joints[1].bounds = {-0.5, 0.5};
  chain.joints[1].mimic = {0, -2.0, 0.0};
  const std::vector<LinkCapsule<>> ball = {{2, {Vector<3>::Zero(), Vector<3>::Zero(), 0.05}, "ball"}};
  constexpr double kMargin = 0.01;
  const Vector<1> q(-0.2);  // The ball is at x = 0.4 cos 0.2.
  const double wall = 0.4 * std::cos(0.2) + 0.05 + kMargin + 1e-4;
  Clearance<1, double, kOpen> clearance(chain, ball, {{"wall", HalfSpace<>{Vector<3>(-Vector<3>::UnitX()), -wall}}},
                                        kMargin);
  const Limits<Level::kAcceleration, 1> limits(clearance.robot().limits(), kTick);
  const State<1> state{q, Vector<1>::Zero()};
  clearance.require(q);
  const auto stop = Stop<Level::kAcceleration, 1>::at_rest(1);
  Rows<1, Clearance<1>::kRows> rows;
  clearance.rows(NextMotion<Level::kAcceleration, 1>{limits, state, state.qd, stop, 1.0}, rows);
  ASSERT_GE(rows.count, 1);
  EXPECT_LT(rows.g(0, 0), 0.0);  // The row limits the decrease of the leader.
}

TEST(Bounds, names_the_invalid_argument) {
  const Chain<> chain = presets::panda();
  const auto bounded = [&](int link, double lower) {
    const PositionBounds<> bounds{{link}, Vector<3>::Constant(lower), Vector<3>::Constant(2.0)};
    return complaint([&] { TaskBounds<7>(chain).keep(bounds); });
  };
  EXPECT_EQ(bounded(8, 1.0), "frame = 8: must be the number of a link, at most 7, or Robot::kTip");
  EXPECT_EQ(bounded(7, 2.0), "lower[0] = 2: must be below upper");
  EXPECT_EQ(complaint([&] { SpeedBounds<7>(chain).keep({{7}, 0.0}); }), "velocity = 0: must be positive, or infinite");
  const std::vector<LinkCapsule<>> hand = {{7, {Vector<3>::Zero(), chain.tip.p, 0.05}, "hand"}};
  const auto with = [&](const Obstacle<>& obstacle) {
    return [=] { (void)Clearance<7>(chain, hand, {obstacle}, 0.0); };
  };
  const Vector<3> zero = Vector<3>::Zero();
  EXPECT_EQ(complaint(with({"wall", HalfSpace<>{Vector<3>(0.0, 0.0, 2.0), 0.0}})),
            "obstacles[0].normal's length = 2: must be 1");
  EXPECT_EQ(complaint(with({"post", Capsule<>{zero, zero, -1.0}})),
            "obstacles[0].radius = -1: must be finite and not negative");
  EXPECT_EQ(complaint([&] {
              (void)Clearance<7>(chain, {{8, {zero, zero, 0.1}, "no link"}}, {}, 0.0);
            }),
            "capsules[0].link = 8: must be a link of the arm, from 0 to 7");
  const std::string close = complaint([&] { (void)panda_tracker({{"floor", HalfSpace<>{Vector<3>::UnitZ(), 0.6}}}); });
  EXPECT_EQ(close.substr(0, 31), "q0: hand and floor overlap by 0");
  EXPECT_NE(close.find(R"( m, with margin=0.01; give allowed={{"hand", "floor"}})"), std::string::npos) << close;
  TaskBounds<7> box(chain);
  box.keep(PositionBounds<>{{Robot<7>::kTip}, Vector<3>::Constant(5.0), Vector<3>::Constant(6.0)});
  EXPECT_EQ(complaint([&] { box.require(ready()); }),
            "q0: is beyond the bound 'lower y of tip': must be within the task bounds");
  auto tracker = panda_tracker({{"floor", HalfSpace<>{Vector<3>::UnitZ(), 0.0}}});
  EXPECT_FALSE(clearance_of(tracker).move(0, Capsule<>{zero, zero, 0.1}, zero));
  EXPECT_FALSE(clearance_of(tracker).move(1, HalfSpace<>{Vector<3>::UnitZ(), 0.0}, zero));
}

}  // namespace
}  // namespace fpbm::test::bounds_laws
