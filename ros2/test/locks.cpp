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
  if (i % 10 == 0) robot.hear("~/target_pose", pose_message(pose));
}

void one_by_one() {
  Robot robot;
  check(robot.load() && robot.activate(), "locks one by one: activated", 1);
  const Transform<> start = robot.tip();
  std::mt19937 random(3);
  double fastest = 0.0;
  for (int i = 0; i < 4000; ++i) {
    swing(robot, start, i);
    if (i % 37 == 0) robot.command_locks[random() % (2 * Robot::kDof)].calls = 1 + static_cast<int>(random() % 3);
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
  for_good();
  at_deactivation();
}
