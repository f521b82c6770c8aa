#include <cmath>
#include <limits>

#include "check.hpp"
#include "tests.hpp"

namespace {

using fpbm::Transform;
using stand_in::Robot;

double change(const Robot::Joints& a, const Robot::Joints& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < Robot::kDof; ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

void in_motion(Robot& robot) {
  Transform<> elsewhere = robot.tip();
  elsewhere.p(1) += 0.3;
  robot.hear("~/target_pose", pose_message(elsewhere));
  robot.tick(500);
  check(robot.speed() > 0.3, "deactivated in motion: speed [rad/s]", robot.speed());
  robot.deactivate();
}

void offset() {
  Robot robot;
  robot.offset = -0.01;
  check(robot.load() && robot.activate(), "offset of 0.01 rad: activated", 1);
  robot.tick(50);
  const auto before = robot.command;
  for (int i = 0; i < 5; ++i) {
    robot.deactivate();
    check(robot.activate(), "offset of 0.01 rad: activated again", i);
    robot.tick(100);
  }
  check(change(robot.command, before) < 1e-9, "offset of 0.01 rad: creep in 5 activations [rad]",
        change(robot.command, before));
}

void lag() {
  Robot robot;
  robot.lag = 10;
  check(robot.load() && robot.activate(), "lag of 10 ms: activated", 1);
  in_motion(robot);
  check(robot.activate(), "lag of 10 ms: activated in motion", 1);
  robot.tick(10);
  check(robot.excess < 1e-9, "lag of 10 ms: velocity beyond a limit [rad/s]", robot.excess);
}

void moving() {
  Robot robot;
  stand_in::parameters.state_interfaces = {"position", "velocity"};
  robot.lag = 10;
  check(robot.load() && robot.activate(), "velocities measured: activated at rest", 1);
  in_motion(robot);
  check(!robot.activate() && logged("moves"), "velocities measured: not activated in motion", 1);
  robot.tick(100);
  check(robot.activate(), "velocities measured: activated at rest again", 1);
}

/// The command of another controller is too far from the arm; a reading is NaN; an interface is locked.
void unusable() {
  Robot robot;
  check(robot.load(), "configured", 1);
  robot.command = robot.q;
  robot.command[2] += 0.2;
  const auto stands = robot.q;
  check(robot.activate(), "a command far away: activated", 1);
  robot.tick(10);
  check(change(robot.command, stands) < 1e-9, "a command far away: command from where the arm stands [rad]",
        change(robot.command, stands));
  robot.deactivate();
  (void)logged("");
  robot.q[2] = std::numeric_limits<double>::quiet_NaN();
  check(!robot.activate() && logged("panda_joint3"), "a position that is NaN: not activated, joint named", 1);
  robot.q[2] = stands[2];
  robot.state_locks[4].calls = 1;
  check(!robot.activate() && logged("panda_joint5"), "a position that is locked: not activated, joint named", 1);
  check(robot.activate(), "activated once all can be read", 1);
}

}  // namespace

void activation() {
  offset();
  lag();
  moving();
  unusable();
}
