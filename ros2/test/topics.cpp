#include <algorithm>
#include <diagnostic_msgs/msg/diagnostic_array.hpp>
#include <limits>
#include <robot.hpp>
#include <std_msgs/msg/float64.hpp>

#include "check.hpp"
#include "tests.hpp"

namespace {

using diagnostic_msgs::msg::DiagnosticArray;
using diagnostic_msgs::msg::DiagnosticStatus;
using fpbm::Transform;
using geometry_msgs::msg::PoseStamped;
using geometry_msgs::msg::TwistStamped;
using stand_in::Robot;
using std_msgs::msg::Float64;

void quality_of_service() {
  Robot robot;
  check(robot.load() && robot.activate(), "QoS: activated", 1);
  for (const auto& qos : {robot.subscription<PoseStamped>("~/target_pose")->qos(),
                          robot.subscription<TwistStamped>("~/target_twist")->qos()}) {
    check(qos.depth() == 1, "QoS: messages that wait", static_cast<double>(qos.depth()));
  }
  Transform<> elsewhere = robot.tip();
  elsewhere.p(1) += 0.05;
  robot.hear("~/target_pose", pose_message(elsewhere), rclcpp::SensorDataQoS());
  robot.tick(2000);
  check(distance(robot.tip(), elsewhere) < 1e-5, "QoS: distance from the target of a sensor [m, rad]",
        distance(robot.tip(), elsewhere));
}

/// A stamp from the past is rejected with a warning. If the first stamp is from the future, targets after a pause are
/// accepted.
void stamps() {
  Robot robot;
  check(robot.load() && robot.activate(), "stamps: activated", 1);
  Transform<> elsewhere = robot.tip();
  robot.hear("~/target_pose", pose_message(elsewhere, 3600.0));
  robot.tick(11000);
  elsewhere.p(1) += 0.05;
  robot.hear("~/target_pose", pose_message(elsewhere, 11.0));
  robot.tick(3000);
  check(distance(robot.tip(), elsewhere) < 1e-5, "a stamp of the future, a silence, then a target: distance [m, rad]",
        distance(robot.tip(), elsewhere));
  (void)robot.said<DiagnosticArray>("/diagnostics");
  (void)logged("");
  robot.hear("~/target_pose", pose_message(elsewhere, 5.0));
  robot.tick(10);
  const auto status = robot.said<DiagnosticArray>("/diagnostics").last.status.at(0);
  check(status.level == DiagnosticStatus::WARN, "a stamp of the past: level of the diagnostics", status.level);
  check(logged("rejected"), "a stamp of the past: logged", 1);
  robot.tick(10);
  const auto later = robot.said<DiagnosticArray>("/diagnostics").last.status.at(0);
  check(later.level == DiagnosticStatus::OK, "a stamp of the past: level later", later.level);
}

/// Largest velocity of the tip in a number of ticks, per axis [m/s].
double fastest(Robot& robot, int ticks) {
  double largest = 0.0;
  for (int i = 0; i < ticks; ++i) {
    const Transform<> before = robot.tip();
    robot.tick();
    largest = std::max(largest, (robot.tip().p - before.p).cwiseAbs().maxCoeff() * robot.rate);
  }
  return largest;
}

std_msgs::msg::Float64 speed_message(double fraction) {
  std_msgs::msg::Float64 message;
  message.data = fraction;
  return message;
}

/// The speed reduces the bound on the velocity of the tip, 0.5 m/s, in motion and after another activation. Invalid
/// speeds are dropped with a warning.
void speeds() {
  Robot robot;
  check(robot.load() && robot.activate(), "speed: activated", 1);
  check(robot.subscription<Float64>("~/speed")->qos().depth() == 1, "speed: messages that wait", 1);
  Transform<> elsewhere = robot.tip();
  elsewhere.p(1) += 0.4;
  robot.hear("~/target_pose", pose_message(elsewhere));
  const double full = fastest(robot, 450);
  robot.hear("~/speed", speed_message(0.1), rclcpp::SensorDataQoS());
  (void)fastest(robot, 350);  // The deceleration.
  const double reduced = fastest(robot, 300);
  check(full > 0.2, "speed 1: velocity of the tip [m/s]", full);
  check(0.04 < reduced && reduced < 0.0501, "speed 0.1: velocity of the tip [m/s]", reduced);
  const int before = stand_in::warnings;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double wrong : {std::numeric_limits<double>::quiet_NaN(), 0.0, -0.5, 1.001, kInfinity, -kInfinity}) {
    robot.hear("~/speed", speed_message(wrong));
    const double same = fastest(robot, 10);
    check(0.04 < same && same < 0.0501, "speed: velocity of the tip after an invalid message [m/s]", same);
  }
  check(stand_in::warnings == before + 6, "speed: warnings of invalid messages", stand_in::warnings - before);
  check(logged("speed dropped: it is 1.001000, and must be in (0, 1]"), "speed: logged", 1);
  const auto status = robot.said<DiagnosticArray>("/diagnostics").last.status.at(0);
  check(std::any_of(status.values.begin(), status.values.end(),
                    [](const auto& each) { return each.key == "speed" && each.value == "0.100000"; }),
        "speed: in the diagnostics", 1);
  robot.tick(12000);
  robot.deactivate();
  check(robot.activate(), "speed: activated again", 1);
  elsewhere.p(1) -= 0.2;
  robot.hear("~/target_pose", pose_message(elsewhere));
  const double again = fastest(robot, 1000);
  check(0.04 < again && again < 0.0501, "speed 0.1: velocity of the tip after another activation [m/s]", again);
  robot.hear("~/speed", speed_message(1.0));
  robot.tick(2000);
  check(distance(robot.tip(), elsewhere) < 1e-5, "speed 1: distance from the target [m, rad]",
        distance(robot.tip(), elsewhere));
  check(robot.allocated == 0, "speed: allocations", static_cast<double>(robot.allocated));
  check(robot.excess < 1e-9, "speed: position, velocity beyond a limit [rad, rad/s]", robot.excess);
  check(robot.acceleration_excess < 1e-6, "speed: ratio of the acceleration excess to the limit",
        robot.acceleration_excess);
  check(robot.jerk_excess < 1e-3, "speed: ratio of the jerk excess to the limit", robot.jerk_excess);
}

void life() {
  Robot robot;
  check(robot.load() && robot.activate(), "cleanup: activated", 1);
  const auto late = robot.subscription<PoseStamped>("~/target_pose");
  robot.tick(10);
  robot.deactivate();
  check(robot.cleanup(), "cleanup", 1);
  stand_in::parameters.base_frame = "base_link";
  late->hear(pose_message(robot.tip()));  // A callback during the cleanup.
  const long held = robot.alive<PoseStamped>("~/target_pose") ? late.use_count() : 1;
  check(held == 1, "cleanup: holders of a subscription that is in use", static_cast<double>(held));
  check(robot.configure() && robot.activate(), "configured and activated again", 1);
  Transform<> elsewhere = robot.tip();
  elsewhere.p(1) += 0.05;
  robot.hear("~/target_pose", pose_message(elsewhere));
  robot.tick(2000);
  check(distance(robot.tip(), elsewhere) < 1e-5, "configured again: distance from a target [m, rad]",
        distance(robot.tip(), elsewhere));
}

}  // namespace

void topics() {
  quality_of_service();
  stamps();
  speeds();
  life();
}
