#include <algorithm>
#include <cmath>
#include <diagnostic_msgs/msg/diagnostic_array.hpp>
#include <fpbm/model/robot.hpp>
#include <limits>
#include <robot.hpp>
#include <string>

#include "check.hpp"
#include "tests.hpp"

namespace {

using stand_in::Robot;

constexpr double kNone = std::numeric_limits<double>::infinity();

/// Position of link4 and of the flange in the base frame.
struct Positions {
  fpbm::Vector<3> elbow;
  fpbm::Vector<3> flange;
};
Positions positions(const Robot& robot) {
  const fpbm::Robot<7> model(fpbm::presets::panda());
  fpbm::Robot<7>::State state;
  model.update(fpbm::Vector<7>(robot.q.data()), state);
  return {state.placement(4).p, (state.placement(7) * fpbm::presets::panda().tip).p};
}

void walls() {
  Robot robot;
  auto& own = stand_in::parameters;
  const Positions start = positions(robot);
  const double wall = start.flange(1) + 0.1;
  const double back = start.elbow(0) - 0.04;
  own.task_bounds = {"hand", "elbow"};
  own.task_bound.task_bounds_map["hand"] = {"flange", {}, {kNone, wall, kNone}};
  own.task_bound.task_bounds_map["elbow"] = {"link_of_panda_joint4", {back, -kNone, 0.3}, {kNone, kNone, kNone}};
  check(robot.load() && robot.activate(), "walls: activated", 1);
  fpbm::Transform<> goal = robot.tip();
  goal.p += fpbm::Vector<3>(-0.1, 0.3, 0.2);
  robot.hear("~/target_pose", pose_message(goal));
  bool blocked = false;
  double hand = -1.0;
  double elbow = -1.0;
  for (int i = 0; i < 4000; ++i) {
    robot.tick();
    const Positions at = positions(robot);
    hand = std::max(hand, at.flange(1) - wall);
    elbow = std::max(elbow, back - at.elbow(0));
    if (i % 100 == 0) {
      const auto& status = robot.said<diagnostic_msgs::msg::DiagnosticArray>("/diagnostics").last.status.at(0);
      blocked = blocked || status.message.find("task bounds limit the task") != std::string::npos;
    }
  }
  check(hand < 1e-9, "walls: position of the flange beyond its bound [m]", hand);
  check(hand > -1e-3, "walls: the flange reaches its bound [m]", hand);
  check(elbow < 1e-9, "walls: position of the elbow beyond its bound [m]", elbow);
  check(elbow > -5e-3, "walls: the elbow reaches its bound [m]", elbow);
  check(blocked, "walls: in the diagnostics", 1);
  check(robot.allocated == 0, "walls: allocations", static_cast<double>(robot.allocated));
  robot.deactivate();
  check(robot.activate(), "walls: activated again at a bound", 1);
}

template <typename Change>
void refused(const char* what, const std::string& named, const Change& change) {
  Robot robot;
  auto& own = stand_in::parameters;
  own.task_bounds = {"hand"};
  own.task_bound.task_bounds_map["hand"] = {"flange", {-1.0, -1.0, 0.1}, {1.0, 1.0, 1.0}};
  change(own.task_bound.task_bounds_map["hand"]);
  (void)logged("");
  check(!(robot.load() && robot.activate()) && logged(named), (std::string(what) + ": refused, named").c_str(), 1);
}

}  // namespace

void task_bounds() {
  walls();
  refused("two coordinates", "task_bound.hand.lower: has 2 entries", [](auto& bound) { bound.lower.pop_back(); });
  refused("lower above upper", "task_bound.hand.lower[2]", [](auto& bound) { bound.lower[2] = 2.0; });
  refused("NaN", "task_bound.hand.upper", [](auto& bound) { bound.upper[1] = std::nan(""); });
  refused("an unknown link", "task_bound.hand.frame: robot_description has no link 'hand'",
          [](auto& bound) { bound.frame = "hand"; });
  refused("a link that does not move", "task_bound.hand.frame: no joint moves",
          [](auto& bound) { bound.frame = "base_link"; });
  refused("a start beyond the bound", "'upper x of hand'", [](auto& bound) { bound.upper[0] = 0.1; });
}
