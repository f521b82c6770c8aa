#include <limits>
#include <stdexcept>
#include <string>

#include "stream_robot.hpp"
#include "tests.hpp"

namespace {

using diagnostic_msgs::msg::DiagnosticStatus;
using rclcpp::ParameterValue;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Wrong messages are dropped with a warning that has the reason, and the motion continues.
void wrong_messages() {
  StreamRobot robot;
  check(robot.load() && robot.activate(), "wrong messages: activated", 1);
  const Posture goal = wave(1.0);
  robot.hear("~/joint_trajectory", message(goal));
  const auto dropped = [&](const char* what, const std::string& topic, const auto& wrong, const std::string& text) {
    robot.tick(20);
    (void)logged("");
    robot.hear("~/" + topic, wrong);
    check(logged(topic + " dropped: " + text), (std::string("wrong messages, ") + what).c_str(), 1);
  };
  const auto trajectory = [&](const char* what, const std::string& text, const auto& change) {
    JointTrajectory sent = message(0.0, 3, wave);
    change(sent);
    dropped(what, "joint_trajectory", sent, text);
  };
  trajectory("a missing joint", "joint_names: has no 'panda_joint3': give",
             [](auto& sent) { sent.joint_names[4] = "finger"; });
  trajectory("a joint too many", "joint_names: 'finger' is not a joint of the controller",
             [](auto& sent) { sent.joint_names.push_back("finger"); });
  trajectory("a joint twice", "joint_names: has 8 names for 7 joints",
             [](auto& sent) { sent.joint_names.push_back("panda_joint1"); });
  trajectory("no points", "points: has 0 points: must have 1 to 128", [](auto& sent) { sent.points.clear(); });
  trajectory("129 points", "points: has 129 points", [](auto& sent) { sent = message(0.0, 129, wave); });
  trajectory("six positions", "points[1].positions: has 6 numbers: must have 7",
             [](auto& sent) { sent.points[1].positions.pop_back(); });
  trajectory("one velocity", "points[0].velocities: has 1 numbers",
             [](auto& sent) { sent.points[0].velocities = {0.0}; });
  trajectory("an acceleration", "points[2].accelerations: is inf for joint 'panda_joint7'", [](auto& sent) {
    sent.points[2].accelerations.assign(7, 0.0);
    sent.points[2].accelerations[0] = std::numeric_limits<double>::infinity();
  });
  trajectory("a position", "points[1].positions: is nan for joint 'panda_joint1'",
             [](auto& sent) { sent.points[1].positions[6] = kNan; });
  trajectory("equal times", "points[2].time_from_start: is 0.020000 s: must be greater",
             [](auto& sent) { sent.points[2].time_from_start = sent.points[1].time_from_start; });
  trajectory("degrees", "points[0].positions: is -17.188734 for joint 'panda_joint2', far outside its range, -1.76",
             [](auto& sent) {
               for (double& q : sent.points[0].positions) q *= 180.0 / 3.14159265358979;
             });
  Float64MultiArray single;
  dropped("an empty posture", "joint_positions", single, "data: has 0 numbers: must have 7, one for each joint");
  single.data = list(kStart);
  single.data[3] = 1.0;
  dropped("a posture beyond its range", "joint_positions", single, "data: is 1.000000 for joint 'panda_joint4'");
  single.data[3] = kNan;
  dropped("a posture of NaN", "joint_positions", single, "data: is nan for joint 'panda_joint4': must be finite");
  robot.tick(2000);
  check(robot.from(goal) < 1e-6, "wrong messages: distance from the last good posture [rad]", robot.from(goal));
  single.data = list(kStart);
  single.data[3] = -0.05;  // The range ends at -0.0698.
  robot.hear("~/joint_positions", single);
  robot.tick(3000);
  check(std::abs(robot.command[3] + 0.0698) < 1e-6, "a posture little beyond a range: the joint is at the end [rad]",
        robot.command[3]);
  limits_hold(robot, "wrong messages");
}

void stamps() {
  StreamRobot robot;
  check(robot.load() && robot.activate(), "stamps of chunks: activated", 1);
  robot.hear("~/joint_trajectory", message(1.0, 10, wave));
  robot.tick(50);
  (void)robot.status();
  robot.hear("~/joint_trajectory", message(100.0, 10, wave));
  robot.tick(10);
  check(robot.status().message.find("too far ahead") != std::string::npos, "a chunk far ahead: diagnostics", 1);
  robot.hear("~/joint_trajectory", message(0.9, 10, wave));
  robot.tick(10);
  const auto status = robot.status();
  check(status.message.find("not newer") != std::string::npos, "a chunk of the past: diagnostics", 1);
  check(value(status, "targets rejected") == "2", "chunks rejected because of their stamps", 2);
}

void configurations() {
  const auto refused = [](const std::string& name, const ParameterValue& value, const std::string& text) {
    StreamRobot robot;
    (void)logged("");
    const bool loaded = robot.load({{name, value}});
    check(!loaded && logged(text), ("streams: " + name + " refused, named").c_str(), loaded);
  };
  refused("tasks", ParameterValue(std::vector<std::string>{"hand"}), "tasks: is not empty, but input is 'joints'");
  refused("tip_frame", ParameterValue(std::string()), "tip_frame: is empty");
  refused("input", ParameterValue(std::string("joint")), "input");
  refused("scheme.k1", ParameterValue(1e5), "scheme.k1");
  refused("stream.delay", ParameterValue(std::numeric_limits<double>::infinity()),
          "stream.delay: is inf: must be finite");
  refused("stream.blend", ParameterValue(kNan), "parameter 'stream.blend' is invalid\n");
  refused("stream.blend", ParameterValue(-0.1), "parameter 'stream.blend' is invalid\n");
  refused("stream.blend", ParameterValue(std::numeric_limits<double>::infinity()),
          "stream.blend: is inf: must be finite\n");
  refused("stream.keep_path", ParameterValue(1e-3), "stream.keep_path: is 0.001000: must be 0 or at least 0.004176");
  refused("stream.keep_path", ParameterValue(-0.1), "parameter 'stream.keep_path' is invalid\n");
  refused("stream.keep_path", ParameterValue(std::numeric_limits<double>::infinity()),
          "stream.keep_path: is inf: must be finite\n");
  refused("stream.dely", ParameterValue(0.1), "stream.dely: is not a parameter of this controller: give stream.delay");
  const auto has = [](stand_in::Robot& robot, const std::string& topic) {
    try {
      return robot.subscription<JointTrajectory>(topic) != nullptr;
    } catch (const std::exception&) {  // There is no topic, or a topic of another type.
      return false;
    }
  };
  StreamRobot joints;
  check(joints.load() && has(joints, "~/joint_trajectory"), "streams: topic of trajectories", 1);
  bool absent = false;
  try {
    (void)joints.subscription<geometry_msgs::msg::PoseStamped>("~/target_pose");
  } catch (const std::out_of_range&) {
    absent = true;
  }
  check(absent, "streams: no topic of poses", 1);
  stand_in::Robot poses;
  check(poses.load() && !has(poses, "~/joint_trajectory"), "poses: no topic of trajectories", 1);
}

}  // namespace

void joint_messages() {
  wrong_messages();
  stamps();
  configurations();
}
