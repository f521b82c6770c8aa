#include "fpbm/simulate/fastest.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "fpbm/any/any_arm.hpp"
#include "fpbm/any/detail/any_path.hpp"
#include "fpbm/bound/speed_bounds.hpp"
#include "fpbm/bound/torque_bounds.hpp"
#include "fpbm/model/dynamics.hpp"
#include "fpbm/model/serial_arm.hpp"
#include "fpbm/path/placed.hpp"
#include "fpbm/path/waypoints.hpp"
#include "fpbm/scheme/schemes.hpp"
#include "support/arms.hpp"
#include "support/expect_refused.hpp"
#include "support/random.hpp"

/// fastest(): the tip stays on the path, no bound is exceeded by differences, and the duration is the least.
namespace fpbm::test::fastest_laws {
namespace {

constexpr int kOpen = Eigen::Dynamic;
using JointVector = Vector<kOpen>;

/// Largest ratios of velocity, acceleration and jerk to their bounds, by differences of positions, from rest to rest.
struct Ratios {
  double velocity = 0.0;
  double acceleration = 0.0;
  double jerk = 0.0;
};

Ratios ratios_of(const std::vector<JointVector>& q, double h, const JointLimits<kOpen>& limits) {
  const auto at = [&q](std::ptrdiff_t k) -> const JointVector& {
    return q[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(k, 0, std::ptrdiff_t(q.size()) - 1))];
  };
  Ratios ratios;
  for (std::ptrdiff_t k = -3; k < std::ptrdiff_t(q.size()); ++k) {
    const auto largest = [](const JointVector& difference, const JointVector& bound) {
      return difference.cwiseAbs().cwiseQuotient(bound).maxCoeff();
    };
    const JointVector first = (at(k + 1) - at(k)) / h;
    const JointVector second = (at(k + 2) - 2.0 * at(k + 1) + at(k)) / (h * h);
    const JointVector third = (at(k + 3) - 3.0 * at(k + 2) + 3.0 * at(k + 1) - at(k)) / (h * h * h);
    ratios.velocity = std::max(ratios.velocity, largest(first, limits.velocity));
    ratios.acceleration = std::max(ratios.acceleration, largest(second, limits.acceleration));
    ratios.jerk = std::max(ratios.jerk, largest(third, limits.jerk));
  }
  return ratios;
}

struct Motion {
  RolloutResult<kOpen> result;
  std::vector<JointVector> q;
  std::vector<Vector<3>> tip;
  double error = 0.0;
};

template <typename Kept = Bounds<>>
Motion fastest_motion(const AnyArm<Position<3>>& arm, const AnyPath<Pose>& path, const JointVector& q0,
                      const JointLimits<kOpen>& limits, const FastestOptions& options = {}, Kept&& bounds = {}) {
  Motion motion;
  motion.result = fastest(arm, path, MVN<kOpen>(), q0, limits, bounds, options, [&motion](const auto& sample) {
    motion.q.push_back(sample.q);
    motion.tip.push_back(sample.tip.p);
    motion.error = std::max(motion.error, sample.error.norm());
    return true;
  });
  return motion;
}

AnyPath<Pose> circle(double radius = 0.15) {
  return AnyPath<Pose>(WithRotation(InPlane(Path(Circle(radius), 1.0, Quintic{}), {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}),
                                    Vector<3>(Vector<3>::Zero())));
}

JointVector bent() {
  JointVector q(7);
  q << 0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785;
  return q;
}

const AnyArm<Position<3>>& panda() {
  static const AnyArm<Position<3>> arm = any_arm(presets::panda());
  return arm;
}

TEST(Fastest, keeps_random_paths_and_all_bounds_by_differences) {
  Random random(3);
  for (const Chain<>& chain : {presets::panda(), presets::iiwa14(), presets::xarm7()}) {
    const AnyArm<Position<3>> arm = any_arm(chain);
    JointLimits<kOpen> limits = arm.limits();
    int done = 0;
    for (int tried = 0; done < 6 && tried < 60; ++tried) {
      JointVector q0(7);
      for (int i = 0; i < 7; ++i) {
        const double low = std::max(limits.lower(i), -2.5);
        const double high = std::min(limits.upper(i), 2.5);
        q0(i) = low + (high - low) * random.uniform(0.25, 0.75);
      }
      std::vector<Transform<>> points(1);
      const int count = static_cast<int>(random.uniform(2.0, 6.0));
      for (int i = 0; i < count; ++i) {
        points.push_back(points.back());
        points.back().p += Vector<3>(random.uniform(3, -0.1, 0.1));
      }
      limits.jerk = JointVector::Constant(7, std::pow(10.0, random.uniform(2.0, 4.0)));
      Motion motion;
      try {
        motion = fastest_motion(arm, AnyPath<Pose>(Waypoints<Pose>::lasting(points, 1.0)), q0, limits);
      } catch (const std::invalid_argument&) {
        continue;  // A joint leaves its range.
      }
      if (failed(motion.result.status)) continue;  // The path leaves the workspace.
      ++done;
      const Ratios ratios = ratios_of(motion.q, 1e-3, limits);
      EXPECT_LE(ratios.velocity, 1.0 + 1e-9);
      EXPECT_LE(ratios.acceleration, 1.0 + 1e-9);
      EXPECT_LE(ratios.jerk, 1.0 + 1e-9);
      EXPECT_GE(std::max({ratios.velocity, ratios.acceleration, ratios.jerk}), 0.95) << "some bound is active";
      EXPECT_LE(motion.error, 1e-6);
    }
    EXPECT_EQ(done, 6);
  }
}

/// Duration of the fastest motion of one joint over a distance from rest to rest.
double least_duration(double distance, double v, double a, double j) {
  // Phases of constant jerk: t, the time at constant acceleration, and the time at constant velocity.
  const double reached = std::min(a, std::sqrt(v * j));
  double ramp = reached / j;
  double plateau = v / reached - ramp;
  if (reached * (ramp + plateau) * (2.0 * ramp + plateau) > distance) {  // The bound on velocity is not reached.
    ramp = std::min(reached / j, std::cbrt(distance / (2.0 * j)));
    const double most = j * ramp;
    plateau = (-3.0 * ramp + std::sqrt(ramp * ramp + 4.0 * distance / most)) / 2.0;
    return 4.0 * ramp + 2.0 * plateau;
  }
  return 4.0 * ramp + 2.0 * plateau + (distance - v * (2.0 * ramp + plateau)) / v;
}

/// One joint over a distance, from rest to rest.
Spline<1> quintic_spline(double distance, double duration) {
  constexpr int kIntervals = 600;
  std::vector<Vector<1>> q;
  std::vector<double> p;
  for (int i = 0; i <= kIntervals; ++i) {
    p.push_back(i * duration / kIntervals);
    q.emplace_back(distance * Quintic::at(static_cast<double>(i) / kIntervals).s);
  }
  return {q, p};
}

TEST(Fastest, takes_the_least_time_of_one_joint) {
  Random random(7);
  for (int trial = 0; trial < 40; ++trial) {
    const double distance = random.uniform(0.1, 3.0);
    JointLimits<1> limits = JointLimits<1>::none(1);
    limits.velocity(0) = random.uniform(0.3, 3.0);
    limits.acceleration(0) = random.uniform(1.0, 20.0);
    limits.jerk(0) = std::pow(10.0, random.uniform(1.0, 4.0));
    const FastestClock clock(quintic_spline(distance, 1.0), limits, [](double, const auto&, ClockBounds&) {});
    const double least = least_duration(distance, limits.velocity(0), limits.acceleration(0), limits.jerk(0));
    EXPECT_GE(clock.duration(), least * (1.0 - 1e-6));
    EXPECT_LE(clock.duration(), least * 1.01)
        << distance << " " << limits.velocity << " " << limits.acceleration << " " << limits.jerk;
  }
}

TEST(Fastest, clock_is_the_integral_of_its_rate) {
  JointLimits<1> limits = JointLimits<1>::none(1);
  limits.velocity(0) = limits.acceleration(0) = 1.0;
  limits.jerk(0) = 10.0;
  FastestClock clock(quintic_spline(1.0, 2.0), limits, [](double, const auto&, ClockBounds&) {});
  clock.stretch(1.5 * clock.duration());
  const double T = clock.duration();
  EXPECT_EQ(clock.at(0.0).s, 0.0);
  EXPECT_NEAR(clock.at(T).s, 2.0, 1e-12);
  EXPECT_EQ(clock.at(2.0 * T).s, clock.at(T).s);
  constexpr double h = 1e-5;
  for (double t = 0.01; t < T - 0.01; t += T / 97) {
    const Phase<double> at = clock.at(t);
    EXPECT_GT(at.sd, 0.0);
    EXPECT_NEAR((clock.at(t + h).s - clock.at(t - h).s) / (2 * h), at.sd, 1e-6 * at.sd);
    EXPECT_NEAR((clock.at(t + h).sd - clock.at(t - h).sd) / (2 * h), at.sdd, 1e-3 * (1.0 + std::abs(at.sdd)));
  }
  EXPECT_THROW(clock.stretch(0.9 * T / 1.5), std::invalid_argument);
}

TEST(Fastest, keeps_bounds_on_the_tip_and_on_speeds) {
  const JointLimits<kOpen> limits = panda().limits();
  FastestOptions options;
  const auto largest = [](const Motion& motion) {
    double speed = 0.0;
    double acceleration = 0.0;
    for (std::size_t i = 2; i < motion.tip.size(); ++i) {
      speed = std::max(speed, (motion.tip[i] - motion.tip[i - 1]).norm() / 1e-3);
      acceleration =
          std::max(acceleration, (motion.tip[i] - 2.0 * motion.tip[i - 1] + motion.tip[i - 2]).norm() / 1e-6);
    }
    return std::array<double, 2>{speed, acceleration};
  };
  options.tip_speed = 0.4;
  options.tip_acceleration = 2.0;
  const auto tip = largest(fastest_motion(panda(), circle(), bent(), limits, options));
  EXPECT_LE(tip[0], 0.4 + 1e-9);
  EXPECT_LE(tip[1], 2.0 + 1e-6);
  EXPECT_GE(tip[0], 0.39);
  EXPECT_GE(tip[1], 1.95);

  SpeedBounds<kOpen> speeds(presets::panda());
  speeds.keep({{7, {}}, 0.25});
  EXPECT_GT(largest(fastest_motion(panda(), circle(), bent(), limits))[0], 0.5);
  const auto slow = largest(fastest_motion(panda(), circle(), bent(), limits, {}, Bounds(speeds)));
  EXPECT_LT(slow[0], 0.3);
}

TEST(Fastest, slower_motions_keep_a_torque) {
  Random random(5);
  for (int trial = 0; trial < 1000; ++trial) {
    const double rest = random.uniform(-0.99, 0.99);
    const ClockTorque torque{rest, random.uniform(-0.2, 0.2), random.uniform(-3.0, 3.0), 0.0};
    const double f = torque.slower();
    if (f > 0.0) {
      EXPECT_NEAR(std::abs(rest + torque.odd / f + torque.even / (f * f)), 1.0, 1e-9);
    }
    for (const double more : {1.0, 1.1, 2.0, 10.0}) {
      const double slower = std::max(more * f, 1e-3);
      EXPECT_LE(std::abs(rest + torque.odd / slower + torque.even / (slower * slower)), 1.0 + 1e-9 * more);
    }
  }
}

TEST(Fastest, keeps_bounds_on_torques_at_both_ends_of_each_tick) {
  const Chain<> chain = presets::panda();
  const SerialArm<7> arm(chain);
  const Vector<7> q0 = bent();
  Dynamics<7> light(chain);
  Dynamics<7> heavy(chain);
  ASSERT_TRUE(heavy.set_payload(Robot<7>::kTip, {3.0, {0.0, 0.0, 0.15}}));
  double last = 0.0;
  for (const double fraction : {1.0, 0.7, 0.55}) {
    const Vector<7> effort = fraction * arm.limits().effort;
    Bounds bounds(TorqueBounds<7>(chain, heavy, effort, light));
    std::vector<std::array<Vector<7>, 3>> samples;
    const auto result = fastest(arm, circle(), MVN<7>(), q0, arm.limits(), bounds, {}, [&](const auto& sample) {
      samples.push_back({sample.q, sample.qd, sample.qdd});
      return true;
    });
    ASSERT_FALSE(failed(result.status));
    double largest = 0.0;
    const auto torques = [&](std::size_t k, const Vector<7>& qdd) {
      RobotState<7> state;
      heavy.robot().update(samples[k][0], samples[k][1], state);
      for (const auto* model : {&light, &heavy}) {
        largest = std::max(largest, model->inverse_dynamics(state, qdd).cwiseAbs().cwiseQuotient(effort).maxCoeff());
      }
    };
    for (std::size_t k = 0; k + 1 < samples.size(); ++k) {
      const Vector<7> mean = (samples[k + 1][1] - samples[k][1]) / 1e-3;
      torques(k, samples[k][2]);
      torques(k, mean);
      torques(k + 1, mean);
    }
    EXPECT_LE(largest, 1.0 + 1e-9);
    EXPECT_GE(largest, fraction == 1.0 ? 0.7 : 0.97);
    EXPECT_GT(result.time, last);
    last = result.time;
  }
  Bounds weak(TorqueBounds<7>(chain, heavy, 0.45 * arm.limits().effort));
  const auto none = [](const auto&) { return true; };
  expect_refused([&] { fastest(arm, circle(), MVN<7>(), q0, arm.limits(), weak, {}, none); }, "joint 'panda_joint2'");
}

TEST(Fastest, is_slower_with_smaller_bounds) {
  double last = 0.0;
  for (const double factor : {1.0, 0.5, 0.1, 0.02}) {
    JointLimits<kOpen> limits = panda().limits();
    limits.jerk *= factor;
    const double duration = fastest_motion(panda(), circle(), bent(), limits).result.time;
    EXPECT_GT(duration, last);
    last = duration;
  }
}

TEST(Fastest, refuses_what_has_no_answer) {
  const JointLimits<kOpen> limits = panda().limits();
  const auto held = [](const auto& path) {
    return AnyPath<Pose>(WithRotation(InPlane(path, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}), Vector<3>(Vector<3>::Zero())));
  };
  const auto with = [&](const auto& path) { return [&, path] { fastest_motion(panda(), path, bent(), limits); }; };
  expect_refused(with(held(Path(Circle(0.1), 1.0))), "zero acceleration");
  expect_refused(with(held(Path(Circle(0.1), 1.0, ConstantSpeed{}))), "zero acceleration");
  expect_refused(with(held(Path(Line<2>({0.0, 0.0}), 1.0, Quintic{}))), "has no length");
  JointLimits<kOpen> none = limits;
  none.acceleration(3) = JointBounds<>::kNone;
  expect_refused([&] { fastest_motion(panda(), circle(), bent(), none); }, "limits.acceleration[3]");
  JointLimits<kOpen> narrow = limits;
  narrow.upper(3) = -2.19;
  expect_refused([&] { fastest_motion(panda(), circle(), bent(), narrow); }, "leaves the range of joint 3");
  const Motion far = fastest_motion(panda(), circle(0.6), bent(), limits);
  EXPECT_TRUE(failed(far.result.status));
  EXPECT_TRUE(far.q.empty());
  EXPECT_GT(far.result.time, 0.0);
  EXPECT_LT(far.result.time, 1.0);
}

}  // namespace
}  // namespace fpbm::test::fastest_laws
