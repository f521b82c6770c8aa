#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <deque>
#include <limits>

#include "support/arms.hpp"
#include "support/compiled_tracker.hpp"

/// Bounds on position, velocity, acceleration and jerk hold together, at every tick and between ticks.
#include "support/wild_reference.hpp"

namespace fpbm::test::jerk_laws {
namespace {

constexpr int kOpen = Eigen::Dynamic;
constexpr double kTick = 1e-3;
constexpr double kSlack = 1e-9;

/// One joint with random bounds. The acceleration needs 2 ms to 0.3 s from zero to its bound.
template <typename Scalar>
[[nodiscard]] JointLimits<1, Scalar> random_bounds(Random& random) {
  auto bounds = JointLimits<1, Scalar>::none(1);
  const auto acceleration = static_cast<Scalar>(random.uniform(1.0, 30.0));
  bounds.set(0, {static_cast<Scalar>(-random.uniform(0.05, 3.0)), static_cast<Scalar>(random.uniform(0.05, 3.0)),
                 static_cast<Scalar>(random.uniform(0.1, 3.0)), acceleration,
                 acceleration * static_cast<Scalar>(std::pow(10.0, random.uniform(0.5, 2.7)))});
  return bounds;
}

/// Desired acceleration of a joint: constant, jumping, against the bounds, or a stiff spring between them.
[[nodiscard]] double asked(int trial, int tick, const JointLimits<1>& bounds, const State<1>& state, Random& random) {
  const double most = bounds.acceleration(0);
  switch (trial % 4) {
    case 0: return tick / 300 % 2 == 0 ? 3.0 * most : -2.0 * most;
    case 1: return tick / 4000 % 2 == 0 ? 1e9 : -1e9;
    case 2: return random.uniform(-1e9, 1e9);
    default:
      return 400.0 * (0.99 * (tick / 2500 % 2 == 0 ? bounds.upper(0) : bounds.lower(0)) - state.q(0)) -
             40.0 * state.qd(0);
  }
}

struct Worst {
  double position = 0.0;
  double velocity = 0.0;
  double acceleration = 0.0;
  double jerk = 0.0;
};

/// Drives one joint; every third trial starts at rest on a bound. The excess is relative to the bound, for a position
/// relative to the range.
template <Level kLevel>
[[nodiscard]] Worst drive_one_joint(int trials) {
  Worst worst;
  for (int trial = 0; trial < trials; ++trial) {
    Random random(static_cast<std::uint32_t>(trial));
    const JointLimits<1> given = random_bounds<double>(random);
    const Limits<kLevel, 1> limits(given, kTick);
    const JointLimits<1>& bounds = limits.bounds();
    State<1> state{trial % 3 == 0 ? bounds.upper : Vector<1>(0.0), Vector<1>(0.0)};
    Vector<1> last(0.0);
    for (int tick = 0; tick < 8000; ++tick) {
      const auto box = limits.box(state, last);
      Vector<1> desired(asked(trial, tick, bounds, state, random));
      if (kLevel == Level::kVelocity) desired = state.qd + kTick * desired;
      const Vector<1> u = box.nearest(desired);
      const double from = state.q(0);
      const double speed = state.qd(0);
      Vector<1> qdd = u;
      if (kLevel == Level::kVelocity) qdd = (u - state.qd) / kTick;
      state.qd += kTick * qdd;
      state.q += kTick * (kLevel == Level::kVelocity ? state.qd : Vector<1>(state.qd - kTick / 2.0 * qdd));
      double most = std::max(state.q(0) - bounds.upper(0), bounds.lower(0) - state.q(0));
      if (kLevel == Level::kAcceleration && speed * state.qd(0) < 0.0) {
        const double turn = from - speed * speed / (2.0 * qdd(0));
        most = std::max({most, turn - bounds.upper(0), bounds.lower(0) - turn});
      }
      const double range = bounds.upper(0) - bounds.lower(0);
      worst.position = std::max(worst.position, most / range);
      worst.velocity = std::max(worst.velocity, std::abs(state.qd(0)) / bounds.velocity(0) - 1.0);
      worst.acceleration = std::max(worst.acceleration, std::abs(qdd(0)) / bounds.acceleration(0) - 1.0);
      if (std::isfinite(bounds.jerk(0))) {
        worst.jerk = std::max(worst.jerk, std::abs(qdd(0) - last(0)) / (bounds.jerk(0) * kTick) - 1.0);
      }
      last = qdd;
    }
  }
  return worst;
}

template <Level kLevel>
void expect_one_joint_to_keep_its_bounds() {
  const Worst worst = drive_one_joint<kLevel>(trials(200));
  EXPECT_LE(worst.position, kSlack);
  EXPECT_LE(worst.velocity, kSlack);
  EXPECT_LE(worst.acceleration, kSlack);
  EXPECT_LE(worst.jerk, kSlack);
}

TEST(Jerk, one_joint_keeps_all_bounds_for_any_desired_motion) {
  expect_one_joint_to_keep_its_bounds<Level::kAcceleration>();
  expect_one_joint_to_keep_its_bounds<Level::kVelocity>();
}

/// A joint that is always pushed toward its end stops there. After braking starts, the velocity of the joint
/// decreases monotonically.
template <Level kLevel, typename Scalar>
void expect_to_rest_at_the_end() {
  constexpr auto kH = static_cast<Scalar>(kTick);
  for (std::uint32_t seed = 0; seed < static_cast<std::uint32_t>(trials(100)); ++seed) {
    Random random(seed);
    const Limits<kLevel, 1, Scalar> limits(random_bounds<Scalar>(random), kH);
    const JointLimits<1, Scalar>& bounds = limits.bounds();
    State<1, Scalar> state{Vector<1, Scalar>(Scalar(0)), Vector<1, Scalar>(Scalar(0))};
    Vector<1, Scalar> last(Scalar(0));
    bool brakes = false;
    const Scalar slack = std::numeric_limits<Scalar>::epsilon() * Scalar(8) / kH;
    for (int tick = 0; tick < 40000; ++tick) {
      const Vector<1, Scalar> u = limits.box(state, last).upper;
      const Scalar before = state.qd(0);
      last = kLevel == Level::kVelocity ? Vector<1, Scalar>((u - state.qd) / kH) : u;
      state.qd += kH * last;
      state.q += kH * (kLevel == Level::kVelocity ? state.qd : Vector<1, Scalar>(state.qd - kH / Scalar(2) * last));
      brakes = brakes || state.qd(0) < before - slack;
      ASSERT_FALSE(brakes && state.qd(0) > before + slack) << "seed " << seed << ", tick " << tick;
    }
    EXPECT_NEAR(state.q(0), bounds.upper(0), kSlack) << "seed " << seed;
    EXPECT_NEAR(state.qd(0), Scalar(0), slack) << "seed " << seed;
  }
}

TEST(Jerk, a_joint_pushed_against_its_end_does_not_chatter) {
  expect_to_rest_at_the_end<Level::kAcceleration, double>();
  expect_to_rest_at_the_end<Level::kVelocity, double>();
}

/// From every viable state, braking keeps all bounds, near an end and at any scale.
template <Level kLevel>
void expect_to_stop_from_viable_states() {
  int stopped = 0;
  for (std::uint32_t seed = 0; seed < static_cast<std::uint32_t>(trials(100000)); ++seed) {
    Random random(seed);
    const Limits<kLevel, 1> limits(random_bounds<double>(random), kTick);
    const JointLimits<1>& bounds = limits.bounds();
    if (!std::isfinite(bounds.jerk(0))) continue;
    const double step = bounds.jerk(0) * kTick;
    const double ticks = std::pow(10.0, random.uniform(-1.0, 2.0));
    Vector<1> last(
        std::clamp(random.uniform(-1.0, 1.0) * ticks * step, -bounds.acceleration(0), bounds.acceleration(0)));
    State<1> state{bounds.upper, Vector<1>(random.uniform(-1.0, 1.0) * ticks * ticks * kTick * step)};
    state.q(0) -= random.uniform(0.0, 0.5) * ticks * ticks * ticks * kTick * kTick * step;
    if (!complaint([&] { limits.require_viable(state, last); }).empty()) continue;
    ++stopped;
    for (int tick = 0; tick < 2000 && state.qd(0) != 0.0; ++tick) {
      const Vector<1> u = brake(limits, state, last);
      last = kLevel == Level::kVelocity ? Vector<1>((u - state.qd) / kTick) : u;
      state.qd += kTick * last;
      state.q += kTick * (kLevel == Level::kVelocity ? state.qd : Vector<1>(state.qd - kTick / 2.0 * last));
      ASSERT_LE(state.q(0), bounds.upper(0) + 1e-12) << "seed " << seed << ", tick " << tick;
    }
  }
  EXPECT_GE(stopped, trials(10000));
}

TEST(Jerk, every_viable_state_can_be_stopped) {
  expect_to_stop_from_viable_states<Level::kAcceleration>();
  expect_to_stop_from_viable_states<Level::kVelocity>();
}

/// The shortest stop in ticks is at most one tick longer than the shortest stop in continuous time.
TEST(Jerk, a_joint_stops_as_quickly_as_its_bounds_allow) {
  for (std::uint32_t seed = 0; seed < static_cast<std::uint32_t>(trials(20000)); ++seed) {
    Random random(seed);
    JointLimits<1> bounds = random_bounds<double>(random);
    bounds.lower(0) = -(bounds.upper(0) = 1e3);
    bounds.velocity(0) = 1e3;
    const Limits<Level::kAcceleration, 1> limits(bounds, kTick);
    const double A = bounds.acceleration(0);
    const double J = bounds.jerk(0);
    State<1> state{Vector<1>(0.0), Vector<1>(random.uniform(-3.0, 3.0))};
    Vector<1> last(random.uniform(-0.999, 0.999) * A);
    if (J * kTick >= 2.0 * A) continue;

    // If the velocity is positive after a is reduced to zero, the jerk of the stop is −J until the acceleration is
    // −peak, then 0, then J.
    const double s = state.qd(0) + last(0) * std::abs(last(0)) / (2.0 * J) < 0.0 ? -1.0 : 1.0;
    const double v = s * state.qd(0);
    const double a = s * last(0);
    double peak = std::sqrt(J * v + a * a / 2.0);
    double holds = 0.0;
    if (peak > A) {
      peak = A;
      holds = (v + a * a / (2.0 * J) - A * A / J) / A;
    }
    const double least = (a + peak) / J + holds + peak / J;

    int ticks = 0;
    while (ticks < 100000 && (std::abs(state.qd(0)) > 1e-12 || std::abs(last(0)) > 1e-9)) {
      last = brake(limits, state, last);
      state.q += kTick * (state.qd + kTick / 2.0 * last);
      state.qd += kTick * last;
      ++ticks;
    }
    ASSERT_LE(ticks, std::ceil(least / kTick) + 1.0) << "seed " << seed;
  }
}

/// Largest relative excess of x over a bound, minus the round-off error of a finite difference of positions.
template <int N>
[[nodiscard]] double excess(const Vector<N>& x, const Vector<N>& bound, double round_off = 0.0) {
  double most = 0.0;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    if (std::isfinite(bound(i))) most = std::max(most, (std::abs(x(i)) - round_off) / bound(i) - 1.0);
  }
  return most;
}

/// The last four commands, whose differences are the motion that a robot receives.
template <int N>
class Commands {
 public:
  explicit Commands(const Vector<N>& q0) : q_(4, q0) {}

  [[nodiscard]] double excess_after(const Vector<N>& q, const JointLimits<N>& bounds) {
    q_.pop_front();
    q_.push_back(q);
    const double round_off = 8.0 * std::numeric_limits<double>::epsilon() * q.cwiseAbs().maxCoeff();
    const Vector<N> v = (q_[3] - q_[2]) / kTick;
    const Vector<N> a = (q_[3] - 2.0 * q_[2] + q_[1]) / (kTick * kTick);
    const Vector<N> j = (q_[3] - 3.0 * q_[2] + 3.0 * q_[1] - q_[0]) / (kTick * kTick * kTick);
    return std::max({excess<N>(v, bounds.velocity, round_off / kTick),
                     excess<N>(a, bounds.acceleration, round_off / (kTick * kTick)),
                     excess<N>(j, bounds.jerk, round_off / (kTick * kTick * kTick))});
  }

 private:
  std::deque<Vector<N>> q_;
};

/// From rest, with every second joint of every fourth start on a bound, toward references that jump and have
/// inconsistent velocities and accelerations, and to rest again.
template <typename Space, typename Arm, typename MakeScheme>
void roll(const Arm& arm, JointLimits<Arm::kDof> given, MakeScheme&& make_scheme, int motions) {
  constexpr int N = Arm::kDof;
  for (int seed = 0; seed < motions; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(static_cast<std::uint32_t>(seed));
    const auto scheme = make_scheme(random, arm.dof());
    given.jerk = std::pow(10.0, random.uniform(1.0, 2.7)) * given.acceleration;
    const Limits<std::decay_t<decltype(scheme)>::kLevel, N> limits(given, kTick);
    const JointLimits<N>& bounds = limits.bounds();
    State<N> start{bounds.lower, Vector<N>::Zero(arm.dof())};
    for (int i = 0; i < arm.dof(); ++i) {
      const double low = std::max(bounds.lower(i), -3.0);
      const double high = std::min(bounds.upper(i), 3.0);
      start.q(i) = std::clamp(random.uniform(low, high), low, high);
      if (seed % 4 == 0 && i % 2 == 0) start.q(i) = i % 4 == 0 ? high : low;
    }
    CompiledTracker tracker(arm, Space{}, scheme, start, {}, limits);
    Commands<N> commands(start.q);
    auto reference = Reference<Space>::hold(tracker.tip());
    int ticks = 0;
    const auto tick = [&] {
      const Vector<N> last = tracker.acceleration();
      const auto result = tracker.tick(reference);
      ++ticks;
      const Vector<N> jump = (result.qdd - last) / kTick;
      const double beyond = std::max((result.q - bounds.upper).maxCoeff(), (bounds.lower - result.q).maxCoeff());
      const double worst =
          std::max({beyond, excess<N>(result.qd, bounds.velocity), excess<N>(result.qdd, bounds.acceleration),
                    excess<N>(jump, bounds.jerk), commands.excess_after(result.q, bounds)});
      ASSERT_LE(worst, kSlack) << "tick " << ticks;
      ASSERT_EQ(complaint([&] { tracker.require_viable(limits); }), "");
    };
    while (ticks < 400) {
      if (ticks % 40 == 0) reference = wild_reference<Space>(random, tracker.tip());
      ASSERT_NO_FATAL_FAILURE(tick());
    }
    tracker.stop();
    const auto moves = [&] { return tracker.state().qd.norm() > 1e-9 || tracker.acceleration().norm() > 1e-6; };
    while (ticks < 3000 && moves()) ASSERT_NO_FATAL_FAILURE(tick());
    ASSERT_FALSE(moves());
  }
}

template <typename Space, typename Arm>
void roll_schemes(const Arm& arm, const JointLimits<Arm::kDof>& bounds, int motions) {
  constexpr int N = Arm::kDof;
  const auto balanced = [](Random& random, Eigen::Index n) {
    return FPBM<N>(random.uniform(0.0, 1.0), Vector<N>(random.uniform(n, 0.5, 5.0)), 20.0, 100.0,
                   NullSpace<N>{}.with_damping(2.0));
  };
  const auto least_velocity = [](Random& random, Eigen::Index n) {
    return WMVN<N>(Vector<N>(Vector<N>::Ones(n)), random.uniform(0.0, 30.0));
  };
  roll<Space>(arm, bounds, balanced, motions);
  roll<Space>(arm, bounds, least_velocity, motions);
}

TEST(Jerk, all_bounds_hold_at_every_tick_until_rest) {
  for (const presets::Preset& preset : presets::kAll) {
    SCOPED_TRACE(preset.name);
    const AnyArm<Position<3>> arm = any_arm(preset.chain());
    roll_schemes<Position<3>>(arm, arm.limits(), trials(60));
    if (arm.dof() >= Pose::kRows) roll_schemes<Pose>(arm, arm.limits(), trials(60));
  }
  const AnyArm<Position<2>> planar = any_planar_arm(Vector<kOpen>::Constant(4, 0.5));
  auto bounds = JointLimits<kOpen>::none(4);
  for (Eigen::Index i = 0; i < 4; ++i) bounds.set(i, {-2.0, 2.5, 2.0, 10.0});
  roll_schemes<Position<2>>(planar, bounds, trials(60));
  roll_schemes<PlanarPose>(planar, bounds, trials(60));
  const SerialArm<7> fixed(presets::panda());
  roll_schemes<Pose>(fixed, fixed.limits(), trials(60));
}

/// A step of the target is followed along the same line as without a bound on jerk, and nearly as fast.
TEST(Jerk, a_step_is_followed_along_its_line) {
  const auto follow = [](double jerk) {
    Chain<> chain = presets::panda();
    for (Joint<>& joint : chain.joints) joint.bounds.jerk = jerk * joint.bounds.acceleration;
    const SerialArm<7> arm(chain);
    const auto scheme = FPBM<7>(0.6, Vector<7>(Vector<7>::Ones()), 20.0, 100.0, NullSpace<7>().with_damping(2.0));
    CompiledTracker tracker(arm, Pose{}, scheme, Vector<7>{0.0, -0.3, 0.0, -2.0, 0.0, 1.8, 0.8});
    auto reference = Reference<Pose>::hold(tracker.tip());
    const Vector<3> displacement{0.2, 0.1, -0.05};
    reference.x.p += displacement;
    double off = 0.0;
    int ticks = 0;
    for (int i = 0; i < 3000; ++i) {
      const auto tick = tracker.tick(reference);
      const Vector<3> error = tick.error.head<3>();
      off = std::max(off, (error - error.dot(displacement) / displacement.squaredNorm() * displacement).norm());
      if (tick.error.norm() > 1e-4) ticks = i + 1;
    }
    return std::make_pair(off, ticks);
  };
  const auto [off, ticks] = follow(std::numeric_limits<double>::infinity());
  for (const double jerk : {500.0, 100.0, 20.0}) {
    const auto [jerky_off, jerky_ticks] = follow(jerk);
    EXPECT_LE(jerky_off, off + 2e-5) << jerk;
    EXPECT_LE(jerky_ticks, ticks + 2.0 / (jerk * kTick) + 10.0) << jerk;
  }
}

/// A jerk bound that admits the full range of acceleration in one tick changes no bit.
TEST(Jerk, a_bound_without_effect_changes_no_bit) {
  const auto move = [](double jerk) {
    Chain<> chain = presets::panda();
    for (Joint<>& joint : chain.joints) joint.bounds.jerk = jerk;
    const SerialArm<7> arm(chain);
    const auto scheme = FPBM<7>(0.6, Vector<7>(Vector<7>::Ones()), 20.0, 100.0, NullSpace<7>().with_damping(2.0));
    CompiledTracker tracker(arm, Pose{}, scheme, Vector<7>{0.0, -0.3, 0.0, -2.0, 0.0, 1.8, 0.8});
    Random random(1);
    for (int i = 0; i < 300; ++i) tracker.tick(wild_reference<Pose>(random, tracker.tip()));
    return tracker.state();
  };
  const State<7> free = move(std::numeric_limits<double>::infinity());
  const State<7> same = move(2.0 * 20.0 / kTick);
  EXPECT_EQ(free.q, same.q);
  EXPECT_EQ(free.qd, same.qd);
}

/// A velocity envelope of a manufacturer near the ends of the range holds too.
TEST(Jerk, a_velocity_envelope_is_kept) {
  auto bounds = JointLimits<1>::none(1);
  bounds.set(0, {-2.75010, 2.75010, 2.62, 10.0, 5000.0, 0.30, 6.0});
  const Limits<Level::kAcceleration, 1> limits(bounds, kTick);
  const auto most = [](double distance) { return -0.30 + std::sqrt(12.0 * distance); };
  for (int trial = 0; trial < trials(40); ++trial) {
    Random random(static_cast<std::uint32_t>(trial));
    State<1> state{Vector<1>(0.0), Vector<1>(0.0)};
    Vector<1> last(0.0);
    for (int tick = 0; tick < 8000; ++tick) {
      const Vector<1> desired(asked(trial, tick, bounds, state, random));
      const Vector<1> u = limits.box(state, last).nearest(desired);
      ASSERT_LE(std::abs(u(0) - last(0)), (1.0 + kSlack) * bounds.jerk(0) * kTick);
      state.q += kTick * (state.qd + kTick / 2.0 * u);
      state.qd += kTick * u;
      last = u;
      ASSERT_LE(state.qd(0), most(2.75010 - state.q(0)) + kSlack) << "trial " << trial << ", tick " << tick;
      ASSERT_LE(-state.qd(0), most(2.75010 + state.q(0)) + kSlack) << "trial " << trial << ", tick " << tick;
    }
  }
}

/// resolve_measured() bounds the jerk with respect to its previous result, for any measured state.
TEST(Jerk, resolve_measured_bounds_its_jerk) {
  const SerialArm<7> arm(presets::panda());
  JointLimits<7> bounds = arm.limits();
  bounds.jerk = 100.0 * bounds.acceleration;
  const Limits<Level::kAcceleration, 7> limits(bounds, kTick);
  const auto scheme = FPBM<7>(0.6, Vector<7>(Vector<7>::Ones()), 20.0, 100.0, NullSpace<7>().with_damping(2.0));
  const Vector<7> ready{0.0, -0.3, 0.0, -2.0, 0.0, 1.8, 0.8};
  CompiledTracker tracker(arm, Pose{}, scheme, {ready, Vector<7>::Zero()}, {}, limits);
  Random random(3);
  const auto tip = tracker.tip();
  Vector<7> last = Vector<7>::Zero();
  for (int i = 0; i < 2000; ++i) {
    Vector<7> q = ready + Vector<7>(random.uniform(7, -1.0, 1.0));
    const Vector<7> qd = random.uniform(7, -4.0, 4.0);
    if (i % 7 == 0) q(i % 5) = std::numeric_limits<double>::quiet_NaN();
    const auto tick = tracker.resolve_measured(q, qd, wild_reference<Pose>(random, tip));
    ASSERT_LE(excess<7>((tick.qdd - last) / kTick, bounds.jerk), kSlack) << i;
    ASSERT_LE(excess<7>(tick.qdd, bounds.acceleration), kSlack) << i;
    last = tick.qdd;
  }
}

/// Joints measured beyond a bound return while keeping all other bounds, and stay within their bounds.
TEST(Jerk, joints_measured_beyond_a_bound_return) {
  for (std::uint32_t seed = 0; seed < static_cast<std::uint32_t>(trials(500)); ++seed) {
    Random random(seed);
    const JointLimits<1> bounds = random_bounds<double>(random);
    const Limits<Level::kAcceleration, 1> limits(bounds, kTick);
    State<1> state{Vector<1>(bounds.upper(0) + random.uniform(0.0, 0.3)),
                   Vector<1>(random.uniform(-1.0, 1.0) * bounds.velocity(0))};
    Vector<1> last(0.0);
    int outside = 0;
    for (int tick = 0; tick < 20000; ++tick) {
      last = limits.box(state, last).nearest(Vector<1>(seed % 2 == 0 ? 1e9 : 0.0));
      state.q += kTick * (state.qd + kTick / 2.0 * last);
      state.qd += kTick * last;
      if (state.q(0) > bounds.upper(0) + 1e-9) outside = tick;
      ASSERT_GE(state.q(0), bounds.lower(0) - kSlack);
    }
    EXPECT_LT(outside, 15000) << "seed " << seed;
  }
}

TEST(Jerk, invalid_bounds_are_rejected) {
  auto bounds = JointLimits<2>::none(2);
  bounds.set(0, {-1.0, 1.0, 2.0, 10.0, 100.0});
  bounds.set(1, {-1.0, 1.0, 2.0, 10.0, -1.0});
  using Accelerations = Limits<Level::kAcceleration, 2>;
  EXPECT_EQ(complaint([&] { Accelerations(bounds, kTick); }), "limits.jerk[1] = -1: must be positive");
  bounds.jerk(1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(complaint([&] { Accelerations(bounds, kTick); }), "limits.jerk[1] = nan: must be positive");
  bounds.jerk(1) = 100.0;
  bounds.acceleration(1) = std::numeric_limits<double>::infinity();
  EXPECT_EQ(complaint([&] { Limits<Level::kVelocity, 2>(bounds, kTick); }),
            "limits.acceleration[1] = inf: must be finite if the joint jerk is bounded: give a bound");
  bounds.acceleration(1) = 10.0;
  const Accelerations limits(bounds, kTick);
  const Vector<2> still = Vector<2>::Zero();
  EXPECT_EQ(complaint([&] {
              limits.require_viable({still, still}, Vector<2>(0.0, 10.5));
            }),
            "qdd0[1] = 10.5: must be within the joint's bound of 10");
  EXPECT_EQ(complaint([&] {
              limits.require_viable({still, Vector<2>(1.9, 0.0)}, Vector<2>(9.0, 0.0));
            }),
            "qd0[0] = 1.9: must be slow enough for the joint to stop within its bounds, or give recover_start = true, "
            "with which the joint returns");
}

}  // namespace
}  // namespace fpbm::test::jerk_laws
