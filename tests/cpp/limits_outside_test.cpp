#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "support/arms.hpp"
#include "support/compiled_tracker.hpp"

/// If a measured state is beyond a bound, the joint returns as fast as its bounds on velocity and acceleration admit,
/// and stops on the bound or continues inside. The other joints continue the task.
namespace fpbm::test::limits_outside_laws {
namespace {

constexpr double kTick = 1e-3;

/// Shortest time in which a joint returns to its bound from a distance y beyond, with a velocity `away` from the bound.
/// The joint stops, accelerates toward the bound, cruises and brakes. Then the joint stops on the bound, or passes
/// the bound if it cannot stop in time.
[[nodiscard]] double least_time(double y, double away, double velocity, double acceleration) {
  double time = 0.0;
  if (away > 0.0) {
    time = away / acceleration;
    y += away * time / 2.0;
  }
  const double speed = std::clamp(-away, 0.0, velocity);
  const double stops = speed * speed / 2.0;
  if (stops >= acceleration * y) return time + (speed - std::sqrt(2.0 * (stops - acceleration * y))) / acceleration;
  const double peak = std::sqrt(acceleration * y + stops);
  if (peak <= velocity) return time + (2.0 * peak - speed) / acceleration;
  const double cruise = y - (velocity * velocity - stops) / acceleration;
  return time + (2.0 * velocity - speed) / acceleration + cruise / velocity;
}

[[nodiscard]] auto holding_scheme(const Vector<7>& rest) {
  constexpr int N = Eigen::Dynamic;
  const auto z = NullSpace<N>().with_damping(4.0).with_rest_posture(rest, 4.0);
  return FPBM<N>(0.6, Vector<N>(Vector<7>::Ones()), 10.0, 25.0, z);
}

const Vector<7> kReady{0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785};

void advance(State<7>& state, const Vector<7>& qdd) {
  state.q += kTick * (state.qd + kTick / 2.0 * qdd);
  state.qd += kTick * qdd;
}

TEST(Outside, joints_return_as_fast_as_bounds_allow) {
  const SerialArm<7> panda(panda_without_jerk());
  const JointLimits<7>& bounds = panda.limits();
  const auto scheme = holding_scheme(kReady);
  long outside = 0;
  long jumps = 0;
  double scale = 0.0;
  for (std::uint32_t seed = 0; seed < static_cast<std::uint32_t>(trials(3000)); ++seed) {
    Random random(seed);
    CompiledTracker tracker(any_arm(panda_without_jerk()), Position<3>{}, scheme, Vector<Eigen::Dynamic>(kReady));
    const auto hold = Reference<Position<3>>::hold(tracker.tip());
    State<7> state{kReady, Vector<7>::Zero()};
    const auto joint = static_cast<Eigen::Index>(seed % 7);
    const double direction = random.uniform(0.0, 1.0) < 0.5 ? 1.0 : -1.0;
    const double end = direction > 0.0 ? bounds.upper(joint) : bounds.lower(joint);
    state.q(joint) = end + direction * random.uniform(0.0, 0.3);
    state.qd(joint) = random.uniform(-3.0, 3.0);
    const double least = least_time(direction * (state.q(joint) - end), direction * state.qd(joint),
                                    bounds.velocity(joint), bounds.acceleration(joint));
    const int late = static_cast<int>((1.2 * least + 0.1) / kTick);
    double before = 0.0;
    for (int i = 0; i < late + 300; ++i) {
      const auto tick = tracker.resolve_measured(state.q, state.qd, hold);
      ASSERT_TRUE((tick.qdd.cwiseAbs().array() <= bounds.acceleration.array()).all()) << "seed " << seed;
      const bool fast = std::abs(state.qd(joint)) > bounds.velocity(joint);
      advance(state, tick.qdd);
      if (!fast) {
        ASSERT_TRUE((state.qd.cwiseAbs().array() <= bounds.velocity.array() + 1e-9).all()) << "seed " << seed;
      }
      const double beyond = direction * (state.q(joint) - end);
      if (beyond > 1e-6) {
        ASSERT_LT(i, late) << "seed " << seed << ": still " << beyond << " outside, after at best " << least << " s";
        scale += tick.scale;
        ++outside;
      } else {
        if (i >= late && std::abs(tick.qdd(joint) - before) > bounds.acceleration(joint) / 2.0) ++jumps;
      }
      before = tick.qdd(joint);
    }
  }
  // The task of the tip continues meanwhile, and no joint chatters afterwards.
  EXPECT_GE(scale / static_cast<double>(outside), 0.8);
  EXPECT_LE(jumps, trials(3000) / 10);
}

/// After stop(), a joint beyond its bound stops like the other joints, in the shortest time if measured states
/// are exact. The joint does not move to its bound.
TEST(Outside, joints_stop_on_request) {
  const SerialArm<7> panda(panda_without_jerk());
  const JointLimits<7>& bounds = panda.limits();
  for (const int delay : {0, 3}) {
    TrackerOptions<> options;
    options.measured_delay = delay;
    CompiledTracker tracker(any_arm(panda_without_jerk()), Position<3>{}, holding_scheme(kReady),
                            Vector<Eigen::Dynamic>(kReady), options);
    const auto hold = Reference<Position<3>>::hold(tracker.tip());
    tracker.stop();
    const double slow = delay == 0 ? kTick : 1.5 * 0.0243;  // D + D/2, D = 24.3 ms: docs/measured.md.
    for (std::uint32_t seed = 0; seed < 500; ++seed) {
      Random random(seed);
      const auto joint = static_cast<Eigen::Index>(seed % 7);
      const double direction = random.uniform(0.0, 1.0) < 0.5 ? 1.0 : -1.0;
      State<7> state{kReady, Vector<7>::Zero()};
      state.q(joint) =
          (direction > 0.0 ? bounds.upper(joint) : bounds.lower(joint)) + direction * random.uniform(0.1, 0.3);
      state.qd(joint) = random.uniform(-1.0, 1.0);
      const double speed = std::abs(state.qd(joint));
      const double start = state.q(joint);
      const double least = speed / bounds.acceleration(joint);
      while (std::abs(state.qd(joint)) > 1e-12) {
        const auto tick = tracker.resolve_measured(state.q, state.qd, hold);
        ASSERT_LE(std::abs(tick.qdd(joint)), bounds.acceleration(joint));
        advance(state, tick.qdd);
        ASSERT_LE(std::abs(state.q(joint) - start), speed * (least / 2.0 + slow)) << delay << ", seed " << seed;
      }
    }
  }
}

/// At a bound and slightly beyond it, the acceleration does not jump: it is continuous from inside to outside.
template <Level kLevel, typename Scalar>
void expect_no_kick() {
  for (std::uint32_t seed = 0; seed < 1000; ++seed) {
    Random random(seed);
    const auto unit = static_cast<Scalar>(std::pow(10.0, random.uniform(-3.0, 3.0)));
    const auto tick = static_cast<Scalar>(std::pow(10.0, random.uniform(-4.0, -2.0)));
    auto bounds = JointLimits<1, Scalar>::none(1);
    const auto any = [&](double low, double high) { return unit * static_cast<Scalar>(random.uniform(low, high)); };
    bounds.set(0, {any(-3.0, 0.0), any(1.0, 3.0), any(0.1, 10.0), any(1.0, 100.0)});
    const Limits<kLevel, 1, Scalar> limits(bounds, tick);
    const auto most = [&](Scalar q, Scalar qd) {
      return limits.box({Vector<1, Scalar>(q), Vector<1, Scalar>(qd)}).upper(0);
    };
    const Scalar end = bounds.upper(0);
    const Scalar hair = Scalar(2) * std::numeric_limits<Scalar>::epsilon() * end;
    const Scalar per_tick = kLevel == Level::kAcceleration ? tick * tick : tick;
    ASSERT_LE(std::abs(most(end + hair, Scalar(0))), Scalar(2) * hair / per_tick) << "seed " << seed;
    const Scalar qd = bounds.acceleration(0) * tick * static_cast<Scalar>(random.uniform(-3.0, 3.0));
    ASSERT_LE(std::abs(most(end + hair, qd) - most(end - hair, qd)), Scalar(4) * hair / per_tick) << "seed " << seed;
  }
}
TEST(Outside, no_acceleration_peak_occurs_at_a_bound) {
  expect_no_kick<Level::kAcceleration, double>();
  expect_no_kick<Level::kVelocity, double>();
  expect_no_kick<Level::kAcceleration, float>();
  expect_no_kick<Level::kVelocity, float>();
}

/// A joint that is pushed against its bound and measured with noise keeps its acceleration bound. The deviation from
/// the bound is at most ten times the noise.
TEST(Outside, noise_about_a_bound_keeps_the_acceleration_bound) {
  const SerialArm<7> panda(panda_without_jerk());
  const JointLimits<7>& bounds = panda.limits();
  for (Eigen::Index joint = 0; joint < 7; ++joint) {
    Vector<7> rest = kReady;
    rest(joint) = bounds.upper(joint) + 0.5;
    CompiledTracker tracker(any_arm(panda_without_jerk()), Position<3>{}, holding_scheme(rest),
                            Vector<Eigen::Dynamic>(kReady));
    State<7> state{kReady, Vector<7>::Zero()};
    state.q(joint) = bounds.upper(joint);
    Kinematics<Position<3>, 7> kinematics;
    panda.kinematics(state.q, kinematics);
    const auto hold = Reference<Position<3>>::hold(kinematics.tip);
    Random random(static_cast<std::uint32_t>(joint));
    for (int i = 0; i < 2000; ++i) {
      const Vector<7> noise = random.uniform(7, -1e-4, 1e-4);
      const auto tick = tracker.resolve_measured(state.q + noise, state.qd, hold);
      ASSERT_TRUE((tick.qdd.cwiseAbs().array() <= bounds.acceleration.array()).all());
      advance(state, tick.qdd);
      ASSERT_LE(state.q(joint) - bounds.upper(joint), 1e-3) << "joint " << joint << ", tick " << i;
      ASSERT_LE(std::abs(state.qd(joint)), 0.5) << "joint " << joint << ", tick " << i;
    }
  }
}

}  // namespace
}  // namespace fpbm::test::limits_outside_laws
