#include <algorithm>
#include <cmath>
#include <string>

#include "clear_robot.hpp"
#include "tests.hpp"

namespace {

using diagnostic_msgs::msg::DiagnosticStatus;
using fpbm::Transform;
using stand_in::CollisionObject;
using stand_in::scene;
using Vector = fpbm::Vector<3>;

const Vector kElsewhere(0.0, 0.0, -5.0);

/// One obstacle of each kind between the tip and its target: the margin holds, and the arm comes near.
void kinds() {
  const Vector tip = ClearRobot().tip().p;
  const Vector aside = tip + Vector(0.0, 0.35, 0.0);
  const Vector below = tip - Vector(0.0, 0.0, 0.35);
  Transform<> place;
  place.p = aside;
  const struct {
    const char* name;
    CollisionObject object;
    fpbm::WorldShape<> shape;
    Vector toward;
  } given[] = {{"a box", stand_in::box("thing", Vector(0.3, 0.1, 0.6), aside),
                fpbm::Cuboid<>{place, Vector(0.15, 0.05, 0.3)}, aside - tip},
               {"a sphere", stand_in::sphere("thing", 0.15, aside), fpbm::Capsule<>{aside, aside, 0.15}, aside - tip},
               {"a cylinder", stand_in::cylinder("thing", 0.6, 0.1, aside),
                fpbm::Capsule<>{aside - Vector(0.0, 0.0, 0.3), aside + Vector(0.0, 0.0, 0.3), 0.1}, aside - tip},
               {"a plane", stand_in::floor("thing", below(2) + 0.15),
                fpbm::HalfSpace<>{Vector(0.0, 0.0, 1.0), below(2) + 0.15}, below - tip}};
  for (const auto& [name, object, shape, toward] : given) {
    ClearRobot robot;
    check(robot.load() && robot.activate(), (std::string(name) + ": activated").c_str(), 1);
    robot.see(scene({object}));
    robot.target(toward);
    const double distance = least(robot, Judge({fpbm::Obstacle<>("thing", shape)}), 4000);
    check(distance >= kMargin - kTolerance, (std::string(name) + ": least distance [m]").c_str(), distance);
    check(distance < kMargin + 0.005, (std::string(name) + ": the arm reaches the margin [m]").c_str(), distance);
    check(value(robot.status(), "nearest pair").find("thing") != std::string::npos,
          (std::string(name) + ": in the diagnostics").c_str(), 1);
    limits_hold(robot, name);
    check(logged("dropped") == false, (std::string(name) + ": not dropped").c_str(), 1);
    robot.see(scene({stand_in::operation(CollisionObject::REMOVE, "thing")}));
    robot.tick(3000);
    const double error = std::stod(value(robot.status(), "tip position error [m]"));
    check(error < 1e-4, (std::string(name) + ": removed: distance from the target [m]").c_str(), error);
  }
}

/// MoveIt's operations: MOVE replaces the pose, APPEND adds shapes, ADD replaces the object, an empty REMOVE and a
/// whole scene remove all objects.
void operations() {
  constexpr double kGap = 0.01;  // Nearer than all pairs of links.
  ClearRobot robot;
  stand_in::parameters.clearance.margin = 0.001;
  check(robot.load() && robot.activate(), "operations: activated", 1);
  const auto nearest = [&robot] {
    robot.tick();
    return value(robot.status(), "nearest pair");
  };
  const auto distance = [&robot] {
    robot.tick();
    return std::stod(value(robot.status(), "distance of the nearest pair [m]"));
  };
  const auto has = [&nearest](const char* name) { return nearest().find(name) != std::string::npos; };
  const CollisionObject ball = ball_below(robot, kGap);
  const double radius = ball.primitives[0].dimensions[0];
  const Vector near = robot.tip().p - Vector(0.0, 0.0, 0.1);
  robot.see(scene({ball, stand_in::box("far", Vector(1.0, 1.0, 1.0), kElsewhere)}));
  check(has("ball") && std::abs(distance() - kGap) < 1e-5, "ADD: distance [m]", distance());
  robot.see(scene({stand_in::operation(CollisionObject::MOVE, "ball", near - Vector(0.0, 0.0, 0.01))}));
  check(std::abs(distance() - kGap - 0.01) < 2e-3, "MOVE: distance after 0.01 m [m]", distance());
  robot.see(scene({stand_in::operation(CollisionObject::MOVE, "ball", kElsewhere)}));
  check(!has("ball"), "MOVE: another pair is nearest", distance());
  CollisionObject more = stand_in::sphere("far", radius, near - kElsewhere);  // Relative to the object.
  more.operation = CollisionObject::APPEND;
  robot.see(scene({more}));
  check(has("far") && std::abs(distance() - kGap) < 1e-5, "APPEND: in the frame of the object [m]", distance());
  robot.see(scene({stand_in::box("far", Vector(1.0, 1.0, 1.0), kElsewhere)}));
  check(!has("far"), "ADD again: replaces", distance());
  robot.see(scene({ball}, false));
  check(has("ball"), "a whole scene: added", distance());
  robot.see(scene({stand_in::operation(CollisionObject::REMOVE, "far")}));
  check(logged("obstacle 'far' dropped: does not exist"), "a whole scene: removes the others", 1);
  robot.see(scene({stand_in::operation(CollisionObject::REMOVE, "")}));
  check(!has("ball"), "REMOVE without a name: removes all", distance());

  const auto dropped = [&robot](const char* what, CollisionObject object, const char* reason) {
    (void)logged("");
    robot.see(scene({object}));
    check(logged(std::string("obstacle 'thing' dropped: ") + reason), what, 1);
  };
  CollisionObject wrong = stand_in::sphere("thing", 0.1, near);
  wrong.header.frame_id = "camera";
  dropped("another frame", wrong, "its frame is 'camera', not 'base'");
  dropped("a cone", stand_in::object("thing", 4, {0.1, 0.1}, near), "a primitive must be");
  dropped("a box of two numbers", stand_in::object("thing", 1, {0.1, 0.1}, near), "a box must have 3");
  dropped("a radius that is NaN", stand_in::sphere("thing", std::nan(""), near), "dimensions must be");
  dropped("a position that is NaN", stand_in::sphere("thing", 0.1, Vector(std::nan(""), 0.0, 0.0)), "all numbers");
  dropped("MOVE of an unknown object", stand_in::operation(CollisionObject::MOVE, "thing"), "does not exist");
  dropped("no shape", stand_in::operation(CollisionObject::ADD, "thing"), "has no shape");
  CollisionObject mesh = stand_in::sphere("thing", 0.1, near);
  mesh.meshes.emplace_back();
  dropped("a mesh", mesh, "a mesh is not supported");
  CollisionObject many = stand_in::sphere("thing", 0.01, kElsewhere);
  many.primitives.resize(17, many.primitives[0]);
  dropped("17 shapes", many, "all obstacles would have 17 shapes: must be at most clearance.obstacles = 16");
  (void)logged("");
  robot.see(scene({stand_in::sphere("pedestal", 0.1, Vector(0.0, 0.0, 0.2))}));
  check(logged("obstacle 'pedestal' is closer to link 'link_of_panda_joint1'"), "a pedestal: not checked, logged", 1);
  check(!has("thing"), "dropped objects are not obstacles", 1);
  check(robot.allocated == 0, "operations: allocations in update()", static_cast<double>(robot.allocated));
}

/// An obstacle that appears closer than the margin: reported, and the arm only moves away. A start there is refused.
void too_close() {
  ClearRobot robot;
  check(robot.load() && robot.activate(), "too close: activated", 1);
  const CollisionObject ball = ball_below(robot, 0.008);
  const Vector centre = robot.tip().p - Vector(0.0, 0.0, 0.1);
  const Judge judge({fpbm::Obstacle<>("ball", fpbm::Capsule<>{centre, centre, ball.primitives[0].dimensions[0]})});
  robot.see(scene({ball}));
  robot.tick();
  const double before = judge.distance(robot);
  check(before < kMargin, "too close: distance [m]", before);
  const auto status = robot.status();
  check(status.level == DiagnosticStatus::WARN &&
            status.message.find("closer than clearance.margin") != std::string::npos,
        "too close: in the diagnostics", status.level);
  robot.target(Vector(0.0, 0.0, -0.2));
  const double after = least(robot, judge, 2000);
  check(after >= before - kTolerance, "too close, target beyond: least distance [m]", after);
  robot.target(Vector(0.0, 0.0, 0.2));
  robot.tick(3000);
  check(judge.distance(robot) > kMargin, "too close, target away: distance [m]", judge.distance(robot));
  limits_hold(robot, "too close");

  robot.see(scene({ball_below(robot, 0.008)}));
  robot.deactivate();
  (void)logged("");
  check(!robot.activate(), "too close: not activated", 1);
  check(stand_in::log.find("ball") != std::string::npos && logged("add the pair to clearance.allowed"),
        "too close: the pair is named", 1);
  robot.see(scene({stand_in::operation(CollisionObject::REMOVE, "ball")}));
  check(robot.activate(), "too close: activated after the obstacle was removed", 1);
}

/// A person holds the arm while it approaches a box: the braking motion keeps the margin.
void fault_near_a_box() {
  const Vector aside = ClearRobot().tip().p + Vector(0.0, 0.3, 0.0);
  Transform<> place;
  place.p = aside;
  const Judge judge({fpbm::Obstacle<>("box", fpbm::Cuboid<>{place, Vector(0.15, 0.05, 0.3)})});
  double least = 1.0;
  double fastest = 0.0;
  for (const int ticks : {200, 300, 400, 500, 600}) {
    ClearRobot robot;
    check(robot.load() && robot.activate(), "a fault near a box: activated", ticks);
    robot.see(scene({stand_in::box("box", Vector(0.3, 0.1, 0.6), aside)}));
    robot.target(Vector(0.0, 0.3, 0.0));
    robot.tick(ticks);
    fastest = std::max(fastest, robot.speed());
    robot.held = true;
    for (int i = 0; i < 1000; ++i) {
      robot.tick();
      least = std::min(least, judge.distance(fpbm::Vector<7>(robot.command.data())));
    }
    check(robot.speed() == 0.0, "a fault near a box: the command is at rest [rad/s]", robot.speed());
  }
  check(fastest > 0.3, "a fault near a box: speed [rad/s]", fastest);
  check(least >= kMargin - kTolerance, "a fault near a box: least distance of the command [m]", least);
  check(least < kMargin + 0.01, "a fault near a box: the arm was near [m]", least);
}

/// A lock ends in a posture that is too close to a new obstacle: the arm waits until the obstacle is away.
void after_a_lock() {
  ClearRobot robot;
  check(robot.load() && robot.activate(), "a lock and an obstacle: activated", 1);
  robot.target(Vector(0.0, 0.2, 0.0));
  robot.tick(300);
  robot.command_locks[1].calls = 2;
  robot.tick(1);
  robot.see(scene({ball_below(robot, 0.008)}));
  robot.tick(500);
  check(robot.speed() == 0.0, "a lock and an obstacle: the arm waits: speed [rad/s]", robot.speed());
  check(robot.status().level == DiagnosticStatus::WARN, "a lock and an obstacle: in the diagnostics", 1);
  robot.see(scene({stand_in::operation(CollisionObject::REMOVE, "")}));
  robot.tick(3000);
  const double error = std::stod(value(robot.status(), "tip position error [m]"));
  check(error < 1e-4, "a lock, the obstacle removed: distance from the target [m]", error);
  check(robot.allocated == 0, "a lock and an obstacle: allocations", static_cast<double>(robot.allocated));
}

}  // namespace

void obstacles() {
  kinds();
  operations();
  too_close();
  fault_near_a_box();
  after_a_lock();
}
