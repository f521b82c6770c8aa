#include <cmath>
#include <diagnostic_msgs/msg/diagnostic_array.hpp>

#include "check.hpp"
#include "tests.hpp"

namespace {

using diagnostic_msgs::msg::DiagnosticArray;
using diagnostic_msgs::msg::DiagnosticStatus;
using fpbm::Transform;
using geometry_msgs::msg::PoseStamped;
using stand_in::Robot;

/// Other threads lock the interfaces: for 3 ticks, then until the arm has stopped.
void locked(Robot& robot) {
  const Transform<> start = robot.tip();
  Transform<> elsewhere = start;
  elsewhere.p(2) += 0.1;
  robot.watched = false;  // No check of the limits: after too many locked ticks, the arm stops immediately.
  robot.hear("~/target_pose", pose_message(elsewhere, 12.0));
  robot.tick(200);
  stand_in::locked = true;
  robot.tick(3);
  stand_in::locked = false;
  robot.tick(3000);
  check(distance(robot.tip(), elsewhere) < 1e-5, "locked for 3 ticks: distance from the target [m, rad]",
        distance(robot.tip(), elsewhere));
  const auto& said = robot.said<DiagnosticArray>("/diagnostics");
  check(said.last.status.at(0).values.at(5).value == "3", "locked for 3 ticks: missed", 3);

  robot.hear("~/target_pose", pose_message(start, 16.0));
  robot.tick(200);
  stand_in::locked = true;
  robot.tick(1000);
  stand_in::locked = false;
  robot.tick(500);
  check(robot.speed() == 0.0 && distance(robot.tip(), start) > 0.01, "locked permanently: speed at the end [rad/s]",
        robot.speed());
  (void)robot.said<DiagnosticArray>("/diagnostics");
  check(said.last.status.at(0).level == DiagnosticStatus::ERROR, "locked permanently: level of the diagnostics",
        said.last.status.at(0).level);
  robot.deactivate();
  check(robot.activate(), "locked permanently: activated again", 1);
  robot.watched = true;
}

void following_error(Robot& robot) {
  const Transform<> start = robot.tip();
  Transform<> elsewhere = start;
  elsewhere.p(1) -= 0.15;
  robot.hear("~/target_pose", pose_message(elsewhere, 20.0));
  robot.held = true;
  robot.tick(1500);
  double off = 0.0;
  for (std::size_t i = 0; i < Robot::kDof; ++i) off = std::max(off, std::abs(robot.q[i] - robot.command[i]));
  check(off > 0.05 && off < 0.1, "held arm: distance of the command, bound 0.05 [rad]", off);
  check(robot.speed() == 0.0, "held arm: speed of the command [rad/s]", robot.speed());
  const auto& status = robot.said<DiagnosticArray>("/diagnostics").last.status.at(0);
  check(status.level == DiagnosticStatus::ERROR, "held arm: level of the diagnostics", status.level);
  check(logged("panda_joint"), "held arm: the stop is logged, with its joint", 1);
  (void)robot.said<DiagnosticArray>("/diagnostics");
  check(!logged("panda_joint"), "held arm: the stop is logged once", 1);
  robot.held = false;  // The arm is released, and moves to its command.
  robot.tick(100);
  const auto& later = robot.said<DiagnosticArray>("/diagnostics").last.status.at(0);
  const double at_stop = std::stod(later.values.at(3).value);
  check(at_stop > 0.05, "held arm: following error at the stop, still shown [rad]", at_stop);
  robot.held = true;
}

void states(Robot& robot) {
  const auto before = robot.command;
  robot.deactivate();
  check(robot.command == before, "deactivated: the command is the last", 1);
  const int count = robot.said<PoseStamped>("~/tip_pose").count;
  check(robot.said<PoseStamped>("~/tip_pose").count == count, "deactivated: tip poses published", 0);
  robot.hear("~/target_pose", pose_message(Transform<>{}, 30.0));  // No controller is active.

  robot.held = false;
  check(robot.activate(), "activated again", 1);
  const auto stands = robot.q;
  robot.tick(500);
  double displacement = 0.0;
  for (std::size_t i = 0; i < Robot::kDof; ++i) displacement = std::max(displacement, std::abs(robot.q[i] - stands[i]));
  check(displacement < 1e-9, "activated again: displacement from the measured posture [rad]", displacement);
  Transform<> elsewhere = robot.tip();
  elsewhere.p(1) += 0.05;
  robot.hear("~/target_pose", pose_message(elsewhere, 31.0));
  robot.tick(4000);
  check(distance(robot.tip(), elsewhere) < 1e-5, "activated again: distance from a target [m, rad]",
        distance(robot.tip(), elsewhere));

  Transform<> out_of_reach = elsewhere;
  out_of_reach.p(0) += 2.0;
  robot.hear("~/target_pose", pose_message(out_of_reach, 36.0));
  robot.tick(20000);
  check(robot.speed() < 1e-3, "unreachable target: speed at the end [rad/s]", robot.speed());

  // If the arm moves at deactivation, the velocity commands become zero immediately.
  robot.hear("~/target_pose", pose_message(elsewhere, 60.0));
  robot.tick(300);
  const double moving = robot.speed();
  robot.deactivate();
  double command = 0.0;
  for (const double v : robot.velocity) command = std::max(command, std::abs(v));
  check(moving > 0.01 && command == 0.0, "deactivated in motion: velocity command [rad/s]", command);

  robot.q[3] = 0.5;  // Beyond the range of joint 4.
  check(!robot.activate() && logged("panda_joint4"), "not activated beyond a limit, joint named", 1);
}

}  // namespace

void faults(Robot& robot) {
  locked(robot);
  following_error(robot);
  states(robot);
}
