#include <diagnostic_msgs/msg/diagnostic_array.hpp>

#include "check.hpp"
#include "tests.hpp"

namespace {

using diagnostic_msgs::msg::DiagnosticArray;
using diagnostic_msgs::msg::DiagnosticStatus;
using fpbm::Transform;
using geometry_msgs::msg::PoseStamped;
using geometry_msgs::msg::TwistStamped;
using stand_in::Robot;

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
  life();
}
