#include <algorithm>
#include <cmath>
#include <diagnostic_msgs/msg/diagnostic_array.hpp>
#include <limits>
#include <random>
#include <two_arms.hpp>

#include "check.hpp"
#include "tests.hpp"
#include "yaml.hpp"

namespace {

using fpbm::Transform;
using geometry_msgs::msg::PoseStamped;
using stand_in::TwoArms;

/// Loads config/two_pandas.yaml. The grasp is the pose of the left flange in the frame of the right flange. The right
/// flange moves the tray.
[[nodiscard]] bool load(TwoArms& robot) {
  stand_in::parameters.command_interfaces = {"position"};
  return robot.load(ParameterFile::read(CONFIG_FOLDER "/two_pandas.yaml", "tray"));
}

PoseStamped message_in(const std::string& frame, const Transform<>& pose) {
  PoseStamped message = pose_message(pose);
  message.header.frame_id = frame;
  return message;
}

/// Largest error of the grasp [m, rad]. The target of the tray jumps; then a fault stops the robot.
double largest_error(TwoArms& robot, int jumps, unsigned int seed) {
  const Transform<> start = robot.tip("right");
  const Transform<> grasp = robot.grasp();
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  const auto three = [&](double size) {
    return fpbm::Vector<3>(fpbm::Vector<3>(any(random), any(random), any(random)) * size);
  };
  double worst = 0.0;
  double fastest = 0.0;
  const auto tick = [&](int count) {
    for (int i = 0; i < count; ++i) {
      robot.tick();
      worst = std::max(worst, distance(robot.grasp(), grasp));
      fastest = std::max(fastest, robot.speed());
    }
  };
  const auto jump = [&] {
    Transform<> tray = start;
    tray.p += three(0.3);
    tray.R = fpbm::rotation(three(0.5)) * tray.R;
    robot.hear("~/tray/target_pose", message_in("table", tray));
  };
  for (int k = 1; k < jumps; ++k) {
    jump();
    tick(1500);
  }
  // Toward the last target. If a joint on its bound admits no motion toward this target, toward other targets.
  for (int k = 0; k < 10 && robot.speed() <= 0.2; ++k) {
    jump();
    for (int i = 0; i < 500 && robot.speed() <= 0.2; ++i) tick(1);
  }
  const double before = robot.speed();
  robot.q[9] = std::numeric_limits<double>::quiet_NaN();
  tick(1500);
  check(fastest > 0.3 && before > 0.1, "tray jumps: speed before the fault [rad/s]", before);
  check(robot.speed() < 1e-9, "tray jumps: speed after the fault [rad/s]", robot.speed());
  return worst;
}

void within_limits(const TwoArms& robot) {
  check(robot.excess < 1e-9, "grasp: position, velocity beyond a limit [rad, rad/s]", robot.excess);
  check(robot.acceleration_excess < 1e-6, "grasp: ratio of the acceleration excess to the limit",
        robot.acceleration_excess);
  check(robot.jerk_excess < 1e-3, "grasp: ratio of the jerk excess to the limit", robot.jerk_excess);
  check(robot.allocated == 0, "grasp: allocations", static_cast<double>(robot.allocated));
}

void kept() {
  double worst = 0.0;
  for (unsigned int seed = 1; seed <= 4; ++seed) {
    TwoArms robot;
    check(load(robot) && robot.activate(), "grasp: configured, activated", seed);
    worst = std::max(worst, largest_error(robot, 4, seed));
    within_limits(robot);
  }
  check(worst < 1e-6, "grasp: largest error while the tray jumps and stops [m, rad]", worst);
}

/// Without keep_first_level, a stop changes the grasp. Therefore, kept() can detect a broken grasp.
void not_kept() {
  TwoArms robot;
  stand_in::parameters.command_interfaces = {"position"};
  auto file = ParameterFile::read(CONFIG_FOLDER "/two_pandas.yaml", "tray");
  file["keep_first_level"] = rclcpp::ParameterValue(false);
  check(robot.load(file) && robot.activate(), "grasp not kept: activated", 1);
  const double error = largest_error(robot, 2, 1);
  check(error > 1e-4, "grasp not kept: largest error [m, rad]", error);
}

/// Targets of the grasp are in the frame of the right flange.
void targets_of_the_grasp() {
  TwoArms robot;
  check(load(robot) && robot.activate(), "grasp, own targets: activated", 1);
  robot.tick(10);
  const auto& said = robot.said<PoseStamped>("~/grasp/tip_pose").last;
  const double error = distance(fpbm_controllers::target_of(said)->pose, robot.grasp());
  check(error < 1e-9 && said.header.frame_id == "right_flange", "grasp: tip_pose, in the reference frame [m, rad]",
        error);
  Transform<> wider = robot.grasp();
  wider.p += fpbm::Vector<3>(0.0, 0.02, 0.0);
  const Transform<> tray = robot.tip("right");
  (void)logged("");
  robot.hear("~/grasp/target_pose", message_in("table", wider));
  check(logged("task 'grasp' dropped: its frame is 'table', not 'right_flange'"),
        "grasp: a target in the table's frame", 1);
  robot.hear("~/grasp/target_pose", message_in("right_flange", wider));
  robot.tick(2500);
  check(distance(robot.grasp(), wider) < 1e-6, "grasp: distance from its own target [m, rad]",
        distance(robot.grasp(), wider));
  check(distance(robot.tip("right"), tray) < 1e-4, "grasp: motion of the tray [m, rad]",
        distance(robot.tip("right"), tray));
}

}  // namespace

void grasp() {
  kept();
  not_kept();
  targets_of_the_grasp();
}
