#include <algorithm>
#include <limits>
#include <string>
#include <two_arms.hpp>
#include <vector>

#include "clear_robot.hpp"
#include "tests.hpp"

namespace {

using diagnostic_msgs::msg::DiagnosticStatus;
using fpbm::Transform;
using stand_in::scene;
using Vector = fpbm::Vector<3>;

/// The tip is sent into the base of the arm.
void self_collision() {
  ClearRobot robot;
  check(robot.load() && robot.activate(), "self-collision: activated", 1);
  robot.target(Vector(0.05, 0.0, 0.0) - robot.tip().p);
  const double distance = least(robot, Judge({}), 4000);
  check(distance >= kMargin - kTolerance, "self-collision: least distance [m]", distance);
  check(distance < kMargin + 0.005, "self-collision: the arm reaches the margin [m]", distance);
  const auto status = robot.status();
  check(status.level == DiagnosticStatus::WARN, "self-collision: level of the diagnostics", status.level);
  check(value(status, "nearest pair").find("link_of_panda_joint") != std::string::npos,
        "self-collision: the nearest pair is in the diagnostics", 1);
  limits_hold(robot, "self-collision");
  robot.deactivate();
  check(robot.activate(), "self-collision: activated again at the margin", 1);
}

/// Capsules of the parameters, at links that are fixed to links of the arm.
void own_capsules() {
  ClearRobot robot;
  auto& own = stand_in::parameters.clearance;
  own.links = {"flange"};  // A ball of 0.1 m, 0.05 m in front of the flange.
  own.capsules = {0.0, 0.0, 0.05, 0.0, 0.0, 0.05, 0.1};
  check(robot.load() && robot.activate(), "own capsules: activated", 1);
  const fpbm::SerialArm<7> arm(fpbm::presets::panda());
  const auto ball = [&] {
    fpbm::Kinematics<fpbm::Pose, 7> kinematics;
    arm.kinematics(robot.posture(), kinematics);
    return Vector(kinematics.tip.p + 0.05 * kinematics.tip.R.col(2));
  };
  const double height = ball()(2) - 0.3;
  robot.see(scene({stand_in::floor("floor", height)}));
  robot.target(Vector(0.0, 0.0, -0.4));
  double lowest = 1.0;
  for (int i = 0; i < 4000; ++i) {
    robot.tick();
    lowest = std::min(lowest, ball()(2) - height - 0.1);
  }
  check(lowest >= kMargin - kTolerance, "own capsules: least distance from the floor [m]", lowest);
  check(lowest < kMargin + 1e-3, "own capsules: the arm reaches the margin [m]", lowest);

  ClearRobot allowed;
  own.links = {"flange"};
  own.capsules = {0.0, 0.0, 0.05, 0.0, 0.0, 0.05, 0.1};
  own.allowed = {"flange", "floor"};
  check(allowed.load() && allowed.activate(), "an allowed pair: activated", 1);
  allowed.see(scene({stand_in::floor("floor", height)}));
  allowed.target(Vector(0.0, 0.0, -0.25));
  allowed.tick(4000);
  const double error = std::stod(value(allowed.status(), "tip position error [m]"));
  check(error < 1e-4, "an allowed pair: distance from the target [m]", error);
}

template <typename Change>
void refused(const char* what, const std::string& named, const Change& change) {
  ClearRobot robot;
  change(robot);
  (void)logged("");
  check(!robot.load() && logged(named), (std::string(what) + ": refused, named").c_str(), 1);
}

void refusals() {
  auto& own = stand_in::parameters;
  refused("no preset and no capsules", "clearance.capsules: is empty, and arm has no preset",
          [&](auto&) { own.arm = ""; });
  refused("a preset without capsules", "preset 'z1' has no capsules", [&](ClearRobot& robot) {
    stand_in::descriptions()["panda"] = stand_in::description_of(fpbm::presets::z1());
    own.joints.clear();
    for (const auto& joint : fpbm::presets::z1().joints) own.joints.push_back(joint.name);
    own.arm = "z1";
    own.limits = {};
    (void)robot;
  });
  refused("another joint frame", "the frame of joint 'panda_joint4' is not the frame in preset 'panda'", [](auto&) {
    auto& joint = *stand_in::descriptions()["panda"].links_.at("link_of_panda_joint4")->parent_joint;
    joint.parent_to_joint_origin_transform.position.x += 0.005;
  });
  refused("six numbers", "clearance.capsules: has 6 numbers: must have 7 for each of clearance.links, 7", [&](auto&) {
    own.clearance.links = {"flange"};
    own.clearance.capsules.assign(6, 0.0);
  });
  refused("an unknown link", "clearance.links: robot_description has no link 'flnge'", [&](auto&) {
    own.clearance.links = {"flnge"};
    own.clearance.capsules.assign(7, 0.1);
  });
  refused("a negative radius", "capsules[0].radius", [&](auto&) {
    own.clearance.links = {"flange"};
    own.clearance.capsules.assign(7, -0.1);
  });
  refused("three names", "clearance.allowed", [&](auto&) { own.clearance.allowed = {"a", "b", "c"}; });
  refused("a margin that is infinite", "clearance.margin",
          [&](auto&) { own.clearance.margin = std::numeric_limits<double>::infinity(); });
}

/// Two arms whose hands are sent to the same place.
void two_arms_meet() {
  stand_in::TwoArms robot;
  auto& own = stand_in::parameters;
  own.tasks = {"left", "right"};
  own.task.tasks_map["left"].frame = "left_flange";
  own.task.tasks_map["right"].frame = "right_flange";
  own.clearance.margin = kMargin;
  check(robot.load() && robot.activate(), "two arms: activated", 1);
  for (const std::string side : {"left", "right"}) {
    Transform<> goal = robot.tip(side);
    goal.p(1) = 0.0;
    auto message = pose_message(goal);
    message.header.frame_id = "table";
    robot.hear("~/" + side + "/target_pose", message);
  }
  fpbm::Tree<> tree;
  std::vector<fpbm::LinkCapsule<>> capsules;
  std::vector<std::pair<std::string, std::string>> allowed;
  for (const std::string side : {"left", "right"}) {
    Transform<> base;
    base.p(1) = side == "left" ? 0.4 : -0.4;
    const int first = static_cast<int>(tree.joints.size());
    (void)fpbm::add_arm(tree, fpbm::presets::panda(), side, 0, base);
    for (auto each : fpbm::presets::capsules::panda()) {
      each.name = side + each.name;
      if (each.link == 0) each.capsule = fpbm::placed(each.capsule, base);
      if (each.link > 0) each.link += first;
      capsules.push_back(each);
    }
    for (const auto& [a, b] : fpbm::presets::never_collide::panda()) allowed.emplace_back(side + a, side + b);
  }
  const fpbm::Clearance<14> judge(tree, capsules, {}, 0.0, allowed);
  double distance = 1.0;
  for (int i = 0; i < 3000; ++i) {
    robot.tick();
    distance = std::min(distance, judge.nearest_pair(Eigen::Map<const fpbm::Vector<14>>(robot.q.data())).second);
  }
  check(distance >= kMargin - kTolerance, "two arms: least distance [m]", distance);
  check(distance < kMargin + 0.01, "two arms: the arms reach the margin [m]", distance);
  Transform<> beside = robot.tip("left");  // Beside the base of the right arm.
  beside.p = {0.1, -0.25, 0.05};
  auto message = pose_message(beside);
  message.header.frame_id = "table";
  robot.hear("~/left/target_pose", message);
  distance = 1.0;
  for (int i = 0; i < 4000; ++i) {
    robot.tick();
    distance = std::min(distance, judge.nearest_pair(Eigen::Map<const fpbm::Vector<14>>(robot.q.data())).second);
  }
  check(distance >= kMargin - kTolerance, "two arms, a hand at the other base: least distance [m]", distance);
  check(distance < kMargin + 1e-3, "two arms, a hand at the other base: the hand reaches the margin [m]", distance);
  check(robot.allocated == 0, "two arms: allocations", static_cast<double>(robot.allocated));
}

}  // namespace

void clearance() {
  self_collision();
  own_capsules();
  refusals();
  two_arms_meet();
}
