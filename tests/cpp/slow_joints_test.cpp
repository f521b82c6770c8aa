#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "fpbm/any/any_arm.hpp"
#include "fpbm/limits/limits.hpp"
#include "fpbm/scheme/schemes.hpp"
#include "support/arms.hpp"
#include "support/compiled_tracker.hpp"

/// Joints of any speed keep their bounds, down to joints whose velocity bound V is below J h², the change of velocity
/// in one tick with the jerk J. Every motion within box() leads from a viable state to a viable state, and
/// require_viable() accepts these states despite round-off error.
namespace fpbm::test::slow_joints_laws {
namespace {

constexpr int kOpen = Eigen::Dynamic;

template <typename Scalar>
constexpr Scalar kEpsilon = std::numeric_limits<Scalar>::epsilon();

/// A random number from low to high, both positive, with a uniform logarithm.
[[nodiscard]] double spread(Random& random, double low, double high) {
  return std::exp(random.uniform(std::log(low), std::log(high)));
}

struct Joint1 {
  JointBounds<> bounds;
  double tick;
};

/// Bounds in units of the tick: J h for accelerations, J h² for velocities, J h³ for positions.
[[nodiscard]] Joint1 random_joint(std::uint32_t seed, Random& random) {
  constexpr double kTicks[] = {1e-3, 3e-3, 2e-2};
  const double h = seed % 4 < 3 ? kTicks[seed % 4] : spread(random, 1e-4, 5e-2);
  JointBounds<> joint;
  joint.jerk = spread(random, 0.1, 1e5);
  joint.acceleration = joint.jerk * h * spread(random, 0.51, seed % 2 == 0 ? 3.0 : 300.0);
  const double unit = joint.jerk * h * h;
  joint.velocity = unit * spread(random, seed % 5 == 0 ? 1e-6 : 1e-2, seed % 3 == 0 ? 1e4 : 2.0);
  const double stop = joint.velocity * std::max(joint.velocity / joint.acceleration, joint.acceleration / joint.jerk);
  const double range = std::max(unit * h, stop) * spread(random, 0.02, 30.0);
  const double middle = seed % 3 == 0 ? 0.0 : random.uniform(-3.0, 3.0);
  joint.lower = middle - range / 2.0;
  if (seed % 7 != 0) joint.upper = middle + range / 2.0;
  if (random.uniform(0.0, 1.0) < 0.5) {
    joint.velocity_offset = joint.velocity * spread(random, 1e-3, 0.5);
    joint.deceleration = joint.acceleration * spread(random, 0.01, 10.0);
  }
  return {joint, h};
}

template <typename Scalar>
[[nodiscard]] JointBounds<Scalar> cast(const JointBounds<>& joint) {
  JointLimits<1> all = JointLimits<1>::none(1);
  all.set(0, joint);
  return all.cast<Scalar>().joint(0);
}

/// Whether |value| ≤ bound, up to the round-off error of `scale`.
template <typename Scalar>
[[nodiscard]] bool within(Scalar value, Scalar bound, Scalar scale) {
  return std::abs(value) <= bound + Scalar(16) * kEpsilon<Scalar> * (bound + scale);
}

/// A joint in a loop of ticks. Each tick selects a motion in the box.
template <Level kLevel, typename Scalar>
class Driven {
 public:
  using Single = Vector<1, Scalar>;

  Driven(const Limits<kLevel, 1, Scalar>& limits, Scalar q, Scalar qd, Scalar last)
      : limits_(limits), state_{Single(q), Single(qd)}, last_(last) {}

  [[nodiscard]] Scalar q() const { return state_.q(0); }
  [[nodiscard]] Scalar qd() const { return state_.qd(0); }
  [[nodiscard]] Scalar acceleration() const { return last_(0); }
  [[nodiscard]] std::string refusal() const {
    return complaint([&] { limits_.require_viable(state_, last_); });
  }

  /// share: 0 for the lower end of the box, 1 for the upper end.
  void tick(double share) {
    const Scalar h = limits_.tick();
    const auto box = limits_.box(state_, last_);
    ASSERT_LE(box.lower(0), box.upper(0));
    const auto part = static_cast<Scalar>(share);
    const Scalar inside = box.lower(0) + part * (box.upper(0) - box.lower(0));
    const Scalar u = share <= 0.0 ? box.lower(0) : share >= 1.0 ? box.upper(0) : inside;
    const State<1, Scalar> before = state_;
    const Scalar from = last_(0);
    Scalar displacement = h;
    if constexpr (kLevel == Level::kVelocity) {
      last_(0) = (u - qd()) / h;
      state_.qd(0) = u;
      displacement *= u;
    } else {
      last_(0) = u;
      state_.qd(0) += h * u;
      displacement *= before.qd(0) + h / Scalar(2) * u;
    }
    state_.q(0) += displacement;
    ASSERT_NO_FATAL_FAILURE(expect_bounds(before, from));
    ASSERT_EQ(refusal(), "");
  }

 private:
  void expect_bounds(const State<1, Scalar>& before, Scalar from) const {
    const JointBounds<Scalar> bounds = limits_.bounds().joint(0);
    const Scalar h = limits_.tick();
    const Scalar speed = std::abs(before.qd(0)) + std::abs(qd());
    ASSERT_TRUE(within(qd(), bounds.velocity, Scalar(0))) << qd() / bounds.velocity;
    ASSERT_TRUE(within(acceleration(), bounds.acceleration, speed / h)) << acceleration() / bounds.acceleration;
    const Scalar change = (acceleration() - from) / h;
    const Scalar least = (speed / h + std::abs(from)) / h;
    ASSERT_TRUE(within(change, bounds.jerk, least)) << change / bounds.jerk;
    const Scalar size =
        std::abs(bounds.lower) + (std::isfinite(bounds.upper) ? bounds.upper - bounds.lower : Scalar(0));
    ASSERT_TRUE(within((q() - before.q(0)) / h, bounds.velocity, (std::abs(q()) + size) / h));
    const Scalar slack = Scalar(16) * kEpsilon<Scalar> * (size + std::abs(q()));
    const Scalar turns = before.q(0) - before.qd(0) * before.qd(0) / (Scalar(2) * acceleration());
    const bool turned = kLevel == Level::kAcceleration && before.qd(0) * qd() < Scalar(0);
    for (const Scalar at : {q(), turned ? turns : q()}) {
      ASSERT_LE(at, bounds.upper + slack);
      ASSERT_GE(at, bounds.lower - slack);
    }
  }

  const Limits<kLevel, 1, Scalar>& limits_;
  State<1, Scalar> state_;
  Single last_;
};

/// The limits of a random joint. Empty if Limits rejects the bounds, or does not use the bound on jerk.
template <Level kLevel, typename Scalar>
[[nodiscard]] std::optional<Limits<kLevel, 1, Scalar>> random_limits(std::uint32_t seed, Random& random) {
  const Joint1 joint = random_joint(seed, random);
  auto bounds = JointLimits<1, Scalar>::none(1);
  bounds.set(0, cast<Scalar>(joint.bounds));
  std::optional<Limits<kLevel, 1, Scalar>> limits;
  static_cast<void>(complaint([&] { limits.emplace(bounds, static_cast<Scalar>(joint.tick)); }));
  if (limits && !limits->bounds_jerk()) limits.reset();
  return limits;
}

/// Pushes against an end, jumps between both ends of the box, or selects at random.
[[nodiscard]] double share_of(std::uint32_t seed, int tick, Random& random) {
  switch (seed / 4 % 6) {
    case 0: return 1.0;
    case 1: return tick / 10 % 2;
    case 2: return random.uniform(0.0, 1.0) < 0.5;
    case 3: return tick / 100 % 2;
    case 4: return random.uniform(0.0, 1.0);
    default: return tick % 100 < 50 || random.uniform(0.0, 1.0) < 0.5;
  }
}

template <Level kLevel, typename Scalar>
void expect_to_keep_bounds() {
  int joints = 0;
  for (std::uint32_t seed = 0; seed < static_cast<std::uint32_t>(trials(2000)); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const auto limits = random_limits<kLevel, Scalar>(seed, random);
    if (!limits) continue;
    ++joints;
    const JointBounds<Scalar> bounds = limits->bounds().joint(0);
    const Scalar upper = std::isfinite(bounds.upper) ? bounds.upper : bounds.lower;
    Driven<kLevel, Scalar> joint(*limits, bounds.lower + (upper - bounds.lower) * Scalar(seed % 3) / Scalar(2),
                                 Scalar(0), Scalar(0));
    if (joint.q() < bounds.lower || joint.q() > bounds.upper) continue;
    for (int tick = 0; tick < 600; ++tick) {
      ASSERT_NO_FATAL_FAILURE(joint.tick(share_of(seed, tick, random))) << "tick " << tick;
    }
  }
  EXPECT_GE(joints, trials(1500));
}

TEST(SlowJoints, keep_their_bounds_for_any_desired_motion) {
  expect_to_keep_bounds<Level::kAcceleration, double>();
  expect_to_keep_bounds<Level::kVelocity, double>();
  expect_to_keep_bounds<Level::kAcceleration, float>();
  expect_to_keep_bounds<Level::kVelocity, float>();
}

/// A random state. Most states are as near to the upper end as their velocity and acceleration admit.
template <Level kLevel, typename Scalar>
[[nodiscard]] Driven<kLevel, Scalar> random_state(const Limits<kLevel, 1, Scalar>& limits, Random& random) {
  const JointBounds<Scalar> bounds = limits.bounds().joint(0);
  const Scalar h = limits.tick();
  const double ticks = spread(random, 0.1, 30.0);
  const Scalar step = bounds.jerk * h;
  const auto uniform = [&](Scalar low, Scalar high) { return static_cast<Scalar>(random.uniform(low, high)); };
  const Scalar reach = static_cast<Scalar>(ticks) * step;
  const Scalar last = std::clamp(uniform(-reach, reach), -bounds.acceleration, bounds.acceleration);
  const Scalar speed = random.uniform(0.0, 1.0) < 0.5 ? bounds.velocity : static_cast<Scalar>(ticks) * reach * h;
  const Scalar qd = std::clamp(uniform(-speed, speed), -bounds.velocity, bounds.velocity);
  const Scalar far = std::isfinite(bounds.upper) ? bounds.upper : bounds.lower + step * h * h;
  Scalar low = bounds.lower;
  Scalar high = far;
  const bool at_the_end = random.uniform(0.0, 1.0) < 0.7;
  for (int i = 0; at_the_end && i < 60; ++i) {
    const Scalar middle = (low + high) / Scalar(2);
    (limits.jerk_limited(0).viable({middle, qd, last}) ? low : high) = middle;
  }
  return {limits, at_the_end ? low : bounds.lower + uniform(Scalar(0), Scalar(1)) * (far - bounds.lower), qd, last};
}

template <Level kLevel, typename Scalar>
void expect_viable_states_to_lead_to_viable_ones() {
  int states = 0;
  for (std::uint32_t seed = 0; seed < static_cast<std::uint32_t>(trials(1000)); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const auto limits = random_limits<kLevel, Scalar>(seed, random);
    if (!limits) continue;
    for (int start = 0; start < 20; ++start) {
      auto joint = random_state(*limits, random);
      if (!limits->jerk_limited(0).viable({joint.q(), joint.qd(), joint.acceleration()})) continue;
      ++states;
      for (int tick = 0; tick < 12; ++tick) {
        const double share = random.uniform(-1.0, 2.0);
        ASSERT_NO_FATAL_FAILURE(joint.tick(share)) << "start " << start << ", tick " << tick;
      }
    }
  }
  EXPECT_GE(states, trials(4000));
}

TEST(SlowJoints, stay_viable_from_every_viable_state) {
  expect_viable_states_to_lead_to_viable_ones<Level::kAcceleration, double>();
  expect_viable_states_to_lead_to_viable_ones<Level::kVelocity, double>();
  expect_viable_states_to_lead_to_viable_ones<Level::kAcceleration, float>();
  expect_viable_states_to_lead_to_viable_ones<Level::kVelocity, float>();
}

/// At rest on the upper end, the joint can move off the end in box_in_time(), but not beyond it.
template <Level kLevel>
void expect_time_to_leave_the_end() {
  for (std::uint32_t seed = 0; seed < static_cast<std::uint32_t>(trials(2000)); ++seed) {
    Random random(seed);
    const auto limits = random_limits<kLevel, double>(seed, random);
    if (!limits || !std::isfinite(limits->bounds().upper(0))) continue;
    const State<1> state{limits->bounds().upper, Vector<1>(0.0)};
    const auto box = limits->box_in_time(state);
    ASSERT_LT(box.lower(0), 0.0) << "seed " << seed;
    ASSERT_LE(std::abs(box.upper(0)), 1e-6 * std::abs(box.lower(0))) << "seed " << seed;
  }
}

TEST(SlowJoints, leave_an_end_of_their_range_in_time) {
  expect_time_to_leave_the_end<Level::kAcceleration>();
  expect_time_to_leave_the_end<Level::kVelocity>();
}

/// Random bounds of the joints of an arm, with and without bounds on jerk and velocity envelopes.
[[nodiscard]] Chain<> with_random_bounds(Chain<> chain, Random& random) {
  for (Joint<>& joint : chain.joints) {
    JointBounds<>& bounds = joint.bounds;
    bounds = {};
    bounds.lower = random.uniform(-3.0, 0.0);
    bounds.upper = bounds.lower + spread(random, 0.1, 5.0);
    bounds.velocity = spread(random, 0.05, 5.0);
    bounds.acceleration = spread(random, 0.5, 50.0);
    if (random.uniform(0.0, 1.0) < 0.7) bounds.jerk = bounds.acceleration * spread(random, 2.0, 1000.0);
    if (random.uniform(0.0, 1.0) < 0.3) {
      bounds.velocity_offset = random.uniform(0.0, 0.2);
      bounds.deceleration = spread(random, 0.5, 50.0);
    }
  }
  return chain;
}

/// The arm types for which trackers are compiled.
template <typename Scalar>
[[nodiscard]] auto arm_of(const Chain<>& chain) {
  if constexpr (std::is_same_v<Scalar, double>) {
    return any_arm(chain);
  } else {
    return SerialArm<kOpen>(chain).template cast<Scalar>();
  }
}

template <typename Scalar, typename Scheme>
void expect_to_be_made_again(const Scheme& scheme, int motions) {
  using Joints = Vector<kOpen, Scalar>;
  using Target = Reference<Position<3>, Scalar>;
  int made = 0;
  for (std::uint32_t seed = 0; seed < static_cast<std::uint32_t>(motions); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const auto arm = arm_of<Scalar>(with_random_bounds(presets::fr3(), random));
    TrackerOptions<Scalar> options;
    options.dt = static_cast<Scalar>(seed % 2 == 0 ? 1e-3 : spread(random, 1e-4, 1e-2));
    std::optional<Limits<Scheme::kLevel, kOpen, Scalar>> limits;
    static_cast<void>(complaint([&] { limits.emplace(arm.limits(), options.dt); }));
    if (!limits) continue;
    const auto& bounds = limits->bounds();
    const Vector<kOpen> share = random.uniform(arm.dof(), 0.05, 0.95);
    const State<kOpen, Scalar> start{bounds.lower + share.cast<Scalar>().cwiseProduct(bounds.upper - bounds.lower),
                                     Joints::Zero(arm.dof())};
    CompiledTracker tracker(arm, Position<3>{}, scheme, start, options, *limits);
    Target reference = Target::hold(tracker.tip());
    for (int tick = 0; tick < 600; ++tick) {
      if (tick % 100 == 0) {
        const double size = spread(random, 0.01, 3.0);
        const Vector<3> displacement = random.uniform(3, -size, size);
        const Vector<3> wild = random.uniform(3, -10.0, 10.0);
        reference.x = tracker.tip() + displacement.cast<Scalar>();
        reference.xdd = wild.cast<Scalar>();
      }
      tracker.tick(reference);
      ASSERT_EQ(complaint([&] { limits->require_viable(tracker.state(), tracker.acceleration()); }), "") << tick;
    }
    ASSERT_EQ(complaint([&] {
                CompiledTracker(arm, Position<3>{}, scheme, tracker.state(), options, *limits, tracker.acceleration());
              }),
              "");
    ++made;
  }
  EXPECT_GE(made, motions * 3 / 4);
}

TEST(SlowJoints, let_a_tracker_start_from_the_state_of_another) {
  const Vector<kOpen> ones = Vector<kOpen>::Ones(7);
  const auto z = NullSpace<kOpen>{}.with_damping(2.0);
  expect_to_be_made_again<double>(FPBM<kOpen>(0.6, ones, 10.0, 25.0, z), trials(150));
  expect_to_be_made_again<double>(WMVN<kOpen>(ones, 5.0), trials(150));
  const auto single = NullSpace<kOpen, float>{}.with_damping(2.0F);
  expect_to_be_made_again<float>(
      FPBM<kOpen, float>(0.6F, Vector<kOpen, float>(ones.cast<float>()), 10.0F, 25.0F, single), trials(150));
}

}  // namespace
}  // namespace fpbm::test::slow_joints_laws
