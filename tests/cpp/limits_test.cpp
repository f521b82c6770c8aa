#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "support/arms.hpp"
#include "support/compiled_tracker.hpp"

/// Bounds on positions, velocities and accelerations hold at every tick, and a feasible motion always exists.
#include "support/wild_reference.hpp"

namespace fpbm::test::limits_laws {
namespace {

constexpr double kTick = 1e-3;
constexpr double kSlack = 1e-9;

template <int N>
[[nodiscard]] JointLimits<N> narrow_limits(Eigen::Index dof, Random& random) {
  auto limits = JointLimits<N>::none(dof);
  for (Eigen::Index i = 0; i < dof; ++i) {
    const double middle = random.uniform(-1.0, 1.0);
    const double reach = random.uniform(0.3, 2.0);
    limits.set(i, {middle - reach, middle + reach, random.uniform(0.3, 3.0), random.uniform(2.0, 20.0)});
  }
  return limits;
}

/// A random state from which the joints can stop in time.
template <Level kLevel, int N>
[[nodiscard]] State<N> viable_state(const Limits<kLevel, N>& limits, Random& random) {
  const auto& bounds = limits.bounds();
  State<N> state{bounds.lower, 0.0 * bounds.lower};
  for (Eigen::Index i = 0; i < state.q.size(); ++i) {
    state.q(i) = random.uniform(bounds.lower(i), bounds.upper(i));
    state.q(i) = std::clamp(state.q(i), bounds.lower(i), bounds.upper(i));  // uniform() rounds to float.
    const double room = 0.9 * (state.q(i) - bounds.lower(i));
    const double left = 0.9 * (bounds.upper(i) - state.q(i));
    const double braking = 2.0 * bounds.acceleration(i);
    const double up = std::min(bounds.velocity(i), std::max(0.0, std::sqrt(braking * left) - 0.05));
    const double down = std::min(bounds.velocity(i), std::max(0.0, std::sqrt(braking * room) - 0.05));
    state.qd(i) = random.uniform(-0.95 * down, 0.95 * up);
  }
  return state;
}

/// Largest excess of a tick over a bound; negative if all bounds hold.
template <int N, typename Result>
[[nodiscard]] double violation(const JointLimits<N>& bounds, const State<N>& before, const Result& tick) {
  const Vector<N> change = (tick.qd - before.qd) / kTick;
  return std::max({(tick.q - bounds.upper).maxCoeff(), (bounds.lower - tick.q).maxCoeff(),
                   (tick.qd.cwiseAbs() - bounds.velocity).maxCoeff(),
                   (tick.qdd.cwiseAbs() - bounds.acceleration).maxCoeff(),
                   (change.cwiseAbs() - bounds.acceleration).maxCoeff()});
}

/// Largest excess over the bounds on velocity and acceleration, by differences of the commanded positions of two ticks,
/// the first of which starts at q, minus the round-off error of these differences. Negative if the bounds on
/// velocity and acceleration hold.
template <int N>
[[nodiscard]] double violation_by_differences(const JointLimits<N>& bounds, const Vector<N>& q, const Vector<N>& before,
                                              const Vector<N>& now) {
  const Vector<N> first = (before - q) / kTick;
  const Vector<N> second = (now - before) / kTick;
  const Vector<N> change = (second - first) / kTick;
  const double round_off = 8.0 * std::numeric_limits<double>::epsilon() * now.cwiseAbs().maxCoeff() / (kTick * kTick);
  return std::max((second.cwiseAbs() - bounds.velocity).maxCoeff(),
                  (change.cwiseAbs() - bounds.acceleration).maxCoeff()) -
         round_off;
}

struct Tally {
  int rollouts = 0;
  long ticks = 0;
  long limited = 0;
  long slowed = 0;
  double worst = -std::numeric_limits<double>::infinity();
};

/// From random starts, toward references that change ten times and violate every limit. Another tracker can start from
/// every state of these motions.
template <typename Space, typename Arm, typename MakeScheme>
void roll(const Arm& arm, const JointLimits<Arm::kDof>& bounds, MakeScheme&& make_scheme, int rollouts, Tally& tally) {
  constexpr int N = Arm::kDof;
  for (int seed = 0; seed < rollouts; ++seed) {
    Random random(static_cast<std::uint32_t>(seed));
    const auto scheme = make_scheme(random, arm.dof());
    constexpr Level kLevel = std::decay_t<decltype(scheme)>::kLevel;
    const Limits<kLevel, N> limits(bounds, kTick);
    CompiledTracker tracker(arm, Space{}, scheme, viable_state(limits, random), {}, limits);
    auto reference = Reference<Space>::hold(tracker.tip());
    Vector<N> previous = tracker.state().q;
    for (int i = 0; i < 200; ++i) {
      if (i % 20 == 0) reference = wild_reference<Space>(random, tracker.tip());
      const State<N> before = tracker.state();
      const auto tick = tracker.tick(reference);
      ASSERT_TRUE(tick.q.allFinite() && tick.qd.allFinite() && tick.qdd.allFinite()) << "seed " << seed;
      const double broken = violation(bounds, before, tick);
      ASSERT_LE(broken, kSlack) << "seed " << seed << ", tick " << i;
      if (i > 0) {
        ASSERT_LE(violation_by_differences<N>(bounds, previous, before.q, tick.q), kSlack) << "tick " << i;
      }
      previous = before.q;
      ASSERT_FALSE(failed(tick.status));
      ASSERT_EQ(complaint([&] { tracker.require_viable(limits); }), "") << "seed " << seed << ", tick " << i;
      ASSERT_TRUE(tick.scale >= 0.0 && tick.scale <= 1.0);
      tally.worst = std::max(tally.worst, broken);
      tally.limited += tick.saturated != 0 ? 1 : 0;
      tally.slowed += tick.status == Status::kSlowed ? 1 : 0;
      ++tally.ticks;
    }
    ++tally.rollouts;
  }
}

template <int N>
[[nodiscard]] Vector<N> random_weights(Random& random, Eigen::Index dof) {
  return random.uniform(dof, 0.5, 5.0);
}

/// Rolls under every scheme of the paper. The code of the Tracker depends on the level only: MVN and MAN are WMVN and
/// Balanced with equal weights.
template <typename Space, typename Arm>
void roll_every_scheme(const char* name, const Arm& arm, const JointLimits<Arm::kDof>& bounds, int rollouts) {
  constexpr int N = Arm::kDof;
  const auto z = NullSpace<N>{}.with_damping(2.0);
  const Vector<N> ones = Vector<N>::Ones(arm.dof());
  Tally tally;
  using Accelerations = std::function<AccelerationScheme<N>(Random&, Eigen::Index)>;
  const auto roll_accelerations = [&](const Accelerations& make_scheme, int times) {
    roll<Space>(arm, bounds, make_scheme, times, tally);
  };
  using Velocities = std::function<VelocityScheme<N>(Random&, Eigen::Index)>;
  const auto roll_velocities = [&](const Velocities& make_scheme) {
    roll<Space>(arm, bounds, make_scheme, rollouts, tally);
  };
  roll_accelerations(
      [&](Random& random, Eigen::Index dof) {
        return FPBM<N>(random.uniform(0.0, 1.0), random_weights<N>(random, dof), 20.0, 100.0, z);
      },
      3 * rollouts);
  roll_accelerations([&](Random&, Eigen::Index) { return Balanced<N>(0.0, ones, z); }, rollouts);
  roll_accelerations(
      [&](Random& random, Eigen::Index dof) { return WMVNAcceleration<N>(random_weights<N>(random, dof)); }, rollouts);
  roll_accelerations(
      [&](Random& random, Eigen::Index dof) { return Balanced<N>(0.6, random_weights<N>(random, dof), z); }, rollouts);
  roll_velocities([&](Random&, Eigen::Index) { return WMVN<N>(ones, 10.0); });
  roll_velocities([&](Random& random, Eigen::Index dof) { return WMVN<N>(random_weights<N>(random, dof), 10.0); });
  std::printf("%s: %d rollouts, %ld ticks, %.0f %% limited, %.0f %% slowed, worst violation %.1e\n", name,
              tally.rollouts, tally.ticks,
              100.0 * static_cast<double>(tally.limited) / static_cast<double>(tally.ticks),
              100.0 * static_cast<double>(tally.slowed) / static_cast<double>(tally.ticks), tally.worst);
}

/// The ends of a box are motions of a tick that keep every bound, from any viable state.
template <Level kLevel>
void expect_boxes_within_bounds() {
  constexpr int N = 4;
  constexpr double kRoundOff = 1e-12;
  for (std::uint32_t seed = 0; seed < 500; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const auto bounds = narrow_limits<N>(N, random);
    const Limits<kLevel, N> limits(bounds, kTick);
    const State<N> state = viable_state(limits, random);
    const auto box = limits.box(state);
    for (const Vector<N>& u : {box.lower, box.upper}) {
      const Vector<N> qd = kLevel == Level::kVelocity ? u : Vector<N>(state.qd + kTick * u);
      ASSERT_LE(((qd - state.qd) / kTick - bounds.acceleration).maxCoeff(), kRoundOff);
      ASSERT_LE(((state.qd - qd) / kTick - bounds.acceleration).maxCoeff(), kRoundOff);
      ASSERT_LE((qd.cwiseAbs() - bounds.velocity).maxCoeff(), kRoundOff);
    }
    ASSERT_LE((box.lower - box.upper).maxCoeff(), 0.0);
  }
}
TEST(Limits, of_a_tick_are_within_the_bounds) {
  expect_boxes_within_bounds<Level::kVelocity>();
  expect_boxes_within_bounds<Level::kAcceleration>();
}

/// 12,000 rollouts in total with FPBM_ALL_TRIALS.
TEST(Limits, hold_on_a_planar_arm) {
  Random random(7);
  roll_every_scheme<Position<2>>("planar, 4 joints", PlanarArm<4>(Vector<4>::Ones()), narrow_limits<4>(4, random),
                                 trials(500, 200));
}
TEST(Limits, hold_on_the_panda) {
  const SerialArm<7> panda(presets::panda());
  roll_every_scheme<Pose>("Panda, pose", panda, panda.limits(), trials(500, 200));
}
TEST(Limits, hold_on_a_rail) {
  const AnyArm<Position<3>> rail = any_arm(panda_on_rail());
  roll_every_scheme<Position<3>>("Panda on a rail, position", rail, rail.limits(), trials(250, 100));
}
TEST(Limits, hold_on_arms_without_redundancy) {
  const AnyArm<Position<3>> ur5e = any_arm(presets::ur5e());
  roll_every_scheme<Pose>("UR5e, pose", ur5e, ur5e.limits(), trials(125));
  const SerialArm<6> fixed(presets::ur5e());
  const auto fpbm = [](Random& random, Eigen::Index dof) {
    return FPBM<6>(random.uniform(0.0, 1.0), random_weights<6>(random, dof), 20.0, 100.0,
                   NullSpace<6>{}.with_damping(2.0));
  };
  Tally tally;
  roll<Pose>(fixed, fixed.limits(), fpbm, trials(125), tally);
  Random random(2);
  roll_every_scheme<Position<2>>("planar, 2 joints", any_planar_arm(Vector<Eigen::Dynamic>::Ones(2)),
                                 narrow_limits<Eigen::Dynamic>(2, random), trials(125));
}

/// The last joint of the Panda rotates about the tip, and stays at rest although the other joints are limited.
TEST(Limits, do_not_drive_a_joint_that_cannot_move_the_tip) {
  constexpr int N = Eigen::Dynamic;
  const AnyArm<Position<3>> arm = any_arm(presets::panda());
  const auto scheme =
      FPBM<N>(0.6, (Vector<N>(7) << 8, 8, 4, 4, 2, 1, 1).finished(), 20.0, 100.0, NullSpace<N>{}.with_damping(2.0));
  const Vector<N> range = arm.limits().upper - arm.limits().lower;
  double fastest = 0.0;
  // With seed 349, saturation steps that were mostly round-off error drove the joint with 20 rad/s².
  for (int seed = 349; seed < 349 + trials(100); ++seed) {
    Random random(static_cast<std::uint32_t>(seed));
    const Vector<N> q0 = arm.limits().lower + random.uniform(7, 0.3, 0.7).cwiseProduct(range);
    CompiledTracker tracker(arm, Position<3>{}, scheme, q0);
    auto reference = Reference<Position<3>>::hold(tracker.tip());
    reference.x += random.uniform(3, -0.3, 0.3);
    for (int i = 0; i < 3000; ++i) fastest = std::max(fastest, std::abs(tracker.tick(reference).qdd(6)));
  }
  EXPECT_LE(fastest, 1e-3);
}

/// A joint that is driven toward its end as hard as its box admits stops there. After braking starts, the
/// velocity of the joint decreases monotonically: no chatter.
TEST(Limits, bring_a_joint_to_rest_at_its_end_without_chatter) {
  auto bounds = JointLimits<1>::none(1);
  bounds.set(0, {-1.0, 1.0, 2.0, 10.0});
  const Limits<Level::kAcceleration, 1> limits(bounds, kTick);
  State<1> state{Vector<1>(0.0), Vector<1>(0.0)};
  bool braking = false;
  for (int i = 0; i < 3000; ++i) {
    const auto box = limits.box(state);
    ASSERT_LE(box.lower(0), box.upper(0));
    const double a = box.upper(0);
    if (a < 0.0) braking = true;
    if (braking) {
      ASSERT_LE(a, 1e-9) << i;
    }
    state.q(0) += kTick * (state.qd(0) + kTick / 2.0 * a);
    state.qd(0) += kTick * a;
    ASSERT_LE(state.q(0), 1.0 + 1e-12);
    ASSERT_LE(state.qd(0), 2.0 + 1e-12);
    ASSERT_GE(state.qd(0), -1e-12);
  }
  EXPECT_TRUE(braking);
  EXPECT_NEAR(state.q(0), 1.0, 1e-6);
  EXPECT_NEAR(state.qd(0), 0.0, 1e-6);
}

/// For every viable state, the box is not empty, and both of its ends lead to viable states.
template <Level kLevel>
void expect_invariance() {
  for (std::uint32_t seed = 0; seed < 20000; ++seed) {
    Random random(seed);
    const Limits<kLevel, 3> limits(narrow_limits<3>(3, random), kTick);
    const State<3> state = viable_state(limits, random);
    ASSERT_NO_THROW(limits.require_viable(state));
    const auto box = limits.box(state);
    ASSERT_TRUE((box.lower.array() <= box.upper.array()).all()) << "seed " << seed;
    for (const double share :
         {1e-6, 1.0 - 1e-6}) {  // Near the ends of the box, because round-off error may move the ends outside.
      const Vector<3> u = (1.0 - share) * box.lower + share * box.upper;
      State<3> next = state;
      if constexpr (kLevel == Level::kAcceleration) {
        next.q += kTick * (state.qd + kTick / 2.0 * u);
        next.qd += kTick * u;
      } else {
        next.q += kTick * u;
        next.qd = u;
      }
      const auto again = limits.box(next);
      ASSERT_TRUE((again.lower.array() <= again.upper.array()).all()) << "seed " << seed;
      ASSERT_TRUE(limits.admits(state, next)) << "seed " << seed;
    }
  }
}
TEST(Limits, leave_a_viable_motion_from_every_viable_state) {
  expect_invariance<Level::kAcceleration>();
  expect_invariance<Level::kVelocity>();
}

/// A joint that starts at rest on either end of its range is not pushed beyond the end or off the end, for all units
/// and ticks.
template <Level kLevel, typename Scalar>
void expect_rest_on_both_ends(const JointBounds<>& joint, double seconds) {
  auto bounds = JointLimits<1, Scalar>::none(1);
  bounds.set(0, {Scalar(joint.lower), Scalar(joint.upper), Scalar(joint.velocity), Scalar(joint.acceleration)});
  const auto tick = static_cast<Scalar>(seconds);
  const Limits<kLevel, 1, Scalar> limits(bounds, tick);
  const Scalar size = std::abs(bounds.lower(0)) + std::abs(bounds.upper(0));
  const Scalar slack = std::numeric_limits<Scalar>::epsilon() * Scalar(100) * size;
  for (const Scalar end : {bounds.lower(0), bounds.upper(0)}) {
    State<1, Scalar> state{Vector<1, Scalar>(end), Vector<1, Scalar>(Scalar(0))};
    ASSERT_EQ(complaint([&] { limits.require_viable(state); }), "") << end;
    const bool up = end == bounds.upper(0);
    for (int i = 0; i < 100; ++i) {
      const auto box = limits.box(state);
      const Scalar u = up ? box.upper(0) : box.lower(0);
      ASSERT_EQ(u, Scalar(0)) << i;
      if constexpr (kLevel == Level::kAcceleration) {
        state.q(0) += tick * (state.qd(0) + tick / Scalar(2) * u);
        state.qd(0) += tick * u;
      } else {
        state.q(0) += tick * u;
        state.qd(0) = u;
      }
      ASSERT_LE(up ? state.q(0) - end : end - state.q(0), slack);
      ASSERT_LE(std::abs(state.qd(0)), slack / tick) << i;
    }
  }
}
TEST(Limits, allow_rest_on_the_ends_of_every_range) {
  std::vector<JointBounds<>> joints;
  for (const presets::Preset& preset : presets::kAll) {
    for (const Joint<>& joint : preset.chain().joints) joints.push_back(joint.bounds);
  }
  Random random(3);
  for (int i = 0; i < 1000; ++i) {
    const double middle = random.uniform(-3.0, 3.0);
    const double reach = random.uniform(0.01, 3.0);
    joints.push_back({middle - reach, middle + reach, random.uniform(0.1, 10.0), random.uniform(0.1, 100.0)});
  }
  for (JointBounds<>& joint : joints) {
    if (!std::isfinite(joint.lower)) continue;
    if (!std::isfinite(joint.acceleration)) joint.acceleration = 10.0;
    const double unit = std::pow(10.0, random.uniform(-3.0, 3.0));  // Small arms, and arms in millimetres.
    for (double* bound : {&joint.lower, &joint.upper, &joint.velocity, &joint.acceleration}) *bound *= unit;
    const double tick = std::pow(10.0, random.uniform(-4.0, -2.0));
    expect_rest_on_both_ends<Level::kAcceleration, double>(joint, tick);
    expect_rest_on_both_ends<Level::kVelocity, double>(joint, tick);
    expect_rest_on_both_ends<Level::kAcceleration, float>(joint, tick);
    expect_rest_on_both_ends<Level::kVelocity, float>(joint, tick);
  }
  auto unbounded = JointLimits<1>::none(1);
  unbounded.set(0, {-JointBounds<>::kNone, JointBounds<>::kNone, 0.3, 10.0});
  const Limits<Level::kAcceleration, 1> limits(unbounded, kTick);
  EXPECT_EQ(complaint([&] { limits.require_viable({Vector<1>(0.0), Vector<1>(std::nextafter(0.3, 1.0))}); }), "");
  EXPECT_NE(complaint([&] { limits.require_viable({Vector<1>(0.0), Vector<1>(0.3 + 1e-12)}); }), "");
}

/// Velocity bounds that depend on position, as Franka prescribes them for the FR3.
TEST(Limits, keep_velocity_bounds_that_depend_on_position) {
  auto bounds = JointLimits<1>::none(1);
  bounds.set(0, {-2.75010, 2.75010, 2.62, 10.0, JointBounds<>::kNone, 0.30, 6.0});
  const Limits<Level::kAcceleration, 1> limits(bounds, kTick);
  for (const bool up : {true, false}) {
    State<1> state{Vector<1>(0.0), Vector<1>(0.0)};
    for (int i = 0; i < 5000; ++i) {
      const auto box = limits.box(state);
      const double a = up ? box.upper(0) : box.lower(0);
      ASSERT_LE(std::abs(a), 10.0);
      state.q(0) += kTick * (state.qd(0) + kTick / 2.0 * a);
      state.qd(0) += kTick * a;
      const double q = up ? state.q(0) : -state.q(0);
      const double bound = std::min(2.62, std::max(0.0, -0.30 + std::sqrt(std::max(0.0, 12.0 * (2.75010 - q)))));
      ASSERT_LE(std::abs(state.qd(0)), bound + 1e-12);
      ASSERT_LE(std::abs(state.q(0)), 2.75010 - 0.09 / 12.0);
    }
    EXPECT_NEAR(std::abs(state.q(0)), 2.75010 - 0.09 / 12.0, 1e-6);
  }
}

TEST(Limits, name_the_invalid_bound) {
  auto bounds = JointLimits<2>::none(2);
  using Accelerations = Limits<Level::kAcceleration, 2>;
  EXPECT_EQ(complaint([&] { Accelerations(bounds, kTick); }), "");
  bounds.set(1, {-1.0, 1.0, 2.0, std::numeric_limits<double>::infinity()});
  EXPECT_EQ(complaint([&] { Accelerations(bounds, kTick); }),
            "limits.acceleration[1] = inf: must be finite if the joint position or velocity is bounded: give a bound");
  EXPECT_EQ(complaint([&] { Limits<Level::kVelocity, 2>(bounds, kTick); }), "");
  bounds.set(1, {1.0, 1.0, 2.0, 5.0});
  EXPECT_EQ(complaint([&] { Accelerations(bounds, kTick); }), "limits.lower[1] = 1: must be below limits.upper");
  bounds.set(1, {-1.0, 1.0, 0.0, 5.0});
  EXPECT_EQ(complaint([&] { Accelerations(bounds, kTick); }), "limits.velocity[1] = 0: must be positive");
  bounds.set(1, {-1.0, 1.0, 2.0, -5.0});
  EXPECT_EQ(complaint([&] { Accelerations(bounds, kTick); }), "limits.acceleration[1] = -5: must be positive");
  bounds.set(1, {-1.0, 1.0, 2.0, 5.0});
  auto uneven = JointLimits<Eigen::Dynamic>::none(2);
  uneven.upper.resize(1);
  EXPECT_EQ(complaint([&] { Limits<Level::kVelocity, Eigen::Dynamic>(uneven, kTick); }),
            "limits.upper has 1 entries: must have 2, one per joint");
  const Accelerations limits(bounds, kTick);
  EXPECT_EQ(complaint([&] {
              limits.require_viable({Vector<2>(0.0, 1.5), Vector<2>::Zero()});
            }),
            "q0[1] = 1.5: must be within the joint's range, from -1 to 1, or give recover_start = true, with which the "
            "joint returns");
  EXPECT_EQ(complaint([&] {
              limits.require_viable({Vector<2>(0.0, 0.9), Vector<2>(0.0, 1.5)});
            }),
            "qd0[1] = 1.5: must be slow enough for the joint to stop within its bounds, or give recover_start = true, "
            "with which the joint returns");
}

}  // namespace
}  // namespace fpbm::test::limits_laws
