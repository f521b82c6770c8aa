#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <string>

#include "fpbm/realtime/stack_tracker.hpp"
#include "fpbm/task/axis_task.hpp"
#include "fpbm/task/position_task.hpp"
#include "fpbm/task/posture_task.hpp"
#include "support/random.hpp"

/// The motion J₁ u of the first level of a stack does not depend on the lower levels, also while limits are active. At
/// acceleration level, this holds for every tick. At velocity level, it holds for the limiter: one factor of a tick
/// slows all levels if the joints cannot follow the velocity field (followable_fraction()).
namespace fpbm::test::priority_laws {
namespace {

constexpr int X = Eigen::Dynamic;
constexpr double kTick = 1e-3;

/// Number of motions. FPBM_MOTIONS sets another number.
[[nodiscard]] int motions() {
  const char* number = std::getenv("FPBM_MOTIONS");
  return number != nullptr ? std::atoi(number) : trials(200);
}

struct Differences {
  int ticks = 0;
  int limited = 0;
  double motion = 0.0;  ///< Largest change of J₁ u by lower levels, relative to ‖J₁ A‖, A the bounds of the joints.
  double scale = 0.0;  ///< Largest change of the scale of the first level.
};

[[nodiscard]] Vector<X> start_posture(const std::string& name) {
  if (name == "ur5e") return Vector<6>(0.0, -1.57, 1.57, -1.57, -1.57, 0.0);
  if (name == "iiwa14") return Vector<7>(0.0, 0.5, 0.0, -1.4, 0.0, 1.0, 0.0);
  return Vector<7>(0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785);
}

/// A position, an axis and a posture on three levels, with targets that jump. In each tick, a copy of the tracker
/// without lower levels starts from the same state.
void compare(const Chain<>& chain, const std::string& name, double jerk, bool keeps_first_level, unsigned seed,
             Differences& found) {
  Random random(seed);
  const Robot<X> robot(chain);
  const int n = robot.dof();
  JointLimits<X> bounds = robot.limits();
  bounds.velocity *= 0.4;
  bounds.acceleration *= 0.3;
  bounds.deceleration *= 0.3;
  bounds.jerk = jerk * bounds.acceleration;
  const Limits<Level::kAcceleration, X> limits(bounds, kTick);
  const auto gains = [](double k) { return TaskGains<>(2.0 * k, k * k); };
  const Stack stack(PositionTask<>{{Robot<X>::kTip}, gains(5.0)}, AxisTask<>{{Robot<X>::kTip}, gains(5.0)},
                    PositionTask<>{{n - 2}, gains(4.0)});
  const auto scheme = Balanced<X>(0.6, UnitWeights{}, NullSpace<X>().with_damping(2.0));
  TrackerOptions<> options;
  options.keep_first_level = keeps_first_level;
  const Vector<X> q0 = start_posture(name);
  auto tracker = stack_tracker(robot, stack, scheme, State<X>{q0, Vector<X>::Zero(n)}, options, limits);
  const auto start = tracker.tip();
  using Space = typename decltype(stack)::Space;
  auto reference = Reference<Space>::hold(start);
  const double lead = TickFeedback<>(10.0, 25.0, kTick).lead;
  for (int i = 0; i < 150; ++i) {
    if (i == 0 || random.uniform(0.0, 1.0) < 0.01) {
      std::get<0>(reference.x) = std::get<0>(start) + Vector<3>(random.uniform(3, -0.5, 0.5));
      const Vector<3> axis = std::get<1>(start) + Vector<3>(random.uniform(3, -1.2, 1.2));
      std::get<1>(reference.x) = axis.normalized();
      std::get<2>(reference.x) = std::get<2>(start) + Vector<3>(random.uniform(3, -0.5, 0.5));
    }
    auto alone = tracker;
    alone.enable(1, false);
    alone.enable(2, false);
    const State<X> state = tracker.state();
    const Vector<X> last = tracker.acceleration();
    const auto expected = alone.tick(reference);
    const auto tick = tracker.tick(reference);
    // Rows of the first level in the middle of a tick that continues the acceleration of the last tick.
    Kinematics<Position<3>, X> middle;
    SerialArm<X>(chain).kinematics(state.q + kTick / 2 * state.qd + kTick * kTick / 8 * last,
                                   state.qd + kTick / 2 * last, middle);
    const Matrix<3, X> J = middle.J + lead * middle.Jd;
    const double relative = (J * (tick.qdd - expected.qdd)).norm() / (J * bounds.acceleration).norm();
    ++found.ticks;
    if (tick.scale < 1.0 || expected.scale < 1.0) ++found.limited;
    found.motion = std::max(found.motion, relative);
    found.scale = std::max(found.scale, std::abs(tick.scales[0] - expected.scales[0]));
  }
}

TEST(Priority, no_lower_level_changes_the_first) {
  const double infinite = std::numeric_limits<double>::infinity();
  Differences found;
  for (int k = 0; k < motions(); ++k) {
    const double jerk = std::array<double, 4>{infinite, 50.0, 300.0, 1000.0}[static_cast<std::size_t>(k % 4)];
    const bool keeps = k / 4 % 2 == 1;
    const auto seed = static_cast<unsigned>(k);
    switch (k / 8 % 3) {
      case 0: compare(presets::ur5e(), "ur5e", jerk, keeps, seed, found); break;
      case 1: compare(presets::panda(), "panda", jerk, keeps, seed, found); break;
      default: compare(presets::iiwa14(), "iiwa14", jerk, keeps, seed, found);
    }
  }
  std::printf("%d ticks, %d with limits on the first level: J1 u changes by %.1e of J1 A, its scale by %.1e\n",
              found.ticks, found.limited, found.motion, found.scale);
  EXPECT_GT(found.limited, found.ticks / 20);
  EXPECT_LT(found.motion, 1e-9);
  EXPECT_LT(found.scale, 1e-9);
}

/// Random levels of three, two and two rows in random states, with and without bounds on jerk and rows.
template <Level kLevel>
void expect_the_same_first_level() {
  const JointLimits<7> bounds = Robot<7>(presets::panda()).limits();
  const Limits<kLevel, 7> limits(bounds, kTick);
  Random random(7);
  double worst = 0.0;
  double scale = 0.0;
  int limited = 0;
  for (int trial = 0; trial < trials(2000); ++trial) {
    const Matrix<3, 7> first = random.uniform(3, 7, -1.0, 1.0);
    const Matrix<2, 7> second = random.uniform(2, 7, -1.0, 1.0);
    const Matrix<2, 7> third = random.uniform(2, 7, -1.0, 1.0);
    const Limiter<kLevel, 7> limiter(limits, trial % 4 == 3 ? 0.5 : 0.0);
    const Vector<7> q =
        bounds.lower + Vector<7>(random.uniform(7, 0.15, 0.85)).cwiseProduct(bounds.upper - bounds.lower);
    const State<7> state{q, Vector<7>(0.05 * random.uniform(7, -1.0, 1.0))};
    const Vector<7> last = Vector<7>(random.uniform(7, -0.5, 0.5)).cwiseProduct(bounds.acceleration);
    const double tick = kLevel == Level::kVelocity ? kTick : 1.0;
    const auto motion = [&] {
      return Vector<7>(tick * random.uniform(0.1, 2.0) *
                       bounds.acceleration.cwiseProduct(Vector<7>(random.uniform(7, -1.0, 1.0))));
    };
    const Vector<7> own = motion();
    TaskLevels<7, double, Matrix<3, 7>, Matrix<2, 7>, Matrix<2, 7>> levels(first, second, third);
    levels.set_first_motion(own);
    const Vector<7> desired = own + null_space_motion(only_first(levels), motion());
    Rows<7, 2> rows{random.uniform(7, 2, -1.0, 1.0), {}, trial % 3};
    for (int k = 0; k < 2; ++k)
      rows.b(k) = random.uniform(0.1, 1.0) * std::abs(rows.g.col(k).dot(desired)) + 0.1 * tick;
    const auto all = limiter.motion(levels, state, desired, last, rows);
    const auto alone = limiter.motion(only_first(levels), state, own, last, rows);
    worst = std::max(worst, (first * (all.u - alone.u)).norm() / (first * (tick * bounds.acceleration)).norm());
    scale = std::max(scale, std::abs(all.scales[0] - alone.scales[0]));
    limited += alone.scale < 1.0 ? 1 : 0;
  }
  std::printf("J1 u changes by %.1e of J1 A, its scale by %.1e; %d limited\n", worst, scale, limited);
  EXPECT_LT(worst, 1e-9);
  EXPECT_LT(scale, 1e-9);
  EXPECT_GT(limited, trials(200));
}

TEST(Priority, holds_in_the_limiter) {
  expect_the_same_first_level<Level::kAcceleration>();
  expect_the_same_first_level<Level::kVelocity>();
}

}  // namespace
}  // namespace fpbm::test::priority_laws
