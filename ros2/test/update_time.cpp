#include <algorithm>
#include <cmath>
#include <cstdio>
#include <diagnostic_msgs/msg/diagnostic_array.hpp>
#include <robot.hpp>
#include <scene.hpp>
#include <string>
#include <vector>

#include "check.hpp"
#include "tests.hpp"

namespace {

using stand_in::Robot;
using Vector = fpbm::Vector<3>;

/// Prints the time of a call of update(), while the target of the tip moves through a table, a post and a box.
void measure(const char* what, Robot& robot, bool sees) {
  check(robot.load() && robot.activate(), what, 1);
  const fpbm::Transform<> start = robot.tip();
  if (sees) {
    const Vector below(start.p(0), start.p(1), start.p(2) - 0.25);
    robot.hear("~/obstacles",
               stand_in::scene({stand_in::floor("table", below(2)),
                                stand_in::cylinder("post", 0.8, 0.05, below + Vector(0.0, 0.35, 0.4)),
                                stand_in::box("box", Vector(0.2, 0.2, 0.3), below + Vector(0.15, -0.35, 0.15))}));
  }
  std::vector<double> times;
  int limited = 0;  // Number of limited samples of 1000.
  for (int i = 0; i < 20000; ++i) {
    const double t = 1e-3 * i;
    fpbm::Transform<> goal = start;
    goal.p += Vector(0.1 * std::sin(1.7 * t), 0.4 * std::sin(1.1 * t), -0.15 + 0.25 * std::sin(0.8 * t));
    if (i % 20 == 0) robot.hear("~/target_pose", pose_message(goal));
    robot.tick();
    times.push_back(robot.seconds_of_call);
    if (i % 20 != 0) continue;
    const auto& status = robot.said<diagnostic_msgs::msg::DiagnosticArray>("/diagnostics").last.status.at(0);
    limited += status.level == diagnostic_msgs::msg::DiagnosticStatus::WARN ? 1 : 0;
  }
  std::sort(times.begin(), times.end());
  const auto at = [&times](double fraction) { return 1e6 * times[static_cast<std::size_t>(fraction * 20000.0)]; };
  std::printf("     update() %s [us]: median %.1f, p99 %.1f, p99.9 %.1f; task limited in %.0f %% of the ticks\n", what,
              at(0.5), at(0.99), at(0.999), limited / 10.0);
}

}  // namespace

void update_time() {
  auto& own = stand_in::parameters;
  {
    Robot robot;
    measure("without bounds", robot, false);
  }
  {
    Robot robot;
    own.clearance.margin = 0.01;
    measure("with clearance", robot, true);
  }
  {
    Robot robot;
    own.torque_bounds.fraction = 0.9;
    own.effort.payload.mass = 1.0;
    measure("with torque bounds", robot, false);
  }
  {
    Robot robot;
    own.clearance.margin = 0.01;
    own.torque_bounds.fraction = 0.9;
    own.effort.payload.mass = 1.0;
    measure("with clearance and torque bounds", robot, true);
  }
}
