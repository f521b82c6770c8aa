#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "fpbm/limits/detail/stop_plan.hpp"
#include "support/arms.hpp"

/// Stopping trajectories that are known to their end.
namespace fpbm::test::stop_plan_laws {
namespace {

constexpr double kTick = 1e-3;

/// The shares add up to the whole velocity, the displacement equals the sum over the ticks, and the steps keep the
/// bounds on deceleration and jerk.
TEST(StopProfile, keeps_its_bounds_and_covers_its_stopping_distance) {
  Random random(1);
  for (int trial = 0; trial < trials(3000); ++trial) {
    const double acceleration = std::pow(10.0, random.uniform(-1.0, 1.5));
    const double jerk = trial % 3 == 0 ? std::numeric_limits<double>::infinity()
                                       : acceleration * std::pow(10.0, random.uniform(0.5, 3.5));
    const double velocity = std::pow(10.0, random.uniform(-4.0, 0.5));
    auto profile = StopProfile<double>::quickest(velocity, acceleration, jerk, kTick);
    profile.wait = trial % 7;
    const double other = std::pow(10.0, random.uniform(-4.0, 0.5));
    if (trial % 2 == 0) profile = profile.together(StopProfile<double>::quickest(other, acceleration, jerk, kTick));
    double v = velocity;
    double distance = 0.0;
    double before = 0.0;
    for (int k = 0; k < static_cast<int>(profile.ticks()) + 3; ++k) {
      const double b = profile.removed_fraction(k) * velocity / kTick;
      ASSERT_LE(b, acceleration * (1.0 + 1e-12));
      ASSERT_LE(std::abs(b - before), jerk * kTick * (1.0 + 1e-12)) << trial;
      distance += kTick * (v - kTick * b / 2.0);
      v -= kTick * b;
      before = b;
    }
    EXPECT_NEAR(v, 0.0, 1e-13 * velocity * profile.ticks());
    EXPECT_NEAR(distance, kTick * velocity * profile.coasting_ticks(Level::kAcceleration), 1e-12 * distance);
  }
}

struct Worst {
  double bounds = 0.0;        ///< Relative excess over the bounds of a joint.
  double envelope = 0.0;      ///< Excess of a velocity over a manufacturer's envelope [rad/s].
  double displacement = 0.0;  ///< Distance of a posture beyond the displacements of StopDisplacement [rad].
  double opening =
      0.0;  ///< Largest decrease along a direction that start_velocity and −ramp_correction increase [rad].
};

/// Smallest coordinate along g of the displacements s · line + t · ramp_correction + r, with s and t in [0, 1] and r in
/// [low, high], minus the coordinate of the displacement `place`. Positive if `place` is outside.
[[nodiscard]] double beyond(const StopDisplacement<Eigen::Dynamic>& displacement, const Eigen::VectorXd& g,
                            const Eigen::VectorXd& place) {
  const double least = std::min(g.dot(displacement.line), 0.0) + std::min(g.dot(displacement.ramp_correction), 0.0) +
                       g.cwiseProduct(displacement.low).cwiseMin(g.cwiseProduct(displacement.high)).sum();
  return least - g.dot(place);
}

/// Decrease along g of the displacement `place`, except the decrease by joints that follow their own shortest stop. If
/// g increases along start_velocity and −ramp_correction, the displacement must not decrease.
[[nodiscard]] double decrease(const StopDisplacement<Eigen::Dynamic>& displacement, const Eigen::VectorXd& g,
                              const Eigen::VectorXd& place) {
  if (g.dot(displacement.start_velocity) < 0.0 || g.dot(displacement.ramp_correction) > 0.0) return 0.0;
  return g.cwiseProduct(displacement.low).cwiseMin(g.cwiseProduct(displacement.high)).sum() - g.dot(place);
}

/// Moves an arm from rest at random within its limits, and sometimes follows the plan to rest.
template <Level kLevel>
void stop_at_random(const Chain<>& chain, std::uint32_t seed, double h, Worst& worst) {
  using Joints = Vector<Eigen::Dynamic>;
  Random random(seed);
  const auto arm = any_arm(chain);
  const Limits<kLevel, Eigen::Dynamic> limits(arm.limits(), h);
  const auto& bounds = limits.bounds();
  const auto n = arm.dof();
  State<Eigen::Dynamic> state{Joints::Zero(n), Joints::Zero(n)};
  for (Eigen::Index i = 0; i < n; ++i) {
    state.q(i) = bounds.lower(i) + random.uniform(0.02, 0.98) * (bounds.upper(i) - bounds.lower(i));
  }
  Joints last = Joints::Zero(n);
  Joints aim = random.uniform(n, -1.0, 1.0);
  const auto step = [&](const Joints& qdd) {
    const Joints before = state.qd;
    state.qd += h * qdd;
    state.q += h * (kLevel == Level::kVelocity ? state.qd : Joints((before + state.qd) / 2.0));
    for (Eigen::Index i = 0; i < n; ++i) {
      const double range = bounds.upper(i) - bounds.lower(i);
      worst.bounds =
          std::max({worst.bounds, (state.q(i) - bounds.upper(i)) / range, (bounds.lower(i) - state.q(i)) / range,
                    std::abs(state.qd(i)) / bounds.velocity(i) - 1.0, std::abs(qdd(i)) / bounds.acceleration(i) - 1.0});
      if (std::isfinite(bounds.deceleration(i))) {  // A manufacturer's envelope, in velocities.
        const double from_end = std::min(bounds.upper(i) - state.q(i), state.q(i) - bounds.lower(i));
        const double c = bounds.velocity_offset(i);
        const bool outward =
            from_end == (state.qd(i) > 0.0 ? bounds.upper(i) - state.q(i) : state.q(i) - bounds.lower(i));
        const double most = -c + std::sqrt(c * c + 2.0 * bounds.deceleration(i) * std::max(from_end, 0.0));
        if (outward) worst.envelope = std::max(worst.envelope, std::abs(state.qd(i)) - most);
      }
      if (std::isfinite(bounds.jerk(i))) {
        worst.bounds = std::max(worst.bounds, std::abs(qdd(i) - last(i)) / (h * bounds.jerk(i)) - 1.0);
      }
    }
    last = qdd;
  };
  for (int tick = 0; tick < (h > kTick ? 300 : 1500); ++tick) {
    if (tick % 150 == 0) aim = random.uniform(n, -1.0, 1.0);
    const auto box = limits.box(state, last);
    Joints u = aim.cwiseProduct(bounds.acceleration);
    if (kLevel == Level::kVelocity) u = state.qd + h * u;
    u = box.nearest(u);
    const State<Eigen::Dynamic> from = state;
    step(kLevel == Level::kVelocity ? Joints((u - state.qd) / h) : u);
    if (tick % 37 != 0) continue;
    const State<Eigen::Dynamic> moving = state;
    const Joints moving_last = last;
    StopPlan<kLevel, Eigen::Dynamic> plan(limits, state, last);
    const auto displacement = plan.displacement(limits, from, state);
    const Joints directions[3] = {random.uniform(n, -1.0, 1.0), random.uniform(n, -1.0, 1.0),
                                  Joints::Unit(n, tick % n)};
    int ticks = 0;
    for (; ticks < 20000 && !(state.qd.isZero(1e-12) && last.isZero(1e-8)); ++ticks) {
      for (const Joints& g : directions) {
        worst.displacement = std::max(worst.displacement, beyond(displacement, g, state.q - from.q));
        worst.opening = std::max(worst.opening, decrease(displacement, g, state.q - from.q));
      }
      step(plan.next(limits, state, last));
    }
    ASSERT_LT(ticks, 20000) << "seed " << seed;
    state = moving;
    last = moving_last;
  }
}

template <Level kLevel>
void expect_stops_to_keep_bounds(double tick) {
  std::vector<Chain<>> chains = {presets::panda(), panda_without_jerk(), presets::fr3(), presets::ur5e(),
                                 presets::panda()};
  for (auto& joint : chains.back().joints) joint.bounds.jerk = 20.0 * joint.bounds.acceleration;
  for (std::size_t k = 0; k < chains.size(); ++k) {
    SCOPED_TRACE(k);
    Worst worst;
    for (std::uint32_t seed = 0; seed < static_cast<std::uint32_t>(trials(15)); ++seed) {
      stop_at_random<kLevel>(chains[k], seed, tick, worst);
    }
    EXPECT_LE(worst.bounds, 1e-9);
    EXPECT_LE(worst.envelope, 1e-9);
    EXPECT_LE(worst.displacement, 1e-12);
    EXPECT_LE(worst.opening, 1e-12);
  }
}

TEST(StopPlan, keeps_all_bounds_and_stays_within_its_displacement_bounds) {
  for (const double tick : {1e-3, 4e-3, 2e-2}) {
    SCOPED_TRACE(tick);
    expect_stops_to_keep_bounds<Level::kAcceleration>(tick);
    expect_stops_to_keep_bounds<Level::kVelocity>(tick);
  }
}

}  // namespace
}  // namespace fpbm::test::stop_plan_laws
