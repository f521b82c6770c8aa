#include <gtest/gtest.h>

#include <algorithm>
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

/// The motion J₁ u of the first level of a stack does not depend on the lower levels, also while limits are active.
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
  double scale = 0.0;   ///< Largest change of the scale of the first level.
};

[[nodiscard]] Vector<X> start_posture(const std::string& name) {
  if (name == "ur5e") return Vector<6>(0.0, -1.57, 1.57, -1.57, -1.57, 0.0);
  if (name == "iiwa14") return Vector<7>(0.0, 0.5, 0.0, -1.4, 0.0, 1.0, 0.0);
  return Vector<7>(0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785);
}

/// A position, an axis and a posture on three levels, with targets that jump. In each tick, a copy of the tracker
/// without lower levels starts from the same state.
template <Level kLevel>
void compare(const Chain<>& chain, const std::string& name, double jerk, bool keeps_first_level, unsigned seed,
             Differences& found) {
  constexpr bool kSecondOrder = kLevel == Level::kAcceleration;
  Random random(seed);
  const Robot<X> robot(chain);
  const int n = robot.dof();
  JointLimits<X> bounds = robot.limits();
  bounds.velocity *= 0.4;
  bounds.acceleration *= 0.3;
  bounds.deceleration *= 0.3;
  bounds.jerk = jerk * bounds.acceleration;
  const Limits<kLevel, X> limits(bounds, kTick);
  const auto gains = [](double k) { return kSecondOrder ? TaskGains<>(2.0 * k, k * k) : TaskGains<>(k); };
  std::vector<int> joints;
  for (int i = 0; i < n; ++i) joints.push_back(i);
  const Stack stack(PositionTask<>{{Robot<X>::kTip}, gains(5.0)}, AxisTask<>{{Robot<X>::kTip}, gains(5.0)},
                    PositionTask<>{{n - 2}, gains(4.0)});
  const auto scheme = [] {
    if constexpr (kSecondOrder) return Balanced<X>(0.6, UnitWeights{}, NullSpace<X>().with_damping(2.0));
    if constexpr (!kSecondOrder) return WMVN<X>(UnitWeights{});
  }();
  TrackerOptions<> options;
  options.keep_first_level = keeps_first_level;
  const Vector<X> q0 = start_posture(name);
  auto tracker = stack_tracker(robot, stack, scheme, State<X>{q0, Vector<X>::Zero(n)}, options, limits);
  const auto start = tracker.tip();
  using Space = typename decltype(stack)::Space;
  auto reference = Reference<Space>::hold(start);
  const double lead = kSecondOrder ? TickFeedback<>(10.0, 25.0, kTick).lead : 0.0;
  const Vector<X> most = kSecondOrder ? bounds.acceleration : bounds.velocity;
  for (int i = 0; i < 500; ++i) {
    if (random.uniform(0.0, 1.0) < 0.01) {
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
    const Vector<X> change = kSecondOrder ? Vector<X>(tick.qdd - expected.qdd) : Vector<X>(tick.qd - expected.qd);
    const double relative = (J * change).norm() / (J * most).norm();
    ++found.ticks;
    if (tick.scale < 1.0 || expected.scale < 1.0) ++found.limited;
    if (relative > 1e-9 && std::getenv("FPBM_SHOW") != nullptr) {
      std::printf("%s jerk %g keep %d seed %u tick %d: %.1e, scales %.4f %.4f, status %d %d\n", name.c_str(), jerk,
                  keeps_first_level, seed, i, relative, tick.scale, expected.scale, int(tick.status),
                  int(expected.status));
    }
    found.motion = std::max(found.motion, relative);
    found.scale = std::max(found.scale, std::abs(tick.scales[0] - expected.scales[0]));
  }
}

template <Level kLevel>
[[nodiscard]] Differences differences() {
  const double infinite = std::numeric_limits<double>::infinity();
  Differences found;
  for (int k = 0; k < motions(); ++k) {
    const double jerk = std::array<double, 4>{infinite, 50.0, 300.0, 1000.0}[static_cast<std::size_t>(k % 4)];
    const bool keeps = k / 4 % 2 == 1;
    const auto seed = static_cast<unsigned>(k);
    switch (k / 8 % 3) {
      case 0: compare<kLevel>(presets::ur5e(), "ur5e", jerk, keeps, seed, found); break;
      case 1: compare<kLevel>(presets::panda(), "panda", jerk, keeps, seed, found); break;
      default: compare<kLevel>(presets::iiwa14(), "iiwa14", jerk, keeps, seed, found);
    }
  }
  std::printf("%d ticks, %d with limits on the first level: J1 u changes by %.1e, its scale by %.1e\n", found.ticks,
              found.limited, found.motion, found.scale);
  return found;
}

TEST(Priority, no_lower_level_changes_the_first_by_acceleration) {
  const Differences found = differences<Level::kAcceleration>();
  EXPECT_GT(found.limited, found.ticks / 20);
  EXPECT_LT(found.motion, 1e-9);
  EXPECT_LT(found.scale, 1e-9);
}

TEST(Priority, no_lower_level_changes_the_first_by_velocity) {
  const Differences found = differences<Level::kVelocity>();
  EXPECT_GT(found.limited, found.ticks / 20);
  EXPECT_LT(found.motion, 1e-9);
  EXPECT_LT(found.scale, 1e-9);
}

}  // namespace
}  // namespace fpbm::test::priority_laws
