#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "support/arms.hpp"
#include "support/compiled_tracker.hpp"

/// Bounds hold for numbers of any size. Bounds on acceleration or velocity far above the largest change per tick, for
/// example DBL_MAX, are treated as unbounded.
namespace fpbm::test::limits_extremes_laws {
namespace {

template <typename Scalar>
constexpr Scalar kEpsilon = std::numeric_limits<Scalar>::epsilon();

[[nodiscard]] double power_of_ten(Random& random, double low, double high) {
  return std::pow(10.0, random.uniform(low, high));
}

/// Any positive number: of ordinary size (1), of another size, the largest number, or infinity if permitted.
template <typename Scalar>
[[nodiscard]] Scalar any_size(Random& random, Scalar ordinary, bool infinite) {
  const double kind = random.uniform(0.0, 1.0);
  if (kind < 0.3) return ordinary;
  if (kind < 0.4) return std::numeric_limits<Scalar>::max();
  if (kind < 0.5 && infinite) return JointBounds<Scalar>::kNone;
  const double most = std::numeric_limits<Scalar>::max_exponent10 - std::max(0.0, std::log10(double{ordinary}));
  return ordinary * static_cast<Scalar>(power_of_ten(random, 0.0, most - 1.0));
}

/// Bounds on one joint, of any unit, near zero or far from zero.
template <Level kLevel, typename Scalar>
[[nodiscard]] JointLimits<1, Scalar> any_bounds(Random& random) {
  const double unit = power_of_ten(random, -3.0, random.uniform(0.0, 1.0) < 0.5 ? 3.0 : 9.0);
  const double middle = unit * random.uniform(-3.0, 3.0);
  const double reach = unit * random.uniform(0.1, 3.0);
  const auto velocity = static_cast<Scalar>(unit * random.uniform(0.1, 10.0));
  const auto acceleration = static_cast<Scalar>(unit * random.uniform(1.0, 100.0));
  auto bounds = JointLimits<1, Scalar>::none(1);
  bounds.set(0, {static_cast<Scalar>(middle - reach), static_cast<Scalar>(middle + reach),
                 any_size(random, velocity, true), any_size(random, acceleration, kLevel == Level::kVelocity)});
  return bounds;
}

[[nodiscard]] double any_tick(Random& random) {
  return random.uniform(0.0, 1.0) < 0.8 ? power_of_ten(random, -4.0, -2.0) : power_of_ten(random, -2.0, 6.0);
}

template <Level kLevel, typename Scalar>
[[nodiscard]] State<1, Scalar> after(const State<1, Scalar>& state, Scalar u, Scalar tick) {
  State<1, Scalar> next = state;
  if constexpr (kLevel == Level::kAcceleration) {
    next.q(0) += tick * (state.qd(0) + tick / Scalar(2) * u);
    next.qd(0) += tick * u;
  } else {
    next.q(0) += tick * u;
    next.qd(0) = u;
  }
  return next;
}

/// Position of the turning point in a tick of constant acceleration. Without a turning point, the position at the end.
template <typename Scalar>
[[nodiscard]] Scalar turning_point(const State<1, Scalar>& from, const State<1, Scalar>& to, Scalar tick) {
  const Scalar before = from.qd(0);
  const Scalar change = to.qd(0) - before;
  if (!(before * to.qd(0) < Scalar(0))) return to.q(0);
  return from.q(0) - before / change * before * tick / Scalar(2);
}

template <Level kLevel, typename Scalar>
void expect_bounds_to_hold() {
  for (std::uint32_t seed = 0; seed < static_cast<std::uint32_t>(trials(3000)); ++seed) {
    Random random(seed);
    const auto bounds = any_bounds<kLevel, Scalar>(random);
    const auto tick = static_cast<Scalar>(any_tick(random));
    SCOPED_TRACE(::testing::Message() << "seed " << seed << ", velocity " << bounds.velocity << ", acceleration "
                                      << bounds.acceleration << ", tick " << tick);
    const Limits<kLevel, 1, Scalar> limits(bounds, tick);
    const Scalar size = std::abs(bounds.lower(0)) + std::abs(bounds.upper(0));
    const Scalar slack = Scalar(100) * kEpsilon<Scalar> * size;
    for (const int drive : {-1, 0, 1}) {
      State<1, Scalar> state{(bounds.lower + bounds.upper) / Scalar(2), Vector<1, Scalar>(Scalar(0))};
      for (int i = 0; i < 60; ++i) {
        const auto box = limits.box(state);
        ASSERT_TRUE(std::isfinite(box.lower(0)) && std::isfinite(box.upper(0)));
        ASSERT_LE(box.lower(0), box.upper(0));
        const auto share = static_cast<Scalar>(drive == 0 ? random.uniform(0.0, 1.0) : (drive + 1) / 2);
        const Scalar u = (Scalar(1) - share) * box.lower(0) + share * box.upper(0);
        const State<1, Scalar> next = after<kLevel>(state, u, tick);
        ASSERT_LE(std::abs(next.qd(0)), bounds.velocity(0) * (Scalar(1) + Scalar(4) * kEpsilon<Scalar>));
        for (const Scalar q : {next.q(0), turning_point(state, next, tick)}) {
          ASSERT_LE(q, bounds.upper(0) + slack) << "tick " << i;
          ASSERT_GE(q, bounds.lower(0) - slack) << "tick " << i;
        }
        state = next;
      }
    }
  }
}
TEST(LimitsOfAnySize, hold_at_and_between_ticks) {
  expect_bounds_to_hold<Level::kAcceleration, double>();
  expect_bounds_to_hold<Level::kVelocity, double>();
  expect_bounds_to_hold<Level::kAcceleration, float>();
  expect_bounds_to_hold<Level::kVelocity, float>();
}

/// A larger bound on the acceleration admits all motions of the smaller bound, in every state that was viable.
template <Level kLevel, typename Scalar>
void expect_more_to_allow_more() {
  for (std::uint32_t seed = 0; seed < static_cast<std::uint32_t>(trials(3000)); ++seed) {
    Random random(seed);
    auto bounds = any_bounds<kLevel, Scalar>(random);
    const auto tick = static_cast<Scalar>(any_tick(random));
    if (!std::isfinite(bounds.acceleration(0))) continue;
    const Limits<kLevel, 1, Scalar> limits(bounds, tick);
    const auto times = static_cast<Scalar>(power_of_ten(random, 0.0, 30.0));
    bounds.acceleration(0) = std::min(times * bounds.acceleration(0), std::numeric_limits<Scalar>::max());
    const Limits<kLevel, 1, Scalar> wider(bounds, tick);
    State<1, Scalar> state{(bounds.lower + bounds.upper) / Scalar(2), Vector<1, Scalar>(Scalar(0))};
    for (int i = 0; i < 60; ++i) {
      const auto box = limits.box(state);
      const auto more = wider.box(state);
      Scalar slack = (std::abs(bounds.lower(0)) + std::abs(bounds.upper(0))) / tick + std::abs(state.qd(0));
      if constexpr (kLevel == Level::kAcceleration) slack /= tick;
      slack = Scalar(100) * kEpsilon<Scalar> * (slack + std::abs(box.upper(0)) + std::abs(box.lower(0)));
      ASSERT_LE(box.upper(0), more.upper(0) + slack) << "seed " << seed << ", tick " << i;
      ASSERT_GE(box.lower(0), more.lower(0) - slack) << "seed " << seed << ", tick " << i;
      const auto share = static_cast<Scalar>(random.uniform(0.0, 1.0));
      state = after<kLevel>(state, (Scalar(1) - share) * box.lower(0) + share * box.upper(0), tick);
    }
  }
}
TEST(LimitsOfAnySize, allow_more_with_a_higher_acceleration_bound) {
  expect_more_to_allow_more<Level::kAcceleration, double>();
  expect_more_to_allow_more<Level::kVelocity, double>();
  expect_more_to_allow_more<Level::kAcceleration, float>();
  expect_more_to_allow_more<Level::kVelocity, float>();
}

/// An arm moves and keeps its bounds if the joints have only bounds on position. An unreachable target presses the arm
/// against its bounds.
template <typename Scalar, typename Scheme>
void expect_arm_to_keep_positions(const Scheme& scheme, Scalar velocity, Scalar acceleration) {
  SCOPED_TRACE(::testing::Message() << "velocity " << velocity << ", acceleration " << acceleration);
  auto bounds = JointLimits<4, Scalar>::none(4);
  for (Eigen::Index i = 0; i < 4; ++i) bounds.set(i, {Scalar(-1), Scalar(1), velocity, acceleration});
  const PlanarArm<4, Scalar> arm(Vector<4, Scalar>::Ones());
  TrackerOptions<Scalar> options;
  options.dt = Scalar(1e-3);
  const Limits<Scheme::kLevel, 4, Scalar> limits(bounds, options.dt);
  const State<4, Scalar> start{Vector<4, Scalar>(Scalar(0.3), Scalar(0.4), Scalar(0.5), Scalar(0.6)),
                               Vector<4, Scalar>::Zero()};
  CompiledTracker tracker(arm, Position<2>{}, scheme, start, options, limits);
  const Vector<2, Scalar> within = tracker.tip() + Vector<2, Scalar>(Scalar(0.3), Scalar(0.2));
  for (const Vector<2, Scalar>& target : {Vector<2, Scalar>(Scalar(-1), Scalar(0.2)), within}) {
    const auto reference = Reference<Position<2>, Scalar>::hold(target);
    for (int i = 0; i < trials(5000); ++i) {
      const auto tick = tracker.tick(reference);
      ASSERT_LE(tick.q.cwiseAbs().maxCoeff(), Scalar(1) + Scalar(10) * kEpsilon<Scalar>) << i;
    }
  }
  for (int i = 0; i < 5000; ++i) (void)tracker.tick(Reference<Position<2>, Scalar>::hold(within));
  EXPECT_LE((tracker.tip() - within).norm(), 1e-3);
}

template <typename Scalar>
void expect_arms_to_keep_positions() {
  constexpr Scalar kMost = std::numeric_limits<Scalar>::max();
  const auto z = NullSpace<4, Scalar>().with_damping(Scalar(2));
  const Vector<4, Scalar> ones = Vector<4, Scalar>::Ones();
  const auto fpbm = FPBM<4, Scalar>(Scalar(0.6), ones, Scalar(10), Scalar(25), z);
  const auto mvn = WMVN<4, Scalar>(ones, Scalar(5));
  for (const Scalar huge : {Scalar(1e6), Scalar(1e12), Scalar(1e23), std::sqrt(kMost), kMost / Scalar(1e3), kMost}) {
    expect_arm_to_keep_positions(fpbm, Scalar(2), huge);
    expect_arm_to_keep_positions(fpbm, huge, huge);
    expect_arm_to_keep_positions(mvn, Scalar(2), huge);
    expect_arm_to_keep_positions(mvn, huge, JointBounds<Scalar>::kNone);
  }
}
TEST(LimitsOfAnySize, hold_on_an_arm) {
  expect_arms_to_keep_positions<double>();
  expect_arms_to_keep_positions<float>();
}

}  // namespace
}  // namespace fpbm::test::limits_extremes_laws
