// Tests the controller on simulated arms: all tests, or the tests in the arguments. Prints the measured values, and
// fails if a value is not as promised.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <diagnostic_msgs/msg/diagnostic_array.hpp>
#include <exception>
#include <fpbm_controllers/target.hpp>
#include <fpbm_controllers/target_controller_parameters.hpp>
#include <limits>
#include <random>
#include <robot.hpp>

#include "check.hpp"
#include "tests.hpp"

namespace {

using diagnostic_msgs::msg::DiagnosticArray;
using diagnostic_msgs::msg::DiagnosticStatus;
using fpbm::Transform;
using geometry_msgs::msg::PoseStamped;
using geometry_msgs::msg::TwistStamped;
using stand_in::Robot;

/// Pose to which a person leads the tip at t [s].
Transform<> hand(const Transform<>& start, double t) {
  const double displacement = std::pow(std::sin(1.5 * std::min(t, 2.0)), 2);
  Transform<> pose = start;
  pose.p += fpbm::Vector<3>(0.02, 0.1, 0.05) * displacement;
  pose.R = fpbm::rotation(fpbm::Vector<3>(0.0, 0.0, 0.3 * displacement)) * pose.R;
  return pose;
}

/// 30 poses per second, each up to 10 ms early or late. No poses from 0.8 to 1.2 s.
void poses(Robot& robot) {
  const Transform<> start = robot.tip();
  std::mt19937 random(1);
  std::uniform_real_distribution<double> jitter(-0.01, 0.01);
  double due = 0.0;
  double behind = 0.0;
  for (int i = 0; i < 4000; ++i) {
    const double t = 1e-3 * i;
    if (t >= due) {
      if (t < 0.8 || t > 1.2) robot.hear("~/target_pose", pose_message(hand(start, t), t));
      due += 1.0 / 30.0 + jitter(random);
    }
    robot.tick();
    if (t > 1.7) behind = std::max(behind, distance(robot.tip(), hand(start, t)));
  }
  check(distance(robot.tip(), hand(start, 4.0)) < 1e-5, "poses: distance from the last [m, rad]",
        distance(robot.tip(), hand(start, 4.0)));
  check(behind < 0.02, "poses: farthest behind after the gap [m, rad]", behind);
  robot.tick(3000);
  check(robot.speed() < 1e-4, "poses: speed at the end [rad/s]", robot.speed());
}

void twists(Robot& robot) {
  const Transform<> start = robot.tip();
  TwistStamped message;
  message.header.frame_id = "base";  // No stamp: the current time.
  message.twist.linear.z = -0.05;
  for (int i = 0; i < 1000; ++i) {
    if (i % 50 == 0) robot.hear("~/target_twist", message);
    robot.tick();
  }
  robot.tick(3000);
  const double displacement = robot.tip().p(2) - start.p(2);
  check(std::abs(displacement + 0.05 * 1.15) < 0.004, "twists: displacement down in 1 s and until the timeout [m]",
        displacement);
  check(robot.speed() < 1e-4, "twists: speed at the end [rad/s]", robot.speed());
}

/// Rejected targets do not move the arm.
void refused(Robot& robot) {
  const Transform<> start = robot.tip();
  Transform<> elsewhere = start;
  elsewhere.p(0) += 0.1;
  const int before = stand_in::warnings;
  PoseStamped message = pose_message(elsewhere, 10.0);
  message.header.frame_id = "camera";
  robot.hear("~/target_pose", message);
  robot.tick(200);
  message = pose_message(elsewhere, 10.1);
  message.pose.position.y = std::numeric_limits<double>::quiet_NaN();
  robot.hear("~/target_pose", message);
  robot.tick(200);
  message = pose_message(elsewhere, 10.2);
  message.pose.orientation = {0.0, 0.0, 0.0, 0.0};
  robot.hear("~/target_pose", message);
  robot.tick(200);
  TwistStamped twist;
  twist.header.frame_id = "base";
  twist.twist.angular.x = std::numeric_limits<double>::infinity();
  robot.hear("~/target_twist", twist);
  robot.tick(200);
  check(stand_in::warnings == before + 4, "refused: warnings of frame, NaN, quaternion, twist",
        stand_in::warnings - before);
  robot.hear("~/target_pose", pose_message(elsewhere, 1.0));  // Older than the previous stamps.
  robot.tick(200);
  check(distance(robot.tip(), start) < 1e-4, "refused: displacement of the tip [m, rad]", distance(robot.tip(), start));
  const auto& said = robot.said<DiagnosticArray>("/diagnostics");
  check(said.last.status.at(0).values.at(4).value == "1", "refused: by its stamp", 1);
}

void messages(Robot& robot) {
  PoseStamped quarter;  // Rotated by a right angle about z.
  quarter.pose.orientation = {0.0, 0.0, std::sqrt(0.5), std::sqrt(0.5)};
  const fpbm::Vector<3> y = fpbm_controllers::target_of(quarter)->pose.R.col(0);
  check((y - fpbm::Vector<3>(0.0, 1.0, 0.0)).norm() < 1e-9, "messages: x, y, z, w of a quaternion", y(1));

  const auto& tip = robot.said<PoseStamped>("~/tip_pose");
  const auto target = fpbm_controllers::target_of(tip.last);
  const double error = target ? distance(target->pose, robot.tip()) : 1.0;
  check(error < 1e-4 && tip.last.header.frame_id == "base", "tip_pose: distance from the tip [m, rad]", error);
  const auto& status = robot.said<DiagnosticArray>("/diagnostics").last.status.at(0);
  check(status.level == DiagnosticStatus::OK && status.values.at(0).value == "1.000000", "diagnostics: level",
        status.level);
}

}  // namespace

void targets() {
  Robot robot;
  stand_in::parameters.scheme.weights = {8, 8, 4, 4, 2, 1, 1};
  check(robot.load(), "configured", 1);
  check(robot.activate(), "activated", 1);
  poses(robot);
  twists(robot);
  refused(robot);
  messages(robot);
  faults(robot);
  check(robot.allocated == 0, "every activation and tick: allocations", static_cast<double>(robot.allocated));
  check(robot.excess < 1e-9, "every tick: position, velocity beyond a limit [rad, rad/s]", robot.excess);
  check(robot.acceleration_excess < 1e-6, "every tick: ratio of the acceleration excess to the limit",
        robot.acceleration_excess);
  check(robot.jerk_excess < 1e-3, "every tick: ratio of the jerk excess to the limit", robot.jerk_excess);
  std::printf("%lld ticks\n", static_cast<long long>(robot.calls));
}

int main(int count, char** names) {
  const std::pair<const char*, void (*)()> tests[] = {
      {"targets", targets},         {"locks", locks},         {"rates", rates},
      {"activation", activation},   {"clearance", clearance}, {"descriptions", descriptions},
      {"efforts", efforts},         {"topics", topics},       {"obstacles", obstacles},
      {"parameters", parameters},   {"two_arms", two_arms},   {"grasp", grasp},
      {"task_bounds", task_bounds}, {"tasks", tasks},         {"torque_bounds", torque_bounds},
      {"update_time", update_time}, {"wording", wording},     {"joint_messages", joint_messages},
      {"streams", streams}};
  for (const auto& [name, test] : tests) {
    const bool named =
        std::any_of(names + 1, names + count, [own = name](const char* given) { return std::strcmp(own, given) == 0; });
    if (count > 1 && !named) continue;
    try {
      test();
    } catch (const std::exception& error) {
      std::printf("FAIL %s: %s\n", name, error.what());
      ++failures;
    }
  }
  return failures == 0 ? 0 : 1;
}
