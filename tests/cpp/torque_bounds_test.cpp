#include "fpbm/bound/torque_bounds.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "fpbm/model/presets.hpp"
#include "fpbm/realtime/stack_tracker.hpp"
#include "fpbm/scheme/schemes.hpp"
#include "fpbm/task/posture_task.hpp"
#include "support/expect_refused.hpp"
#include "support/random.hpp"

/// Torques within bounds: each step of the certificate, and whole motions.
namespace fpbm::test::torque_bounds_laws {
namespace {

constexpr int kN = 7;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
using Joints = Vector<kN>;
using MotionLimits = Limits<Level::kAcceleration, kN>;
using Plan = StopPlan<Level::kAcceleration, kN>;

/// The Panda with a payload at its flange [kg].
[[nodiscard]] Chain<> panda_with(double payload) {
  Chain<> chain = presets::panda();
  auto& last = chain.joints.back().moved;
  last = joined(last, {payload, chain.tip.p + chain.tip.R * Vector<3>(0.02, 0.0, 0.15)});
  return chain;
}

[[nodiscard]] JointLimits<kN> limits_of(const Chain<>& chain, bool with_jerk) {
  JointLimits<kN> limits = Robot<kN>(chain).limits();
  if (!with_jerk) limits.jerk.setConstant(kInfinity);
  return limits;
}

/// A viable state with the acceleration of the tick that leads to the state.
struct Start {
  State<kN> state;
  Joints last;
};

/// A state after random motions from rest within limits.
[[nodiscard]] Start random_start(Random& random, const MotionLimits& limits) {
  const auto& bounds = limits.bounds();
  Start at{{Joints::Zero(), Joints::Zero()}, Joints::Zero()};
  for (int i = 0; i < kN; ++i) {
    const double margin = random.uniform(0.0, 1.0) < 0.3 ? 0.02 : 0.3;
    at.state.q(i) = random.uniform(bounds.lower(i) + margin, bounds.upper(i) - margin);
  }
  const Joints toward = random.uniform(kN, -1.0, 1.0).cwiseProduct(bounds.acceleration);
  const int ticks = static_cast<int>(random.uniform(1.0, 200.0));
  const TickMotion<Level::kAcceleration, kN> motion{limits.tick()};
  for (int k = 0; k < ticks; ++k) {
    const Joints u = limits.box(at.state, at.last).nearest(toward);
    at = {motion.after(at.state, u), u};
  }
  return at;
}

/// The largest g · u of the accelerations u of a part, according to its corners.
[[nodiscard]] double largest(const StopPart<kN>& part, const Joints& g) {
  double most = part.pauses ? 0.0 : -kInfinity;
  for (std::size_t k = 0; k < part.corner_count; ++k) most = std::max(most, g.dot(part.corners[k]));
  for (int i = 0; i < kN; ++i) {
    if ((part.alone & joint_bit(i)) != 0) most += std::abs(g(i)) * (part.high(i) - part.low(i)) / 2.0;
  }
  return most;
}

/// advance() is equal to as many calls of next(), and the ranges and corners contain every acceleration and speed.
TEST(StopAdvance, repeats_next) {
  Random random(1);
  for (int trial = 0; trial < trials(2000); ++trial) {
    const double tick = trial % 3 == 0 ? 4e-3 : 1e-3;
    auto bounds = limits_of(presets::panda(), trial % 2 == 0);
    if (trial % 4 == 0) bounds.jerk /= 20.0;  // Long ramps.
    const MotionLimits limits(bounds, tick);
    const auto [start, last] = random_start(random, limits);
    Plan one(limits, start, last, random.uniform(0.1, 1.0));
    Plan other = one;
    StopPart<kN> part(start, last);
    State<kN> state = start;
    Joints before = last;
    const TickMotion<Level::kAcceleration, kN> motion{tick};
    while (one.ticks_left() > 0.0) {
      const double ticks = std::min(std::ceil(random.uniform(0.0, 30.0)), one.ticks_left());
      const Joints at_start = state.qd;
      Joints speed = at_start.cwiseAbs();
      advance(one, limits, ticks, part);
      const Joints g[] = {random.uniform(kN, -1.0, 1.0), random.uniform(kN, 0.0, 1.0), random.uniform(kN, -1.0, 0.0),
                          Joints::Unit(trial % kN), -Joints::Unit(trial % kN)};
      for (double k = 0.0; k < ticks; k += 1.0) {
        before = other.next(limits, state, before);
        state = motion.after(state, before);
        speed = speed.cwiseMax(state.qd.cwiseAbs());
        ASSERT_GE((before - part.low).minCoeff(), -1e-9);
        ASSERT_GE((part.high - before).minCoeff(), -1e-9);
        for (const Joints& each : g) ASSERT_LE(each.dot(before), largest(part, each) + 1e-8);
      }
      ASSERT_GE((part.speed - speed).minCoeff(), -1e-11);
      ASSERT_LE((part.state.q - state.q).cwiseAbs().maxCoeff(), 1e-12) << trial;
      ASSERT_LE((part.state.qd - state.qd).cwiseAbs().maxCoeff(), 1e-11) << trial;
      ASSERT_LE((part.last - before).cwiseAbs().maxCoeff(), 1e-8) << trial;
      ASSERT_EQ(one.ticks_left(), other.ticks_left());
    }
    EXPECT_LE(part.state.qd.cwiseAbs().maxCoeff(), 1e-11);
  }
}

/// Torques of a model.
[[nodiscard]] Joints torque(const Dynamics<kN>& model, const State<kN>& state, const Joints& u) {
  Dynamics<kN>::State at;
  model.robot().update(state.q, state.qd, at);
  return model.inverse_dynamics(at, u);
}

struct Motion {
  double payload = 0.0;   ///< [kg]
  double fraction = 1.0;  ///< Fraction of the efforts that the torques use.
  bool with_jerk = false;
  double tick = 1e-3;
  double lighter = 1.0;  ///< Ratio of the smaller payload to the larger payload.
};

[[nodiscard]] Joints efforts(double fraction) {
  Joints effort = Joints::Constant(87.0);
  effort.tail<3>().setConstant(12.0);
  return fraction * effort;
}

[[nodiscard]] auto bounds_of(const Motion& motion) {
  const Chain<> chain = panda_with(motion.payload);
  const Dynamics<kN> model(chain);
  if (motion.lighter == 1.0) return Bounds(TorqueBounds<kN>(chain, model, efforts(motion.fraction)));
  const Dynamics<kN> light(panda_with(motion.lighter * motion.payload));
  return Bounds(TorqueBounds<kN>(chain, model, efforts(motion.fraction), light));
}

/// A tracker whose task is the posture.
[[nodiscard]] auto tracker_of(const Motion& motion, const State<kN>& start, double modelled = 1.0) {
  const Chain<> chain = panda_with(motion.payload);
  TrackerOptions<> options;
  options.dt = motion.tick;
  const auto scheme = Balanced<kN>(0.0, UnitWeights{}, NullSpace<kN>().with_damping(2.0));
  Motion known = motion;
  known.payload *= modelled;
  return stack_tracker(Robot<kN>(chain), Stack(PostureTask<kN>{TaskGains<>(12.0, 36.0)}), scheme, start, options,
                       MotionLimits(limits_of(chain, motion.with_jerk), motion.tick), Joints(Joints::Zero()),
                       bounds_of(known));
}

[[nodiscard]] State<kN> ready() {
  Joints q;
  q << 0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785;
  return {q, Joints::Zero()};
}

/// Largest torques of a motion, as excesses over the efforts [Nm].
struct Excess {
  double ends = -kInfinity;    ///< At the start or at the end of a tick.
  double middle = -kInfinity;  ///< In the middle of a tick.

  /// Adds the tick from a state with the accelerations u.
  void add(const Motion& motion, const Dynamics<kN>& model, const State<kN>& from, const Joints& u) {
    for (int part = 0; part < 3; ++part) {
      const double t = part * motion.tick / 2.0;
      const State<kN> at{from.q + t * from.qd + t * t / 2.0 * u, from.qd + t * u};
      double& worst = part == 1 ? middle : ends;
      worst = std::max(worst, (torque(model, at, u).cwiseAbs() - efforts(motion.fraction)).maxCoeff());
    }
  }
};

struct Result {
  Excess excess;
  Excess stops;  ///< While the arm stops.
  int reached = 0;
  int slowed = 0;  ///< Ticks that the bound slows down.
};

/// Postures that the arm can hold, one after the other. The arm stops before each of the later postures.
[[nodiscard]] Result move(const Motion& motion, std::uint32_t seed, double modelled = 1.0) {
  Random random(seed);
  const Chain<> chain = panda_with(motion.payload);
  const Dynamics<kN> model(chain);
  const auto bounds = Robot<kN>(chain).limits();
  auto tracker = tracker_of(motion, ready(), modelled);
  Result result;
  const auto tick = [&](const Reference<JointSpace<kN>>& goal, Excess& excess) {
    const State<kN> from = tracker.state();
    const auto done = tracker.tick(goal);
    EXPECT_FALSE(failed(done.status)) << message(done.status);
    excess.add(motion, model, from, tracker.acceleration());
    result.slowed += done.status == Status::kSlowed || done.status == Status::kBlocked ? 1 : 0;
  };
  for (int goal = 0; goal < 4; ++goal) {
    Joints q;
    do {
      for (int i = 0; i < kN; ++i) q(i) = random.uniform(bounds.lower(i) + 0.15, bounds.upper(i) - 0.15);
    } while (
        ((torque(model, {q, Joints::Zero()}, Joints::Zero()).cwiseAbs() - efforts(0.9 * motion.fraction)).array() > 0.0)
            .any());
    const auto reference = Reference<JointSpace<kN>>::hold(q);
    const int until =
        goal % 2 == 0 ? static_cast<int>(random.uniform(0.2, 1.0) / motion.tick) : static_cast<int>(2.5 / motion.tick);
    for (int k = 0; k < until; ++k) tick(reference, result.excess);
    result.reached += (tracker.state().q - q).norm() < 0.1 ? 1 : 0;
    if (goal % 2 != 0) continue;
    tracker.stop();
    for (int k = 0; k < 20000 && !tracker.state().qd.isZero(0.0); ++k) tick(reference, result.stops);
    EXPECT_TRUE(tracker.state().qd.isZero(0.0)) << "the arm does not come to rest";
    result.stops.add(motion, model, tracker.state(), Joints::Zero());
    tracker.resume();
  }
  return result;
}

constexpr Motion kMotions[] = {{0.0, 0.6, false}, {3.0, 0.8, false},       {3.0, 1.0, true},
                               {0.0, 0.4, true},  {1.5, 0.6, false, 4e-3}, {3.0, 1.0, false, 1e-3, 0.5}};

/// At the start and at the end of each tick, no torque exceeds its effort, also while the arm stops. In between, the
/// torque of a tick changes by less than 0.02 Nm more.
TEST(TorqueBounds, hold_at_every_tick) {
  int reached = 0;
  int slowed = 0;
  for (const Motion& motion : kMotions) {
    for (std::uint32_t seed = 1; seed <= static_cast<std::uint32_t>(trials(20, 4)); ++seed) {
      const Result result = move(motion, seed);
      EXPECT_LE(result.excess.ends, 1e-9) << motion.payload << ' ' << motion.fraction << ' ' << seed;
      EXPECT_LE(result.stops.ends, 1e-9) << motion.payload << ' ' << motion.fraction << ' ' << seed;
      EXPECT_LE(std::max(result.excess.middle, result.stops.middle), 0.02) << seed;
      reached += result.reached;
      slowed += result.slowed;
    }
  }
  EXPECT_GT(reached, 0);
  EXPECT_GT(slowed, 100);
}

/// A payload that is 10 % heavier than the model exceeds the bounds.
TEST(TorqueBounds, depend_on_the_payload) {
  double worst = -kInfinity;
  for (std::uint32_t seed = 1; seed <= 4; ++seed) worst = std::max(worst, move({3.0, 0.8}, seed, 0.9).excess.ends);
  EXPECT_GT(worst, 0.1);
}

/// A payload between two masses keeps the bounds: the torques are linear in the mass.
TEST(TorqueBounds, hold_for_every_mass_between_two) {
  const Motion motion{3.0, 1.0, false, 1e-3, 0.5};
  auto tracker = tracker_of(motion, ready());
  Excess excess[3];
  for (int k = 0; k < 6000; ++k) {
    const State<kN> from = tracker.state();
    const auto goal =
        Reference<JointSpace<kN>>::hold(ready().q + std::sin(k / 700.0) * Joints(Joints::LinSpaced(0.8, -0.8)));
    (void)tracker.tick(goal);
    for (int m = 0; m < 3; ++m) {
      excess[m].add(motion, Dynamics<kN>(panda_with(1.5 + 0.75 * m)), from, tracker.acceleration());
    }
  }
  for (const Excess& each : excess) EXPECT_LE(each.ends, 1e-9);
}

/// A long name is cut to at most 31 bytes, between two characters.
TEST(DriveNames, are_cut_between_characters) {
  Chain<> chain = presets::panda();
  chain.joints[0].name = std::string(30, 'a') + "\xC3\xA9";
  chain.joints[1].name = "";
  const DriveNames<kN> names(chain);
  EXPECT_EQ(names[0].text(), "joint '" + std::string(30, 'a') + "'");
  EXPECT_EQ(names[1].text(), "joints[1]");
}

/// The derivative of the torques at rest is the gradient, for chains with any gravity.
TEST(TorqueBounds, gaps_have_gradients) {
  Random random(3);
  const Chain<> chain = panda_with(2.0);
  const Dynamics<kN> model(chain, {2.0, -3.0, -8.0});
  Dynamics<kN>::State state;
  for (int trial = 0; trial < 20; ++trial) {
    const Joints q = random.uniform(kN, -2.0, 2.0);
    model.robot().update(q, state);
    const auto gradient = gravity_gradient(model, state);
    for (int k = 0; k < kN; ++k) {
      const Joints step = 1e-5 * Joints::Unit(k);
      const Joints change = torque(model, {q + step, Joints::Zero()}, Joints::Zero()) -
                            torque(model, {q - step, Joints::Zero()}, Joints::Zero());
      EXPECT_LE((gradient.col(k) - change / 2e-5).cwiseAbs().maxCoeff(), 1e-6);
    }
  }
}

TEST(TorqueBounds, refuse_bad_input) {
  const Chain<> chain = panda_with(3.0);
  const Dynamics<kN> model(chain);
  Joints weak = efforts(1.0);
  weak(1) = 10.0;
  expect_refused([&] { (void)tracker_of({3.0, 0.1}, ready()); }, "joint 'panda_joint2': torque at rest");
  Chain<> rough = chain;
  rough.joints[1].drive.dry = 10.0;
  expect_refused([&] { TorqueBounds<kN>(rough, model, weak); },
                 "effort[1] = 10: must be greater than the dry friction");
  Chain<> light = chain;
  for (auto& joint : light.joints) joint.moved = {};
  expect_refused([&] { TorqueBounds<kN>(light, Dynamics<kN>(light), weak); }, "moves no mass");
  const TorqueBounds<kN> bounds(chain, model, weak);
  const Limits<Level::kVelocity, kN> of_velocity(limits_of(chain, false), 1e-3);
  expect_refused([&] { bounds.require_limits(of_velocity); },
                 "torque bounds: must be given with a scheme at acceleration level");
  const MotionLimits none(JointLimits<kN>::none(kN), 1e-3);
  expect_refused([&] { bounds.require_limits(none); }, "limits.acceleration[0]");
}

}  // namespace
}  // namespace fpbm::test::torque_bounds_laws
