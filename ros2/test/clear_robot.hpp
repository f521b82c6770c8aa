#pragma once

#include <algorithm>
#include <diagnostic_msgs/msg/diagnostic_array.hpp>
#include <fpbm/bound/preset_capsules.hpp>
#include <limits>
#include <robot.hpp>
#include <scene.hpp>
#include <string>
#include <vector>

#include "check.hpp"

inline constexpr double kMargin = 0.02;
inline constexpr double kTolerance = 1e-9;

/// A Panda with a clearance. The frame "base" of the stand-in is the base frame of the preset.
class ClearRobot : public stand_in::Robot {
 public:
  ClearRobot() { stand_in::parameters.clearance.margin = kMargin; }

  void see(const stand_in::PlanningScene& message) { hear("~/obstacles", message); }
  void target(const fpbm::Vector<3>& displacement) {
    fpbm::Transform<> goal = tip();
    goal.p += displacement;
    hear("~/target_pose", pose_message(goal));
  }
  [[nodiscard]] fpbm::Vector<7> posture() const { return Eigen::Map<const fpbm::Vector<7>>(q.data()); }
  [[nodiscard]] diagnostic_msgs::msg::DiagnosticStatus status() {
    return said<diagnostic_msgs::msg::DiagnosticArray>("/diagnostics").last.status.at(0);
  }
};

/// Distance of the nearest pair of a Panda and obstacles, by the library.
class Judge {
 public:
  explicit Judge(const std::vector<fpbm::Obstacle<>>& obstacles)
      : clearance_(fpbm::presets::panda(), fpbm::presets::capsules::panda(), obstacles, 0.0,
                   fpbm::presets::never_collide::panda()) {}
  [[nodiscard]] double distance(const fpbm::Vector<7>& q) const { return clearance_.nearest_pair(q).second; }
  [[nodiscard]] double distance(const ClearRobot& robot) const { return distance(robot.posture()); }

 private:
  fpbm::Clearance<7> clearance_;
};

/// Ticks; returns the least distance.
inline double least(ClearRobot& robot, const Judge& judge, int ticks) {
  double found = std::numeric_limits<double>::infinity();
  for (int i = 0; i < ticks; ++i) {
    robot.tick();
    found = std::min(found, judge.distance(robot));
  }
  return found;
}

/// A ball below the hand at a distance from the arm [m].
inline stand_in::CollisionObject ball_below(const ClearRobot& robot, double gap) {
  const fpbm::Vector<3> centre = robot.tip().p - fpbm::Vector<3>(0.0, 0.0, 0.1);
  double low = 0.0;
  double high = 0.3;
  while (high - low > 1e-6) {
    const double radius = (low + high) / 2.0;
    const Judge judge({fpbm::Obstacle<>("ball", fpbm::Capsule<>{centre, centre, radius})});
    (judge.distance(robot) > gap ? low : high) = radius;
  }
  return stand_in::sphere("ball", low, centre);
}

inline std::string value(const diagnostic_msgs::msg::DiagnosticStatus& status, const std::string& key) {
  for (const auto& each : status.values) {
    if (each.key == key) return each.value;
  }
  return "";
}

inline void limits_hold(const stand_in::Robot& robot, const std::string& what) {
  check(robot.allocated == 0, (what + ": allocations").c_str(), static_cast<double>(robot.allocated));
  check(robot.excess < 1e-9, (what + ": position, velocity beyond a limit").c_str(), robot.excess);
  check(robot.acceleration_excess < 1e-6, (what + ": acceleration excess").c_str(), robot.acceleration_excess);
  check(robot.jerk_excess < 1e-3, (what + ": jerk excess").c_str(), robot.jerk_excess);
}
