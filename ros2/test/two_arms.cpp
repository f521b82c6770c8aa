#include "check.hpp"

#include <algorithm>
#include <cmath>
#include <diagnostic_msgs/msg/diagnostic_array.hpp>
#include <limits>
#include <std_msgs/msg/float64.hpp>
#include <string>
#include <two_arms.hpp>

#include "tests.hpp"

namespace {

using diagnostic_msgs::msg::DiagnosticArray;
using diagnostic_msgs::msg::DiagnosticStatus;
using fpbm::Transform;
using geometry_msgs::msg::PoseStamped;
using geometry_msgs::msg::TwistStamped;
using stand_in::TwoArms;

/// Sets parameters with a task for each flange.
void give_hands() {
  auto& own = stand_in::parameters;
  own.tasks = {"left", "right"};
  own.task.tasks_map["left"].frame = "left_flange";
  own.task.tasks_map["right"].frame = "right_flange";
}

PoseStamped in_table(const Transform<>& pose) {
  PoseStamped message = pose_message(pose);
  message.header.frame_id = "table";
  return message;
}

double change(const TwoArms::Joints& a, const TwoArms::Joints& b, std::size_t first, std::size_t last) {
  double largest = 0.0;
  for (std::size_t i = first; i < last; ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

void within_limits(const TwoArms& robot, const std::string& what) {
  check(robot.excess < 1e-9, (what + ": position, velocity beyond a limit [rad, rad/s]").c_str(), robot.excess);
  check(robot.acceleration_excess < 1e-6, (what + ": ratio of the acceleration excess to the limit").c_str(),
        robot.acceleration_excess);
  check(robot.jerk_excess < 1e-3, (what + ": ratio of the jerk excess to the limit").c_str(), robot.jerk_excess);
  check(robot.allocated == 0, (what + ": allocations").c_str(), static_cast<double>(robot.allocated));
}

/// Value of a key in the diagnostics; empty if the key is missing.
std::string value_of(TwoArms& robot, const std::string& key) {
  const auto status = robot.said<DiagnosticArray>("/diagnostics").last.status.at(0);
  for (const auto& each : status.values) {
    if (each.key == key) return each.value;
  }
  return "";
}

/// A message moves only the arm of its task.
void one_hand(TwoArms& robot) {
  const auto before = robot.command;
  Transform<> left = robot.tip("left");
  left.p += fpbm::Vector<3>(0.1, 0.05, 0.1);
  robot.hear("~/left/target_pose", in_table(left));
  robot.tick(2500);
  check(distance(robot.tip("left"), left) < 1e-5, "left hand alone: distance from its target [m, rad]",
        distance(robot.tip("left"), left));
  const double still = change(robot.command, before, 7, 14);
  check(still < 1e-9, "left hand alone: motion of the right arm [rad]", still);
}

/// Target pose of a flange at t [s]. side: 1 for left, -1 for right.
Transform<> led(const Transform<>& start, double side, double t) {
  Transform<> pose = start;
  const double share = std::pow(std::sin(1.5 * std::min(t, 2.0)), 2);
  pose.p += fpbm::Vector<3>(0.05, 0.1 * side, 0.08 - 0.04 * side) * share;
  pose.R = fpbm::rotation(fpbm::Vector<3>(0.0, 0.2 * share, 0.3 * side * share)) * pose.R;
  return pose;
}

void both_hands(TwoArms& robot) {
  const Transform<> left = robot.tip("left");
  const Transform<> right = robot.tip("right");
  for (int i = 0; i < 4000; ++i) {
    const double t = 1e-3 * i;
    if (i % 50 == 0) robot.hear("~/left/target_pose", in_table(led(left, 1.0, t)));
    if (i % 50 == 25) robot.hear("~/right/target_pose", in_table(led(right, -1.0, t)));
    robot.tick();
  }
  const double off =
      std::max(distance(robot.tip("left"), led(left, 1.0, 4.0)), distance(robot.tip("right"), led(right, -1.0, 4.0)));
  check(off < 1e-5, "both hands: distance from their targets [m, rad]", off);
  for (const std::string side : {"left", "right"}) {
    const auto& tip = robot.said<PoseStamped>("~/" + side + "/tip_pose").last;
    const double error = distance(fpbm_controllers::target_of(tip)->pose, robot.tip(side));
    check(error < 1e-9 && tip.header.frame_id == "table", (side + " tip_pose: distance [m, rad]").c_str(), error);
  }
  TwistStamped twist;
  twist.header.frame_id = "table";
  twist.twist.linear.z = -0.05;
  const Transform<> before = robot.tip("right");
  for (int i = 0; i < 1000; ++i) {
    if (i % 50 == 0) robot.hear("~/right/target_twist", twist);
    robot.tick();
  }
  robot.tick(2000);
  const double rise = robot.tip("right").p(2) - before.p(2);  // [m]
  check(std::abs(rise + 0.05 * 1.15) < 0.004, "right hand: displacement at a twist down [m]", rise);
}

/// The speed applies to the targets of all tasks.
void slow_hands(TwoArms& robot) {
  std_msgs::msg::Float64 speed;
  speed.data = 0.2;
  robot.hear("~/speed", speed);
  const Transform<> start[] = {robot.tip("left"), robot.tip("right")};
  TwistStamped twist;
  twist.header.frame_id = "table";
  twist.twist.linear.z = 0.3;  // Above 0.2 times the bound of 0.5 m/s.
  double fastest[] = {0.0, 0.0};
  for (int i = 0; i < 500; ++i) {
    const Transform<> before[] = {robot.tip("left"), robot.tip("right")};
    if (i % 50 == 0) robot.hear("~/left/target_twist", twist);
    if (i % 50 == 0) robot.hear("~/right/target_twist", twist);
    robot.tick();
    fastest[0] = std::max(fastest[0], 1e3 * (robot.tip("left").p - before[0].p).cwiseAbs().maxCoeff());
    fastest[1] = std::max(fastest[1], 1e3 * (robot.tip("right").p - before[1].p).cwiseAbs().maxCoeff());
  }
  check(0.09 < fastest[0] && fastest[0] < 0.1001, "both hands, speed 0.2: velocity of the left [m/s]", fastest[0]);
  check(0.09 < fastest[1] && fastest[1] < 0.1001, "both hands, speed 0.2: velocity of the right [m/s]", fastest[1]);
  speed.data = 1.0;
  robot.hear("~/speed", speed);
  robot.hear("~/left/target_pose", in_table(start[0]));
  robot.hear("~/right/target_pose", in_table(start[1]));
  robot.tick(3000);
}

/// Each task has its own frame, stamps and counts.
void refused(TwoArms& robot) {
  robot.tick(5000);  // Both arms stop.
  Transform<> elsewhere = robot.tip("right");
  elsewhere.p(2) += 0.1;
  const auto before = robot.command;
  (void)logged("");
  PoseStamped message = in_table(elsewhere);
  message.header.frame_id = "left_base";
  robot.hear("~/right/target_pose", message);
  robot.tick(300);
  check(logged("task 'right' dropped: its frame is 'left_base', not 'table'"), "another frame: logged with its task",
        1);
  check(change(robot.command, before, 0, 14) < 1e-6, "another frame: motion [rad]",
        change(robot.command, before, 0, 14));
  message = in_table(robot.tip("left"));
  message.header.stamp = rclcpp::Time(2000000000000);
  robot.hear("~/left/target_pose", message);
  robot.tick(10);
  message.header.stamp = rclcpp::Time(1000000000000);
  robot.hear("~/left/target_pose", message);
  robot.tick(10);
  const auto status = robot.said<DiagnosticArray>("/diagnostics").last.status.at(0);
  check(status.level == DiagnosticStatus::WARN && status.message.find("'left'") != std::string::npos,
        "a stamp of the past: diagnostics name the task", status.level);
  check(value_of(robot, "left: targets rejected") == "1" && value_of(robot, "right: targets rejected") == "0",
        "a stamp of the past: counted for its task", 1);
  check(value_of(robot, "left: scale") == "1.000000", "diagnostics: scale of a task", 1);
}

/// After another activation, the arms start from their last commands.
void again() {
  TwoArms robot;
  give_hands();
  robot.lag = 10;
  robot.offset = -0.01;
  check(robot.load() && robot.activate(), "two arms, lag and offset: activated", 1);
  Transform<> left = robot.tip("left");
  left.p(1) += 0.25;
  robot.hear("~/left/target_pose", in_table(left));
  robot.tick(500);
  check(robot.speed() > 0.2, "two arms: deactivated in motion: speed [rad/s]", robot.speed());
  const auto last = robot.command;
  robot.deactivate();
  check(robot.command == last, "two arms: deactivated: the command is the last", 1);
  check(robot.activate(), "two arms: activated again", 1);
  robot.tick(100);
  check(change(robot.command, last, 0, 14) < 1e-9, "two arms: activated again: command from the last [rad]",
        change(robot.command, last, 0, 14));
  within_limits(robot, "two arms, again");
}

/// If the reading of a joint is NaN, both arms stop.
void fault() {
  TwoArms robot;
  give_hands();
  check(robot.load() && robot.activate(), "two arms: activated", 1);
  Transform<> right = robot.tip("right");
  right.p(1) -= 0.25;
  robot.hear("~/right/target_pose", in_table(right));
  robot.tick(400);
  const double fast = robot.speed();
  (void)logged("");
  robot.q[10] = std::numeric_limits<double>::quiet_NaN();
  robot.tick(500);
  (void)robot.said<DiagnosticArray>("/diagnostics");
  check(fast > 0.2 && robot.speed() == 0.0, "two arms: stopped by a fault: speed [rad/s]", robot.speed());
  check(logged("right_panda_joint4"), "two arms: stopped by a fault: the joint is named", 1);
  within_limits(robot, "two arms, a fault");
}

}  // namespace

void two_arms() {
  TwoArms robot;
  give_hands();
  check(robot.load() && robot.activate(), "two arms: configured, activated", 1);
  one_hand(robot);
  both_hands(robot);
  slow_hands(robot);
  refused(robot);
  within_limits(robot, "two arms");
  again();
  fault();
}
