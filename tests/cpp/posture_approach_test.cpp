#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "fpbm/any/any_stack.hpp"
#include "fpbm/model/detail/robot_presets.hpp"
#include "fpbm/model/presets.hpp"
#include "fpbm/realtime/stack_tracker.hpp"
#include "fpbm/scheme/schemes.hpp"
#include "fpbm/task/pose_task.hpp"
#include "fpbm/task/position_task.hpp"
#include "fpbm/task/posture_task.hpp"
#include "support/random.hpp"

/// A posture task moves the joints to a far posture almost as fast as their bounds allow.
namespace fpbm::test::posture_approach {
namespace {

constexpr int N = Eigen::Dynamic;

/// Motions of each robot, level and tick. FPBM_MOTIONS=3 gives the numbers of docs/tasks.md.
[[nodiscard]] int motions() {
  const char* given = std::getenv("FPBM_MOTIONS");
  return given != nullptr ? std::atoi(given) : trials(3);
}

/// Least time from rest to rest over the distance d within the bounds V, A and J on velocity, acceleration and jerk:
/// seven phases of constant jerk, or fewer (Biagiotti and Melchiorri 2008, section 3.4).
[[nodiscard]] double least_time(double d, double V, double A, double J) {
  // Time and distance of a change from rest to the velocity v.
  const auto ramp = [&](double v) { return v * J >= A * A ? v / A + A / J : 2.0 * std::sqrt(v / J); };
  const auto both = [&](double v) { return v * ramp(v); };
  if (both(V) <= d) return d / V + ramp(V);
  double low = 0.0;
  double high = V;
  for (int i = 0; i < 100; ++i) (both((low + high) / 2.0) < d ? low : high) = (low + high) / 2.0;
  return 2.0 * ramp(low);
}

[[nodiscard]] std::vector<std::pair<std::string, Robot<N>>> robots() {
  std::vector<std::pair<std::string, Robot<N>>> all;
  for (const auto& [name, chain] :
       {std::pair("Panda", presets::panda()), std::pair("FR3", presets::fr3()), std::pair("iiwa 14", presets::iiwa14()),
        std::pair("Gen3", presets::gen3()), std::pair("UR5e", presets::ur5e()), std::pair("UR10e", presets::ur10e())}) {
    all.emplace_back(name, Robot<N>(chain));
  }
  all.emplace_back("two Pandas", Robot<N>(presets::two_pandas()));
  all.emplace_back("upper body", Robot<N>(presets::g1_upper_body()));
  return all;
}

/// Posture within the ranges.
[[nodiscard]] Vector<N> posture_within(const JointLimits<N>& bounds, Random& random) {
  Vector<N> q = bounds.lower;
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const double low = std::max(bounds.lower(i), -3.14);
    const double high = std::min(bounds.upper(i), 3.14);
    q(i) = low + random.uniform(0.01, 0.99) * (high - low);
  }
  return q;
}

constexpr std::size_t kPosture = 2;  ///< Index of the first posture task of an AnyStack.

struct Approach {
  double ratio = 0.0;      ///< Time until the error is below 1 % of the distance, divided by the least time.
  double overshoot = 0.0;  ///< Largest displacement of a joint beyond its target, divided by the distance.
  double excess = 0.0;     ///< Over the bounds on position [rad], velocity and acceleration (relative).
};

template <typename Scheme>
[[nodiscard]] Approach approach(const Robot<N>& robot, const Scheme& scheme, const TaskGains<>& gains, double h,
                                Random& random) {
  JointLimits<N> bounds = robot.limits();
  const bool jerk = random.uniform(0.0, 1.0) < 0.5;
  const double jerk_time = random.uniform(0.0, 1.0) < 0.5 ? 1.0 / 30.0 : 1.0 / random.uniform(50.0, 500.0);
  if (jerk && !bounds.jerk.allFinite()) bounds.jerk = bounds.acceleration / jerk_time;
  const Limits<Scheme::kLevel, N> limits(bounds, h);
  const Vector<N> q0 = posture_within(bounds, random);
  Vector<N> target = posture_within(bounds, random);
  TrackerOptions<> options;
  options.dt = h;
  // A posture of all joints on the first level.
  std::vector<int> joints(static_cast<std::size_t>(robot.dof()));
  for (std::size_t i = 0; i < joints.size(); ++i) joints[i] = static_cast<int>(i);
  const AnyLevel none({}, {}, {});
  const AnyStack stack(AnyLevel({}, {}, AnyPostureTask(joints, gains)), none, none, none);
  auto tracker = stack_tracker(robot, stack, scheme, State<N>{q0, Vector<N>::Zero(q0.size())}, options, limits);
  auto reference = decltype(tracker)::Target::hold(tracker.tip());
  // A continuous joint moves by at most half a turn.
  for (Eigen::Index i = 0; i < q0.size(); ++i) {
    if ((tracker.continuous() >> i & 1U) != 0) target(i) += whole_turns(q0(i) - target(i));
  }
  double least = 0.0;
  double distance = 0.0;
  for (Eigen::Index i = 0; i < q0.size(); ++i) {
    std::get<kPosture>(reference.x)(i) = target(i);
    distance = std::max(distance, std::abs(target(i) - q0(i)));
    least = std::max(least, least_time(std::abs(target(i) - q0(i)), bounds.velocity(i), bounds.acceleration(i),
                                       std::min(bounds.jerk(i), 1e9)));
  }
  Approach found;
  found.ratio = 1e3;
  for (int k = 1; k * h < 4.0 * least + 1.0; ++k) {
    const auto tick = tracker.tick(reference);
    const double error = (target - tick.q).cwiseAbs().maxCoeff();
    if (error > 0.01 * distance) found.ratio = 1e3;
    if (error <= 0.01 * distance && found.ratio == 1e3) found.ratio = k * h / least;
    for (Eigen::Index i = 0; i < q0.size(); ++i) {
      const double beyond = (tick.q(i) - target(i)) * (target(i) > q0(i) ? 1.0 : -1.0);
      found.overshoot = std::max(found.overshoot, beyond / distance);
      found.excess = std::max({found.excess, tick.q(i) - bounds.upper(i), bounds.lower(i) - tick.q(i),
                               std::abs(tick.qd(i)) / bounds.velocity(i) - 1.0,
                               std::abs(tick.qdd(i)) / bounds.acceleration(i) - 1.0});
    }
  }
  return found;
}

template <typename Scheme>
void expect_near_least_time(const Scheme& scheme, const TaskGains<>& gains) {
  for (const double h : {1e-3, 4e-3}) {
    for (const auto& [name, robot] : robots()) {
      Approach worst;
      double sum = 0.0;
      for (int k = 0; k < motions(); ++k) {
        Random random(static_cast<std::uint32_t>(k));
        const Approach found = approach(robot, scheme, gains, h, random);
        sum += found.ratio;
        worst.ratio = std::max(worst.ratio, found.ratio);
        worst.overshoot = std::max(worst.overshoot, found.overshoot);
        worst.excess = std::max(worst.excess, found.excess);
      }
      std::printf(
          "%s, %s level, ticks of %g s, %d motions: at most %.2f times the least time, mean %.2f, overshoot %.1e of "
          "the distance, bounds exceeded by %.1e\n",
          name.c_str(), Scheme::kLevel == Level::kAcceleration ? "acceleration" : "velocity", h, motions(), worst.ratio,
          sum / motions(), worst.overshoot, worst.excess);
      EXPECT_LE(worst.ratio, 2.0);
      EXPECT_LE(worst.overshoot, 1e-3);
      EXPECT_LE(worst.excess, 1e-9);
    }
  }
}

TEST(PostureApproach, needs_at_most_twice_the_least_time_at_acceleration_level) {
  expect_near_least_time(Balanced<N>(0.0, UnitWeights{}), TaskGains<>(20.0, 100.0));
}
TEST(PostureApproach, needs_at_most_twice_the_least_time_at_velocity_level) {
  expect_near_least_time(MVN<N>(), TaskGains<>(10.0));
}

/// Largest error of the tip [m]: about twice the error of the motions below, 2.2e-5 m at velocity level and 3.4e-8 m at
/// acceleration level. The integration of a tick causes this error (docs/priority.md, Limitations).
constexpr double kTipError = 5e-5;

/// The posture on the second level: the tip stays, and the joints reach a posture with the same tip.
template <typename Scheme>
void expect_tip_to_stay(const Scheme& scheme, const TaskGains<>& gains) {
  const Robot<7> robot(presets::panda());
  for (int k = 0; k < motions(); ++k) {
    Random random(static_cast<std::uint32_t>(k));
    const Vector<7> q0 = Vector<7>{0.0, -0.6, 0.0, -2.2, 0.0, 1.8, 0.785} + Vector<7>(random.uniform(7, -0.3, 0.3));
    const Stack stack(PositionTask<>{{Robot<7>::kTip}, gains}, PostureTask<7>{gains});
    auto tracker = stack_tracker(robot, stack, scheme, q0);
    auto target = decltype(tracker)::Target::hold(tracker.tip());
    double away = 0.0;
    const auto run = [&](double seconds) {
      for (int i = 0; i < seconds * 1e3; ++i)
        away = std::max(away, tracker.tick(target).error.template head<3>().norm());
    };
    std::get<1>(target.x) = q0 + Vector<7>(random.uniform(7, -1.0, 1.0));
    run(5.0);
    const Vector<7> there = tracker.state().q;
    std::get<1>(target.x) = q0;
    run(5.0);
    EXPECT_LT((tracker.state().q - q0).norm(), 1e-3);
    std::get<1>(target.x) = there;
    run(5.0);
    EXPECT_LT((tracker.state().q - there).norm(), 1e-3);
    EXPECT_GT((there - q0).norm(), 0.1);
    EXPECT_LT(away, kTipError);
    std::printf("tip away by at most %.1e m\n", away);
  }
}

TEST(PostureApproach, on_the_second_level_leaves_the_tip) {
  expect_tip_to_stay(Balanced<7>(0.0, UnitWeights{}, NullSpace<7>().with_damping(2.0)), TaskGains<>(20.0, 100.0));
  expect_tip_to_stay(MVN<7>(), TaskGains<>(10.0));
}

}  // namespace
}  // namespace fpbm::test::posture_approach
