#include <algorithm>
#include <cmath>
#include <deque>
#include <random>
#include <string>

#include "check.hpp"
#include "tests.hpp"

namespace {

using fpbm::Transform;
using stand_in::Robot;

/// Sets parameters with which the target may be as fast as the joints.
void fast() {
  auto& own = stand_in::parameters;
  own.scheme.k1 = 10.0;
  own.scheme.k2 = 25.0;
  own.target.velocity = own.target.angular_velocity = 20.0;
  own.target.acceleration = own.target.angular_acceleration = 200.0;
  own.target.jerk = own.target.angular_jerk = 1e5;
}

/// Sends a target that rotates about the base. At first, the target is faster than the velocity bound of joint 1.
void turn(Robot& robot, const Transform<>& start, double t) {
  Transform<> turned;
  turned.R = fpbm::rotation(fpbm::Vector<3>(0.0, 0.0, 2.0 * std::sin(1.5 * t)));
  robot.hear("~/target_pose", pose_message(turned * start));
}

/// A rate of the controller that is valid, or is refused with an error that names the nearest rates.
void rate(unsigned int manager, int own, bool valid, const std::string& nearest) {
  Robot robot;
  robot.rate = manager;
  fast();
  (void)logged("");
  const std::string what = std::to_string(own) + " Hz of " + std::to_string(manager) + " Hz: ";
  const bool loaded = robot.load({{"update_rate", rclcpp::ParameterValue(own)}});
  check(loaded == valid, (what + (valid ? "configured" : "refused")).c_str(), loaded);
  if (!valid) check(logged(nearest), (what + "nearest rates named").c_str(), 1);
  if (!loaded) return;
  (void)robot.activate();
  const Transform<> start = robot.tip();
  for (unsigned int i = 0; i < 4 * manager; ++i) {
    turn(robot, start, static_cast<double>(i) / manager);
    robot.tick();
  }
  check(robot.excess < 1e-9, (what + "velocity beyond a limit [rad/s]").c_str(), robot.excess);
  check(robot.excess > -0.01, (what + "velocity at a limit [rad/s]").c_str(), robot.excess);
}

/// Calls at twice the update rate, then bursts after late calls. In any 50 ms, the mean velocity of each joint is
/// within its bound.
void calls_too_soon() {
  Robot robot;
  fast();
  robot.watched = false;
  check(robot.load() && robot.activate(), "calls too soon: activated", 1);
  const auto bounds = stand_in::parameters.limits.velocity;
  const Transform<> start = robot.tip();
  std::deque<std::pair<double, Robot::Joints>> past;
  double t = 0.0;
  double fastest = 0.0;
  for (int i = 0; i < 5000; ++i) {
    const bool burst = i >= 3000 && i % 20 == 0;
    const double period = i < 3000 ? 0.5e-3 : burst ? 10e-3 : i % 20 < 10 ? 1e-5 : 1e-3;
    turn(robot, start, t);
    robot.tick(period);
    t += period;
    past.emplace_back(t, robot.command);
    while (t - past.front().first > 0.05) past.pop_front();
    for (std::size_t j = 0; j < Robot::kDof && t > 0.06; ++j) {
      const double displacement = std::abs(robot.command[j] - past.front().second[j]);
      fastest = std::max(fastest, displacement / (t - past.front().first + 2e-3) / bounds[j]);
    }
  }
  check(fastest > 0.9 && fastest < 1.0, "calls too soon: mean velocity in 50 ms, of its bound", fastest);
}

/// Calls at 1.5 to 30 times the update rate, and at a rate that is 0.3 % too high: by the clock of the calls, the
/// commands keep the bounds on acceleration.
void by_the_clock() {
  Robot robot;
  robot.watched = false;
  check(robot.load() && robot.activate(), "calls too soon, by the clock: activated", 1);
  const auto& bounds = stand_in::parameters.limits.acceleration;
  const Transform<> start = robot.tip();
  std::mt19937 random(2);
  std::uniform_real_distribution<double> jitter(0.03e-3, 0.7e-3);
  Robot::Joints before{};
  Robot::Joints velocity{};
  double last_period = 0.0;
  double t = 0.0;
  double largest = 0.0;
  double fastest = 0.0;
  for (int i = 0; i < 8000; ++i) {
    const double period = i < 4000 ? 0.997e-3 : jitter(random);
    Transform<> pose = start;
    pose.p += fpbm::Vector<3>(0.05, 0.15, 0.1) * std::sin(4.0 * t);
    if (i % 10 == 0) robot.hear("~/target_pose", pose_message(pose));
    robot.tick(period);
    t += period;
    for (std::size_t j = 0; j < Robot::kDof; ++j) {
      const double v = (robot.command[j] - before[j]) / period;
      const double a = (v - velocity[j]) / (0.5 * (period + last_period));
      if (i > 2) largest = std::max(largest, std::abs(a) / bounds[j]);
      if (i > 2) fastest = std::max(fastest, std::abs(v));
      before[j] = robot.command[j];
      velocity[j] = v;
    }
    last_period = period;
  }
  check(fastest > 0.3 && largest < 1.001, "calls too soon, by the clock: acceleration, of its bound", largest);
  check(robot.allocated == 0, "calls too soon, by the clock: allocations", static_cast<double>(robot.allocated));
}

}  // namespace

void rates() {
  rate(1000, 1000, true, "");
  rate(1000, 500, true, "");
  rate(500, 100, true, "");
  rate(50, 20, false, "10 or 25");
  rate(100, 60, false, "give 50 or 100");
  rate(100, 70, false, "give 50 or 100");
  rate(1000, 501, false, "give 500 or 1000");
  rate(50, 200, false, "give 50\n");
  rate(100, 0, false, "give 100\n");
  rate(100, 40, false, "25 or 50");
  rate(1000, 300, false, "250 or 500");
  calls_too_soon();
  by_the_clock();

  Robot robot;
  const bool loaded = robot.load({{"is_async", rclcpp::ParameterValue(true)}});
  check(!loaded && logged("is_async"), "is_async: refused", loaded);
}
