#include <cmath>
#include <diagnostic_msgs/msg/diagnostic_array.hpp>
#include <limits>
#include <string>

#include "check.hpp"
#include "tests.hpp"

namespace {

using diagnostic_msgs::msg::DiagnosticArray;
using fpbm::Transform;
using rclcpp::ParameterValue;
using stand_in::Robot;

std::string diagnosis(Robot& robot) {
  return robot.said<DiagnosticArray>("/diagnostics").last.status.at(0).message;
}

/// The advice for a stalled arm names only actions of ROS.
void stall() {
  Robot robot;
  check(robot.load() && robot.activate(), "a stall: activated", 1);
  Transform<> unreachable = robot.tip();
  unreachable.p(0) += 2.0;
  robot.hear("~/target_pose", pose_message(unreachable));
  std::string slowed;
  std::string stalled;
  for (int i = 0; i < 400 && stalled.empty(); ++i) {
    robot.tick(100);
    const std::string text = diagnosis(robot);
    if (text.find("limit") != std::string::npos) slowed = text;
    if (text.find("no progress") != std::string::npos || text.find("stall") != std::string::npos) stalled = text;
  }
  std::printf("     %s\n     %s\n", slowed.c_str(), stalled.c_str());
  check(!stalled.empty() && stalled.find("resume()") == std::string::npos, "a stall: advice without functions", 1);
  check(!stalled.empty() && stalled.find("another target") != std::string::npos, "a stall: advice of ROS", 1);
  check(slowed.find("AxisTask") == std::string::npos, "a slow arm: advice without classes", 1);
}

void stamps() {
  Robot robot;
  check(robot.load() && robot.activate(), "stamps: activated", 1);
  robot.hear("~/target_pose", pose_message(robot.tip(), 1.0));
  robot.tick(50);
  (void)logged("");
  robot.hear("~/target_pose", pose_message(robot.tip(), 100.0));
  robot.tick(10);
  check(diagnosis(robot).find("too far ahead") != std::string::npos, "a stamp far ahead: diagnostics", 1);
  check(logged("1 target rejected: its stamp is too far ahead of earlier stamps"), "a stamp far ahead: logged", 1);
  robot.hear("~/target_pose", pose_message(robot.tip(), 0.9));
  robot.tick(10);
  robot.hear("~/target_pose", pose_message(robot.tip(), 0.8));
  robot.tick(10);
  check(diagnosis(robot).find("not newer") != std::string::npos, "stamps of the past: diagnostics", 1);
  check(logged("2 targets rejected: the last stamp is not newer than earlier stamps"), "stamps of the past: logged", 1);
  robot.command_locks[1].calls = 1;
  robot.tick(10);
  (void)diagnosis(robot);
  check(logged("1 tick with"), "a locked tick: logged", 1);
}

/// Numbers that are not finite are rejected with the whole name of the parameter.
void names() {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  const auto refused = [](const std::string& name, const ParameterValue& value, const std::string& text) {
    Robot robot;
    (void)logged("");
    const bool loaded = robot.load({{name, value}});
    check(!loaded && logged(text), (name + ": refused, named").c_str(), loaded);
  };
  const std::vector<double> third{1.0, 1.0, nan, 1.0, 1.0, 1.0, 1.0};
  for (const char* name : {"scheme.weights", "scheme.rest_posture", "limits.lower", "limits.jerk"}) {
    refused(name, ParameterValue(third), name + std::string(": is nan for joint 'panda_joint3': must be finite"));
  }
  refused("scheme.weights", ParameterValue(std::vector<double>(6, 1.0)), "has 6 entries: must have 7");
  for (const char* name : {"tool.xyz", "tool.rpy"}) {
    refused(name, ParameterValue(std::vector<double>{0.0, infinity, 0.0}),
            name + std::string(": is inf: must be finite"));
  }
  for (const char* name : {"scheme.k1", "scheme.k2", "scheme.null_damping", "scheme.rest_stiffness", "target.velocity",
                           "target.acceleration", "target.jerk", "target.angular_velocity",
                           "target.angular_acceleration", "target.angular_jerk", "target.timeout", "following_error"}) {
    refused(name, ParameterValue(infinity), name + std::string(": is inf: must be finite"));
  }
  refused("scheme.alpha", ParameterValue(nan), "scheme.alpha: is nan: must be finite");
  refused("scheme.rest_stiffness", ParameterValue(1e9), "scheme.rest_stiffness = 1e+09");
  refused("scheme.null_damping", ParameterValue(1e6), "with rest_stiffness");
}

}  // namespace

void wording() {
  stall();
  stamps();
  names();
}
