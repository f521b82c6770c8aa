#include <cmath>
#include <hardware_interface/component_parser.hpp>
#include <limits>
#include <string>

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

/// The manager enforces soft limits 0.3 rad inside of the ranges, which a stream of targets reaches.
void soft_limits() {
  for (const double k : {4.0, 20.0, 100.0}) {
    Robot robot;
    const std::string what = "soft limits, k_position " + std::to_string(static_cast<int>(k)) + ": ";
    auto& described = stand_in::hardware()["panda"];
    for (const auto& joint : fpbm::presets::panda().joints) {
      joint_limits::SoftJointLimits soft;
      soft.min_position = joint.bounds.lower + 0.3;
      soft.max_position = joint.bounds.upper - 0.3;
      soft.k_position = k;
      described.soft_limits[joint.name] = soft;
      robot.soft_limits.push_back(soft);
    }
    check(robot.load() && robot.activate(), (what + "activated").c_str(), 1);
    stand_in::hardware().clear();
    const Transform<> start = robot.tip();
    double nearest = 1.0;
    for (int i = 0; i < 6000; ++i) {
      Transform<> pose = start;
      pose.p += fpbm::Vector<3>(0.3, 0.4, 0.5) * std::sin(2e-3 * i);
      pose.R = fpbm::rotation(fpbm::Vector<3>(0.0, 0.0, 2.5 * std::sin(1.5e-3 * i))) * pose.R;
      if (i % 20 == 0) robot.hear("~/target_pose", pose_message(pose));
      robot.tick();
      for (std::size_t j = 0; j < Robot::kDof; ++j) {
        const auto& soft = robot.soft_limits[j];
        nearest = std::min({nearest, robot.command[j] - soft.min_position, soft.max_position - robot.command[j]});
      }
    }
    check(nearest < 0.1, (what + "smallest distance from a soft limit [rad]").c_str(), nearest);
    check(robot.enforced == 0, (what + "ticks in which the manager changed a command").c_str(), robot.enforced);
    check(robot.jerk_excess < 1e-3, (what + "ratio of the jerk excess to the limit").c_str(), robot.jerk_excess);
  }
}

}  // namespace

void activation() {
  offset();
  lag();
  moving();
  unusable();
  soft_limits();
}
