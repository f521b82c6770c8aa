#include <cmath>
#include <diagnostic_msgs/msg/diagnostic_array.hpp>
#include <random>

#include "check.hpp"
#include "tests.hpp"

namespace {

using diagnostic_msgs::msg::DiagnosticArray;
using diagnostic_msgs::msg::DiagnosticStatus;
using fpbm::Transform;
using stand_in::Lifecycle;
using stand_in::Robot;

/// Sends target poses that move back and forth, so that all joints move.
void swing(Robot& robot, const Transform<>& start, int i) {
  Transform<> pose = start;
  pose.p += fpbm::Vector<3>(0.05, 0.15, 0.1) * std::sin(4e-3 * i);
  if (i % 10 == 0) robot.hear("~/target_pose", pose_message(pose, 1e-3 * i));
}

void one_by_one() {
  Robot robot;
  check(robot.load() && robot.activate(), "locks one by one: activated", 1);
  const Transform<> start = robot.tip();
  std::mt19937 random(3);
  double fastest = 0.0;
  for (int i = 0; i < 4000; ++i) {
    swing(robot, start, i);
    if (i % 397 == 0) robot.command_locks[random() % (2 * Robot::kDof)].calls = 1 + static_cast<int>(random() % 3);
    if (i % 41 == 0) robot.state_locks[random() % Robot::kDof].calls = 1;
    robot.tick();
    fastest = std::max(fastest, robot.speed());
  }
  check(fastest > 0.3, "locks one by one: speed [rad/s]", fastest);
  check(robot.excess < 1e-9, "locks one by one: velocity beyond a limit [rad/s]", robot.excess);
  check(robot.acceleration_excess < 1e-6, "locks one by one: ratio of the acceleration excess to the limit",
        robot.acceleration_excess);
  check(robot.jerk_excess < 1e-3, "locks one by one: ratio of the jerk excess to the limit", robot.jerk_excess);
  const auto& said = robot.said<DiagnosticArray>("/diagnostics").last.status.at(0);
  check(said.level == DiagnosticStatus::WARN, "locks one by one: level of the diagnostics", said.level);
  check(robot.allocated == 0, "locks one by one: allocations", static_cast<double>(robot.allocated));
}

/// Locks of one joint for 1 to 4 ticks: after the lock, the arm starts from rest, by the clock.
void resumed() {
  Robot robot;
  check(robot.load() && robot.activate(), "resumed after a lock: activated", 1);
  robot.watched = false;
  const auto& bounds = stand_in::parameters.limits.acceleration;
  const Transform<> start = robot.tip();
  double largest = 0.0;
  double fastest = 0.0;
  for (int lock = 1; lock <= 4; ++lock) {
    for (int i = 0; i < 400; ++i) {
      swing(robot, start, i + 400 * lock);
      robot.tick();
    }
    fastest = std::max(fastest, robot.speed());
    robot.command_locks[2].calls = lock;
    robot.tick(lock);
    auto before = robot.command;
    Robot::Joints velocity{};
    for (int i = 0; i < 100; ++i) {
      robot.tick();
      for (std::size_t j = 0; j < Robot::kDof; ++j) {
        const double v = 1e3 * (robot.command[j] - before[j]);
        // In the first of these ticks, the locked joint accepts the last command of the other joints.
        if (i > 0) largest = std::max(largest, 1e3 * std::abs(v - velocity[j]) / bounds[j]);
        velocity[j] = i > 0 ? v : 0.0;
        before[j] = robot.command[j];
      }
    }
  }
  check(fastest > 0.3 && largest < 1.001, "resumed after a lock: acceleration, of its bound", largest);
  for (int i = 2000; i < 2100; ++i) {
    swing(robot, start, i);
    robot.tick();
  }
  const auto& said = robot.said<DiagnosticArray>("/diagnostics").last.status.at(0);
  check(said.values.at(4).key == "targets rejected" && said.values.at(4).value == "0",
        "resumed after a lock: stamps that are rejected", std::stod(said.values.at(4).value));
  const Transform<> goal = start;
  robot.hear("~/target_pose", pose_message(goal));
  robot.tick(300);
  robot.command_locks[4].calls = 2;
  robot.tick(5000);
  check(distance(robot.tip(), goal) < 1e-5, "resumed after a lock: distance from the target before [m, rad]",
        distance(robot.tip(), goal));
  check(robot.allocated == 0, "resumed after a lock: allocations", static_cast<double>(robot.allocated));
  geometry_msgs::msg::TwistStamped twist;  // A twist that has ended.
  twist.header.frame_id = "base";
  twist.twist.linear.z = 0.05;
  robot.hear("~/target_twist", twist);
  robot.tick(6000);
  const Transform<> stands = robot.tip();
  robot.command_locks[4].calls = 2;
  robot.tick(500);
  check(distance(robot.tip(), stands) < 1e-5, "resumed after a twist and a lock: displacement [m, rad]",
        distance(robot.tip(), stands));
  robot.q[3] += 0.2;  // A fault, then a lock.
  robot.held = true;
  robot.tick(500);
  robot.command_locks[4].calls = 1;
  robot.tick(10);
  robot.held = false;
  Transform<> elsewhere = goal;
  elsewhere.p(1) += 0.1;
  robot.hear("~/target_pose", pose_message(elsewhere));
  robot.tick(300);
  check(robot.speed() == 0.0, "a lock after a fault: speed [rad/s]", robot.speed());
}

void for_good() {
  Robot robot;
  check(robot.load() && robot.activate(), "a joint locked permanently: activated", 1);
  const Transform<> start = robot.tip();
  for (int i = 0; i < 300; ++i) {
    swing(robot, start, i);
    robot.tick();
  }
  robot.watched = false;
  robot.command_locks[2].calls = 100;
  robot.tick(100);
  (void)logged("");
  const auto& said = robot.said<DiagnosticArray>("/diagnostics").last.status.at(0);
  check(said.level == DiagnosticStatus::ERROR, "a joint locked permanently: level of the diagnostics", said.level);
  check(logged("panda_joint3"), "a joint locked permanently: named", 1);
  robot.tick(1);
  const auto after = robot.command;
  robot.tick(500);
  check(robot.command == after, "a joint locked permanently: keeps its last command", 1);
  check(robot.allocated == 0, "a joint locked permanently: allocations", static_cast<double>(robot.allocated));
}

void at_deactivation() {
  Robot robot;
  check(robot.load() && robot.activate(), "locked at deactivation: activated", 1);
  robot.tick(10);
  robot.command_locks[8].calls = 1;
  robot.deactivate();
  check(robot.state == Lifecycle::kInactive, "locked at deactivation: inactive", 1);
  check(robot.state == Lifecycle::kInactive && robot.activate(), "locked at deactivation: activated again", 1);
}

}  // namespace

void locks() {
  one_by_one();
  resumed();
  for_good();
  at_deactivation();
}
