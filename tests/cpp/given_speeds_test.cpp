#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "fpbm/any/any_arm.hpp"
#include "fpbm/any/detail/any_path.hpp"
#include "fpbm/path/placed.hpp"
#include "fpbm/path/polyline.hpp"
#include "fpbm/path/waypoints.hpp"
#include "fpbm/scheme/schemes.hpp"
#include "fpbm/simulate/fastest.hpp"
#include "fpbm/simulate/kept_path.hpp"
#include "support/arms.hpp"
#include "support/expect_refused.hpp"
#include "support/random.hpp"

/// fastest() with start_speed and end_speed: the speeds are exact, the tip stays on the path, no bound is exceeded by
/// differences within the motion, and the duration is the least.
namespace fpbm::test::given_speeds_laws {
namespace {

constexpr int kOpen = Eigen::Dynamic;
using JointVector = Vector<kOpen>;
using Arm = AnyArm<Position<3>>;

struct Motion {
  RolloutResult<kOpen> result;
  std::vector<JointVector> q;
  std::array<double, 2> speeds{};  ///< Speeds of the tip at the start and at the end.
  double error = 0.0;
};

Motion fastest_motion(const Arm& arm, const AnyPath<Pose>& path, const JointVector& q0, const FastestOptions& options) {
  Motion motion;
  Bounds<> bounds;
  Kinematics<Pose, kOpen> kinematics;
  motion.result = fastest(arm, path, MVN<kOpen>(), q0, arm.limits(), bounds, options, [&](const auto& sample) {
    arm.kinematics(sample.q, kinematics);
    motion.speeds[1] = (kinematics.J * sample.qd).template head<3>().norm();
    if (sample.index == 0) motion.speeds[0] = motion.speeds[1];
    motion.error = std::max(motion.error, sample.error.norm());
    motion.q.push_back(sample.q);
    return true;
  });
  return motion;
}

FastestOptions with_speeds(double start, double end) {
  FastestOptions options;
  options.start_speed = start;
  options.end_speed = end;
  return options;
}

/// Largest ratio of velocity, acceleration and jerk to their bounds, by differences of the positions of a motion.
double largest_ratio(const std::vector<JointVector>& q, double h, const JointLimits<kOpen>& limits) {
  double ratio = 0.0;
  const auto add = [&ratio](const JointVector& difference, const JointVector& bound) {
    ratio = std::max(ratio, difference.cwiseAbs().cwiseQuotient(bound).maxCoeff());
  };
  for (std::size_t k = 1; k < q.size(); ++k) {
    add((q[k] - q[k - 1]) / h, limits.velocity);
    if (k > 1) add((q[k] - 2.0 * q[k - 1] + q[k - 2]) / (h * h), limits.acceleration);
    if (k > 2) add((q[k] - 3.0 * q[k - 1] + 3.0 * q[k - 2] - q[k - 3]) / (h * h * h), limits.jerk);
  }
  return ratio;
}

template <typename Positions>
AnyPath<Pose> held(const Positions& path, const Vector<3>& rotation = {0.0, 0.0, 0.0}) {
  return AnyPath<Pose>(WithRotation(path, rotation));
}

template <typename Flat>
auto upright(const Flat& path) {
  return InPlane(path, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0});
}

AnyPath<Pose> line(const Vector<3>& displacement) {
  return held(Path(Line<3>(displacement), 1.0, Quintic{}));
}

/// A random path of one of five kinds.
AnyPath<Pose> random_path(int kind, Random& random) {
  const auto displacement = [&random] { return Vector<3>(random.uniform(3, -0.15, 0.15)); };
  switch (kind) {
    case 0: return line(displacement());
    case 1: return held(upright(Path(Circle(random.uniform(0.05, 0.15)), 2.0, Quintic{})), Vector<3>(0.3, 0.0, -0.4));
    case 2: return held(upright(Path(Lissajous({0.08, 0.06}, {1, 2}, 0.5), 1.0, Quintic{})));
    case 3: {
      std::vector<Transform<>> points(1);
      for (int i = 0; i < 3; ++i) {
        points.push_back(points.back());
        points.back().p += displacement();
        points.back().R = rotation(Vector<3>(random.uniform(3, -0.2, 0.2))) * points.back().R;
      }
      return AnyPath<Pose>(Path(Polyline<Pose>(points, 0.03), 1.5, Quintic{}));
    }
    default: return AnyPath<Pose>(Sequence(line(displacement()), line(displacement())));
  }
}

TEST(GivenSpeeds, are_exact_on_the_path_and_within_all_bounds) {
  Random random(4);
  for (const Chain<>& chain : {presets::panda(), presets::iiwa14(), presets::xarm7()}) {
    const Arm arm = any_arm(chain);
    const JointLimits<kOpen> limits = arm.limits().complete();
    int done = 0;
    for (int tried = 0; done < trials(6) && tried < 300; ++tried) {
      SCOPED_TRACE(std::to_string(tried));
      JointVector q0(7);
      for (int i = 0; i < 7; ++i) {
        const double low = std::max(limits.lower(i), -2.5);
        const double high = std::min(limits.upper(i), 2.5);
        q0(i) = low + (high - low) * random.uniform(0.3, 0.7);
      }
      const AnyPath<Pose> path = random_path(tried % 5, random);
      const bool start = tried % 3 != 0;
      const bool end = tried % 3 != 1;
      const auto options = with_speeds(start ? random.uniform(0.01, 0.3) : 0.0, end ? random.uniform(0.01, 0.3) : 0.0);
      Motion motion;
      try {
        motion = fastest_motion(arm, path, q0, options);
      } catch (const std::invalid_argument&) {
        continue;  // A joint leaves its range, or the bounds do not admit a speed.
      }
      if (failed(motion.result.status)) continue;  // The path leaves the workspace.
      ++done;
      EXPECT_NEAR(motion.speeds[0], options.start_speed, 1e-6);
      EXPECT_NEAR(motion.speeds[1], options.end_speed, 1e-6);
      EXPECT_LE(largest_ratio(motion.q, options.dt, limits), 1.0 + 1e-9);
      EXPECT_LE(motion.error, 1e-6);
      EXPECT_LE(motion.result.time, fastest_motion(arm, path, q0, {}).result.time + 1e-9);
    }
    EXPECT_EQ(done, trials(6));
  }
}

JointVector bent() {
  JointVector q(7);
  q << 0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785;
  return q;
}

const Arm& panda() {
  static const Arm arm = any_arm(presets::panda());
  return arm;
}

/// A motion in the least time consists of motions in the least time: with the speed in between, its parts take as long.
TEST(GivenSpeeds, of_the_parts_of_a_motion_take_the_time_of_the_motion) {
  const Vector<3> whole(0.0, 0.4, 0.1);
  const Motion motion = fastest_motion(panda(), line(whole), bent(), {});
  Kinematics<Pose, kOpen> kinematics;
  panda().kinematics(motion.q.front(), kinematics);
  const Vector<3> start = kinematics.tip.p;
  for (const double fraction : {0.2, 0.5, 0.7}) {
    const auto k = static_cast<std::size_t>(fraction * static_cast<double>(motion.q.size()));
    panda().kinematics(motion.q[k], kinematics);
    const Vector<3> moved = kinematics.tip.p - start;
    const JointVector qd = (motion.q[k + 1] - motion.q[k - 1]) / 2e-3;
    const double speed = 0.995 * (kinematics.J * qd).head<3>().norm();
    const Motion first = fastest_motion(panda(), line(moved), bent(), with_speeds(0.0, speed));
    const Motion second = fastest_motion(panda(), line(whole - moved), motion.q[k], with_speeds(speed, 0.0));
    EXPECT_NEAR(first.result.time, static_cast<double>(k) * 1e-3, 0.01 * motion.result.time);
    EXPECT_NEAR(first.result.time + second.result.time, motion.result.time, 0.01 * motion.result.time);
  }
}

/// Duration of the fastest motion of one joint over a distance with bounds on velocity and acceleration.
double least_duration(double distance, double v, double a, double start, double end) {
  v = std::min(v, std::sqrt(a * distance + (start * start + end * end) / 2.0));
  const double ramps = (2.0 * v * v - start * start - end * end) / (2.0 * a);
  return (2.0 * v - start - end) / a + (distance - ramps) / v;
}

TEST(GivenSpeeds, of_one_joint_have_the_least_duration) {
  constexpr std::size_t kIntervals = 600;
  Random random(8);
  for (int trial = 0; trial < 40; ++trial) {
    const double distance = random.uniform(0.3, 3.0);
    std::vector<Vector<1>> q;
    std::vector<double> p;
    for (std::size_t i = 0; i <= kIntervals; ++i) {
      p.push_back(distance * static_cast<double>(i) / kIntervals);
      q.emplace_back(p.back());
    }
    const Spline<1>::Rates rates(1.0, 0.0);
    JointLimits<1> limits = JointLimits<1>::none(1);
    const double v = limits.velocity(0) = random.uniform(0.5, 3.0);
    const double a = limits.acceleration(0) = random.uniform(3.0, 20.0);
    const double start = v * random.uniform(1e-3, 1.0);
    // The acceleration admits at most this difference of the squared speeds.
    const double change = std::min(0.9 * 2.0 * a * distance, v * v);
    const double low = std::sqrt(std::max(start * start - change, 1e-4));
    const double end = random.uniform(low, std::min(v, std::sqrt(start * start + change)));
    const auto none = [](double, const auto&, ClockBounds&) {};
    FastestClock clock({q, p, rates, rates}, limits, none, {{start, end}, {start, end}});
    const double least = least_duration(distance, v, a, start, end);
    EXPECT_GE(clock.duration(), least * (1.0 - 1e-6));
    EXPECT_LE(clock.duration(), least * 1.003) << distance << " " << v << " " << a << " " << start << " " << end;
    clock.stretch(1.05 * clock.duration());
    const double T = clock.duration();
    EXPECT_NEAR(clock.at(0.0).sd, start, 1e-12);
    EXPECT_NEAR(clock.at(T).sd, end, 1e-12);
    EXPECT_EQ(clock.at(0.0).s, 0.0);
    EXPECT_NEAR(clock.at(T).s, distance, 1e-12);
    constexpr double h = 1e-6;
    for (double t = 0.01 * T; t < 0.99 * T; t += T / 97) {
      EXPECT_NEAR((clock.at(t + h).s - clock.at(t - h).s) / (2 * h), clock.at(t).sd, 1e-6 * v);
    }
  }
}

TEST(GivenSpeeds, may_be_low_or_equal_to_a_bound_on_the_tip) {
  const AnyPath<Pose> circle = held(upright(Path(Circle(0.15), 1.0, Quintic{})));
  const double rest = fastest_motion(panda(), circle, bent(), {}).result.time;
  for (const double low : {1e-5, 1e-4, 1e-2}) {
    const Motion motion = fastest_motion(panda(), circle, bent(), with_speeds(low, low));
    EXPECT_NEAR(motion.speeds[0], low, 1e-9);
    EXPECT_NEAR(motion.speeds[1], low, 1e-9);
    EXPECT_LE(motion.result.time, rest);
    EXPECT_GE(motion.result.time, 0.98 * rest);
  }
  FastestOptions options = with_speeds(0.2, 0.2);
  options.tip_speed = 0.2;
  const double constant = 2.0 * 3.14159265358979 * 0.15 / 0.2;
  EXPECT_NEAR(fastest_motion(panda(), circle, bent(), options).result.time, constant, 2e-3);
}

TEST(GivenSpeeds, that_have_no_answer_are_refused) {
  const auto refused = [](const AnyPath<Pose>& path, const FastestOptions& options, const std::string& part) {
    expect_refused([&] { fastest_motion(panda(), path, bent(), options); }, part);
  };
  const AnyPath<Pose> far = line({0.0, 0.3, 0.0});
  const AnyPath<Pose> near = line({0.0, 0.01, 0.0});
  refused(far, with_speeds(-0.1, 0.0), "start_speed = -0.1: must be finite and not negative");
  refused(far, with_speeds(0.0, std::numeric_limits<double>::infinity()), "end_speed = inf");
  refused(far, with_speeds(std::numeric_limits<double>::quiet_NaN(), 0.0), "start_speed = nan");
  refused(far, with_speeds(1e-6, 0.0), "start_speed = 1e-06: must be 0, or at least 1e-05");
  refused(far, with_speeds(9.0, 0.0), "by the bounds on velocities at this end");
  refused(near, with_speeds(0.6, 0.0), "start_speed = 0.6: must be lower, for example 0.");
  refused(near, with_speeds(0.0, 0.6), "end_speed = 0.6: must be lower, for example 0.");
  refused(near, with_speeds(0.01, 0.7),
          "start_speed = 0.01 and end_speed = 0.7: must be nearer to each other or lower");
  std::vector<Transform<>> points(3);
  points[1].p = {0.0, 0.1, 0.0};
  points[2].p = {0.0, 0.1, 0.1};
  const AnyPath<Pose> waypoints(Waypoints<Pose>::lasting(points, 1.0));
  refused(waypoints, with_speeds(0.1, 0.0), "no bounded curvature at its start");
  refused(waypoints, with_speeds(0.0, 0.1), "no bounded curvature at its end");
  const AnyPath<Pose> cusp = held(upright(Path(Tricuspid(0.05), 1.0, Quintic{})));
  refused(cusp, with_speeds(0.1, 0.0), "no bounded curvature at its start");
  refused(held(upright(Path(Circle(0.1), 1.0))), with_speeds(0.1, 0.0), "zero acceleration");
  refused(held(Path(Line<3>({0.0, 0.0, 0.0}), 1.0, Quintic{}), Vector<3>(0.0, 0.0, 0.5)), with_speeds(0.1, 0.0),
          "has no length: must move the tip in position");
  FastestOptions coarse = with_speeds(0.3, 0.3);
  coarse.dt = 0.05;
  refused(near, coarse, "a multiple of dt, cannot have these speeds");
  Bounds<> bounds;
  const auto keep = [&] {
    return kept_path(panda(), far, MVN<kOpen>(), bent(), panda().limits(), bounds, with_speeds(0.1, 0.0));
  };
  expect_refused(keep, "start_speed = 0.1: must be 0: a kept path is at rest there");
}

/// The lower speed in a refusal is accepted, and is nearly the largest.
TEST(GivenSpeeds, that_a_refusal_names_are_accepted) {
  for (const double length : {0.005, 0.01, 0.02}) {
    const AnyPath<Pose> path = line({0.0, length, 0.0});
    std::string text;
    try {
      fastest_motion(panda(), path, bent(), with_speeds(0.6, 0.0));
    } catch (const std::invalid_argument& error) {
      text = error.what();
    }
    const std::size_t at = text.find("for example ");
    ASSERT_NE(at, std::string::npos) << text;
    const double lower = std::stod(text.substr(at + 12));
    EXPECT_NO_THROW(fastest_motion(panda(), path, bent(), with_speeds(lower, 0.0))) << text;
    EXPECT_THROW(fastest_motion(panda(), path, bent(), with_speeds(1.03 * lower, 0.0)), std::invalid_argument) << text;
  }
}

/// A spline with the rates of a polynomial of degree 5 at its ends is this polynomial.
TEST(Spline, with_given_rates_is_exact_for_polynomials) {
  const auto value = [](double t, int derivative) {
    constexpr std::array<double, 6> kC{0.3, -1.0, 0.7, 2.0, -1.5, 0.4};
    double sum = 0.0;
    for (int k = derivative; k < 6; ++k) {
      double factor = kC[static_cast<std::size_t>(k)];
      for (int j = 0; j < derivative; ++j) factor *= k - j;
      sum += factor * std::pow(t, k - derivative);
    }
    return Vector<1>(sum);
  };
  const std::vector<double> times{0.0, 0.3, 0.5, 1.1, 1.6};
  std::vector<Vector<1>> points;
  for (const double t : times) points.push_back(value(t, 0));
  const auto rates = [&value](double t) { return Spline<1>::Rates(value(t, 1)(0), value(t, 2)(0)); };
  const Spline<1> spline(points, times, rates(0.0), rates(1.6));
  for (double t = 0.0; t <= 1.6; t += 0.05) {
    EXPECT_NEAR(spline.at(t).x(0), value(t, 0)(0), 1e-13);
    EXPECT_NEAR(spline.at(t).xd(0), value(t, 1)(0), 1e-12);
    EXPECT_NEAR(spline.at(t).xdd(0), value(t, 2)(0), 1e-11);
  }
}

}  // namespace
}  // namespace fpbm::test::given_speeds_laws
