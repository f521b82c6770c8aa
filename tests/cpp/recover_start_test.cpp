#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "support/arms.hpp"
#include "support/compiled_tracker.hpp"

/// With recover_start, a tracker starts outside the joints' ranges or too fast. The joints return within the bounds on
/// velocity, acceleration and jerk. Afterwards, all bounds hold.
namespace fpbm::test::recover_start_laws {
namespace {

constexpr int N = Eigen::Dynamic;

[[nodiscard]] int motions() {
  const char* given = std::getenv("FPBM_MOTIONS");
  return given != nullptr ? std::atoi(given) : trials(10);
}

/// Presets with the bounds that their data sheets do not have.
[[nodiscard]] Chain<> bounded(Chain<> chain, double jerk) {
  for (auto& joint : chain.joints) {
    if (!std::isfinite(joint.bounds.acceleration)) joint.bounds.acceleration = 10.0;
    joint.bounds.jerk = jerk;
    joint.bounds.velocity_offset = 0.0;
    joint.bounds.deceleration = JointBounds<>::kNone;
  }
  return chain;
}

template <Level kLevel>
[[nodiscard]] auto scheme_of(Eigen::Index dof) {
  const Vector<N> W = Vector<N>::Ones(dof);
  if constexpr (kLevel == Level::kAcceleration) {
    return FPBM<N>(0.6, W, 10.0, 25.0, NullSpace<N>().with_damping(2.0));
  } else {
    return WMVN<N>(W, 5.0);
  }
}

struct Excess {
  double velocity = 0.0;
  double acceleration = 0.0;
  double jerk = 0.0;
  double range = 0.0;    ///< After the return.
  double outward = 0.0;  ///< Outward velocity of a joint beyond its range.
  long not_back = 0;
};

/// A motion of 4 s from a start with several joints outside.
template <Level kLevel, typename Space>
void check(const Chain<>& chain, double tick, std::uint32_t seed, bool moving, Excess& most) {
  Random random(seed);
  const auto arm = any_arm(chain);
  const JointLimits<N>& bounds = arm.limits();
  const Eigen::Index dof = arm.dof();
  State<N> start{Vector<N>::Zero(dof), Vector<N>::Zero(dof)};
  for (Eigen::Index i = 0; i < dof; ++i) {
    const double low = std::max(bounds.lower(i), -3.0);
    const double high = std::min(bounds.upper(i), 3.0);
    start.q(i) = random.uniform(0.8 * low + 0.2 * high, 0.2 * low + 0.8 * high);
    const double choice = random.uniform(0.0, 1.0);
    if (choice < 0.25 && std::isfinite(bounds.lower(i))) start.q(i) = bounds.lower(i) - random.uniform(0.0, 0.3);
    if (choice > 0.75 && std::isfinite(bounds.upper(i))) start.q(i) = bounds.upper(i) + random.uniform(0.0, 0.3);
    if (moving) start.qd(i) = random.uniform(-1.3, 1.3) * bounds.velocity(i);
  }
  TrackerOptions<> options;
  options.dt = tick;
  options.recover_start = true;
  const Limits<kLevel, N> limits(bounds, tick);
  CompiledTracker tracker(arm, Space{}, scheme_of<kLevel>(dof), start, options, limits);
  auto target = tracker.tip();
  const Vector<3> step{random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2)};
  if constexpr (std::is_same_v<Space, Pose>) {
    target.p += step;
  } else {
    target += step;
  }
  std::vector<bool> back(static_cast<std::size_t>(dof), false);
  std::vector<bool> slow(static_cast<std::size_t>(dof), false);
  Vector<N> last = Vector<N>::Zero(dof);
  State<N> before = start;
  const int ticks = static_cast<int>(4.0 / tick);
  for (int k = 0; k < ticks; ++k) {
    if (k == ticks * 3 / 4) tracker.stop();
    (void)tracker.tick(Reference<Space>::hold(target));
    const State<N>& state = tracker.state();
    const Vector<N> u = (state.qd - before.qd) / tick;
    for (Eigen::Index i = 0; i < dof; ++i) {
      const auto joint = static_cast<std::size_t>(i);
      most.acceleration = std::max(most.acceleration, std::abs(u(i)) / limits.bounds().acceleration(i) - 1.0);
      if (std::isfinite(limits.bounds().jerk(i))) {
        most.jerk = std::max(most.jerk, std::abs(u(i) - last(i)) / (tick * limits.bounds().jerk(i)) - 1.0);
      }
      // A start above the bound on velocity slows down.
      const double fast = std::abs(state.qd(i)) / bounds.velocity(i) - 1.0;
      slow[joint] = slow[joint] || fast <= 1e-9;
      if (slow[joint] && !moving) most.velocity = std::max(most.velocity, fast);
      const double beyond = std::max(state.q(i) - bounds.upper(i), bounds.lower(i) - state.q(i));
      back[joint] = back[joint] || beyond <= 1e-9;
      if (back[joint] && !moving) most.range = std::max(most.range, beyond);
      if (!moving && beyond > 1e-9) {
        const double outward = state.q(i) > bounds.upper(i) ? state.qd(i) : -state.qd(i);
        most.outward = std::max(most.outward, outward);
      }
      if (k == ticks - 1 && beyond > 1e-9) ++most.not_back;
    }
    last = u;
    before = state;
  }
  tracker.require_viable(limits);
}

template <Level kLevel>
void joints_return() {
  const std::vector<std::pair<std::string, Chain<>>> arms = {{"Panda", presets::panda()},
                                                             {"UR5e", presets::ur5e()},
                                                             {"Gen3", presets::gen3()},
                                                             {"iiwa", presets::iiwa14()},
                                                             {"rail", panda_on_rail()}};
  for (const auto& [name, chain] : arms) {
    for (const double jerk : {JointBounds<>::kNone, 500.0}) {
      for (const double tick : {1e-3, 4e-3, 2e-2}) {
        for (const bool moving : {false, true}) {
          SCOPED_TRACE(name + (jerk < 1e9 ? ", bounded jerk" : "") + ", tick " + std::to_string(tick) +
                       (moving ? ", moving" : ""));
          Excess most;
          const int count = std::max(1, motions() * (tick > 5e-3 ? 2 : 1) / 5);
          for (int i = 0; i < count; ++i) {
            const auto seed = static_cast<std::uint32_t>(i);
            if (i % 2 == 0) {
              check<kLevel, Position<3>>(bounded(chain, jerk), tick, seed, moving, most);
            } else {
              check<kLevel, Pose>(bounded(chain, jerk), tick, seed, moving, most);
            }
          }
          EXPECT_LE(most.acceleration, 1e-9);
          EXPECT_LE(most.jerk, 1e-6);
          EXPECT_LE(most.velocity, 1e-9);
          EXPECT_LE(most.range, 1e-9);
          EXPECT_LE(most.outward, 1e-9);
          EXPECT_EQ(most.not_back, 0);
        }
      }
    }
  }
}

TEST(RecoverStart, brings_joints_back_at_acceleration_level) {
  joints_return<Level::kAcceleration>();
}
TEST(RecoverStart, brings_joints_back_at_velocity_level) {
  joints_return<Level::kVelocity>();
}

/// Largest error of a tip that is held while a joint of the Panda returns.
template <Level kLevel>
[[nodiscard]] double held_error(Eigen::Index joint, double sign, double jerk, double tick) {
  const auto arm = any_arm(bounded(presets::panda(), jerk));
  State<N> start{Vector<7>{0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785}, Vector<N>::Zero(7)};
  start.q(joint) = sign > 0.0 ? arm.limits().upper(joint) + 0.1 : arm.limits().lower(joint) - 0.1;
  TrackerOptions<> options;
  options.dt = tick;
  options.recover_start = true;
  CompiledTracker tracker(arm, Position<3>{}, scheme_of<kLevel>(7), start, options);
  const auto hold = Reference<Position<3>>::hold(tracker.tip());
  double error = 0.0;
  for (int k = 0; k < 1.5 / tick; ++k) {
    const auto result = tracker.tick(hold);
    EXPECT_EQ(result.scale, 1.0);
    error = std::max(error, result.error.norm());
  }
  return error;
}

/// The other joints compensate for the return: joints 3, 5 and 6 of the Panda have enough null-space motion.
TEST(RecoverStart, does_not_move_a_tip_that_other_joints_can_hold) {
  for (const double jerk : {JointBounds<>::kNone, 500.0}) {
    for (const double tick : {1e-3, 2e-2}) {
      SCOPED_TRACE("jerk " + std::to_string(jerk) + ", tick " + std::to_string(tick));
      for (const auto& [joint, sign] : {std::pair{2, 1.0}, {4, 1.0}, {4, -1.0}, {5, 1.0}, {5, -1.0}}) {
        EXPECT_LE(held_error<Level::kAcceleration>(joint, sign, jerk, tick), 0.1 * tick) << "joint " << joint;
        EXPECT_LE(held_error<Level::kVelocity>(joint, sign, jerk, tick), 0.1 * tick) << "joint " << joint;
      }
    }
  }
}

/// A start within the limits moves as without the option.
TEST(RecoverStart, has_no_effect_within_the_limits) {
  const auto last = [](bool recover) {
    TrackerOptions<> options;
    options.recover_start = recover;
    const Vector<N> q0 = Vector<7>{0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785};
    CompiledTracker tracker(any_arm(presets::panda()), Pose{}, scheme_of<Level::kAcceleration>(7), q0, options);
    auto target = tracker.tip();
    target.p(0) += 2.0;  // Unreachable.
    for (int i = 0; i < 5000; ++i) (void)tracker.tick(Reference<Pose>::hold(target));
    return tracker.state().q;
  };
  EXPECT_EQ(last(true), last(false));
}

template <typename Make>
[[nodiscard]] std::string message_of(const Make& make) {
  try {
    make();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(RecoverStart, is_named_by_the_error_without_the_option) {
  Vector<N> q0 = Vector<7>{0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785};
  const auto start = [&] {
    CompiledTracker(any_arm(presets::panda()), Pose{}, scheme_of<Level::kAcceleration>(7), q0);
  };
  q0(1) = -1.9;
  std::string text = message_of(start);
  EXPECT_NE(text.find("q0[1] = -1.9: must be within the joint's range, from"), std::string::npos) << text;
  EXPECT_NE(text.find("recover_start"), std::string::npos) << text;
  EXPECT_EQ(text.find("degrees"), std::string::npos) << text;
  q0(1) = -30.0;
  text = message_of(start);
  EXPECT_NE(text.find("looks like degrees"), std::string::npos) << text;
}

}  // namespace
}  // namespace fpbm::test::recover_start_laws
