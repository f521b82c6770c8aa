#include <algorithm>
#include <cmath>
#include <diagnostic_msgs/msg/diagnostic_array.hpp>
#include <fpbm/model/dynamics.hpp>
#include <limits>
#include <string>
#include <two_arms.hpp>

#include "check.hpp"
#include "stream_robot.hpp"
#include "tests.hpp"

namespace {

using fpbm::Transform;
using stand_in::Robot;
using stand_in::TwoArms;

/// A Panda with its own limits and positions as commands, whose tip is sent up and down.
class Lifter : public Robot {
 public:
  Lifter() {
    auto& own = stand_in::parameters;
    own.limits = {};
    own.tool = {};
    own.target.velocity = 1.5;
    own.target.acceleration = 15.0;
    own.target.jerk = 500.0;
    own.effort.payload.mass = 3.0;
    own.effort.payload.centre = {0.0, 0.0, 0.15};
    own.scheme.rest_stiffness = 0.0;
    watched = false;
  }
};

/// The dynamics of the stand-in with a payload.
fpbm::Dynamics<7> loaded(double mass) {
  fpbm::Dynamics<7> dynamics(fpbm::presets::panda());
  fpbm::LinkInertia<> load;
  load.mass = mass;
  load.centre = {0.0, 0.0, 0.15};
  (void)dynamics.set_payload(fpbm::Robot<7>::kTip, load);
  return dynamics;
}

/// Largest ratio of torque to effort of a motion with sudden targets, computed from three commands one after another.
double largest_ratio(Lifter& robot, const fpbm::Dynamics<7>& dynamics) {
  using Joints = fpbm::Vector<7>;
  const Joints effort = dynamics.robot().limits().effort;
  const Transform<> start = robot.tip();
  const auto position = [&] { return Joints(Eigen::Map<const Joints>(robot.q.data())); };
  const auto velocity = [&] { return Joints(Eigen::Map<const Joints>(robot.velocity.data())); };
  robot.tick();
  fpbm::Dynamics<7>::State state;
  Joints q = position();
  Joints qd = velocity();
  double largest = 0.0;
  for (int i = 0; i < 4000; ++i) {
    const double side = i / 500 % 2 == 0 ? 1.0 : -1.0;
    Transform<> goal = start;
    goal.p += side * fpbm::Vector<3>(0.1, 0.2, 0.2);
    const Posture posture = kStart + Posture::Constant(0.3 * side);
    if (i % 50 == 0 && stand_in::parameters.input == "poses") robot.hear("~/target_pose", pose_message(goal));
    if (i % 500 == 0 && stand_in::parameters.input == "joints") robot.hear("~/joint_trajectory", message(posture));
    robot.tick();
    const Joints qdd = (velocity() - qd) * 1000.0;  // Constant in the tick.
    dynamics.robot().update(q, qd, state);
    largest = std::max(largest, dynamics.inverse_dynamics(state, qdd).cwiseQuotient(effort).cwiseAbs().maxCoeff());
    q = position();
    qd = velocity();
  }
  return largest;
}

void heavy_payload() {
  auto& own = stand_in::parameters;
  const fpbm::Dynamics<7> dynamics = loaded(3.0);
  Lifter free;
  check(free.load() && free.activate(), "without bounds: activated", 1);
  const double without = largest_ratio(free, dynamics);
  check(without > 1.02, "without bounds: largest torque, of the effort", without);

  Lifter bounded;
  own.torque_bounds.fraction = 0.9;
  check(bounded.load() && bounded.activate(), "torque bounds: activated", 1);
  const double ratio = largest_ratio(bounded, dynamics);
  check(ratio <= 0.9 + 1e-6, "torque bounds of 0.9: largest torque, of the effort", ratio);
  check(ratio > 0.8, "torque bounds of 0.9: the torques are used, of the effort", ratio);
  check(bounded.allocated == 0, "torque bounds: allocations", static_cast<double>(bounded.allocated));

  Lifter uncertain;
  own.torque_bounds.fraction = 0.9;
  own.torque_bounds.payload.uncertainty = 0.5;
  check(uncertain.load() && uncertain.activate(), "payload of 2.5 to 3.5 kg: activated", 1);
  const double heavier = largest_ratio(uncertain, loaded(3.5));
  check(heavier <= 0.9 + 1e-6, "payload of 2.5 to 3.5 kg: largest torque with 3.5 kg, of the effort", heavier);

  // This payload is a counterweight at joint 6, whose torque at rest is 1.55 Nm with 0.5 kg, and 1.34 Nm with 1 kg.
  for (const double uncertainty : {0.0, 0.5}) {
    Lifter counterweight;
    own.effort.payload.mass = 1.0;
    own.effort.payload.centre = {0.0, 0.2, 0.0};
    own.limits.effort = {87.0, 87.0, 87.0, 87.0, 12.0, 1.44, 12.0};
    own.torque_bounds.fraction = 1.0;
    own.torque_bounds.payload.uncertainty = uncertainty;
    check(counterweight.load(), "a counterweight: configured", 1);
    (void)logged("");
    const bool activated = counterweight.activate();
    if (uncertainty == 0.0) check(activated, "a counterweight of 1 kg: activated", 1);
    if (uncertainty > 0.0) check(!activated && logged("panda_joint6"), "of 0.5 to 1.5 kg: refused, named", 1);
  }
}

/// Sudden postures of a stream.
void stream() {
  auto& own = stand_in::parameters;
  for (const double fraction : {0.0, 0.9}) {
    Lifter robot;
    own.input = "joints";
    own.torque_bounds.fraction = fraction;
    check(robot.load() && robot.activate(), "a stream with torques: activated", 1);
    const double ratio = largest_ratio(robot, loaded(3.0));
    if (fraction == 0.0) check(ratio > 1.02, "a stream without bounds: largest torque, of the effort", ratio);
    if (fraction > 0.0) check(0.8 < ratio && ratio <= 0.9 + 1e-6, "a stream, bounds of 0.9: largest torque", ratio);
    check(robot.allocated == 0, "a stream with torques: allocations", static_cast<double>(robot.allocated));
  }
}

/// With the command interface effort, feed-forward torques are never limited.
void feed_forward() {
  auto& own = stand_in::parameters;
  for (const double fraction : {0.0, 0.95}) {
    Lifter robot;
    own.torque_bounds.fraction = fraction;
    own.command_interfaces = {"position", "velocity", "effort"};
    check(robot.load() && robot.activate(), "feed-forward: activated", 1);
    (void)largest_ratio(robot, loaded(3.0));
    if (fraction == 0.0) check(robot.effort_ratio == 1.0, "feed-forward: a torque is limited", robot.effort_ratio);
    if (fraction > 0.0) check(robot.effort_ratio < 0.96, "feed-forward, bounds: largest torque", robot.effort_ratio);
  }
}

void stacks() {
  TwoArms robot;
  auto& own = stand_in::parameters;
  own.tasks = {"left", "right"};
  own.task.tasks_map["left"].frame = "left_flange";
  own.task.tasks_map["right"].frame = "right_flange";
  own.torque_bounds.fraction = 0.5;
  own.target.velocity = 1.5;
  own.target.acceleration = 15.0;
  own.target.jerk = 500.0;
  check(robot.load() && robot.activate(), "two arms: activated", 1);
  fpbm::Tree<> tree;
  for (const double side : {0.4, -0.4}) {
    Transform<> base;
    base.p(1) = side;
    (void)fpbm::add_arm(tree, fpbm::presets::panda(), side > 0.0 ? "left" : "right", 0, base);
  }
  using Joints = fpbm::Vector<14>;
  const fpbm::Dynamics<14> dynamics(tree);
  const Joints effort = dynamics.robot().limits().effort;
  const Transform<> start = robot.tip("left");
  fpbm::Dynamics<14>::State state;
  robot.tick();
  Joints q = Eigen::Map<const Joints>(robot.q.data());
  Joints qd = Eigen::Map<const Joints>(robot.velocity.data());
  double largest = 0.0;
  for (int i = 0; i < 1500; ++i) {
    Transform<> goal = start;
    goal.p += (i / 500 % 2 == 0 ? 1.0 : -1.0) * fpbm::Vector<3>(0.1, 0.1, 0.25);
    auto message = pose_message(goal);
    message.header.frame_id = "table";
    if (i % 50 == 0) robot.hear("~/left/target_pose", message);
    robot.tick();
    const Joints next = Eigen::Map<const Joints>(robot.velocity.data());
    dynamics.robot().update(q, qd, state);
    const Joints torque = dynamics.inverse_dynamics(state, Joints((next - qd) * 1000.0));
    largest = std::max(largest, torque.cwiseQuotient(effort).cwiseAbs().maxCoeff());
    q = Eigen::Map<const Joints>(robot.q.data());
    qd = next;
  }
  check(largest <= 0.5 + 1e-6, "two arms, torque bounds of 0.5: largest torque, of the effort", largest);
  check(largest > 0.4, "two arms, torque bounds of 0.5: the torques are used", largest);
  check(robot.allocated == 0, "two arms, torque bounds: allocations", static_cast<double>(robot.allocated));
}

template <typename Change>
void refused(const char* what, const std::string& named, const Change& change) {
  Lifter robot;
  stand_in::parameters.torque_bounds.fraction = 0.9;
  change();
  (void)logged("");
  check(!robot.load() && logged(named), (std::string(what) + ": refused, named").c_str(), 1);
}

void refusals() {
  auto& own = stand_in::parameters;
  const auto link = [](const char* name) -> urdf::Link& { return *stand_in::descriptions()["panda"].links_.at(name); };
  refused("torque bounds, a link without mass", "link 'link_of_panda_joint3' has no mass",
          [&] { link("link_of_panda_joint3").inertial = nullptr; });
  refused("torque bounds, no effort", "limits.effort: joint 'panda_joint5'", [&] {
    own.arm = "";
    own.limits.acceleration.assign(7, 5.0);
    link("link_of_panda_joint5").parent_joint->limits->effort = 0.0;
  });
  refused("torque bounds, a payload that is infinite", "effort.payload.mass",
          [&] { own.effort.payload.mass = std::numeric_limits<double>::infinity(); });
  refused("torque bounds, an uncertainty that is infinite", "torque_bounds.payload.uncertainty",
          [&] { own.torque_bounds.payload.uncertainty = std::numeric_limits<double>::infinity(); });
  Lifter robot;
  own.torque_bounds.fraction = 0.9;
  own.effort.payload.mass = 20.0;
  check(robot.load(), "a payload of 20 kg: configured", 1);
  (void)logged("");
  check(!robot.activate(), "a payload that the arm cannot hold: not activated", 1);
  check(logged("torque at rest"), "a payload that the arm cannot hold: the reason is logged", 1);
}

}  // namespace

void torque_bounds() {
  heavy_payload();
  stream();
  feed_forward();
  stacks();
  refusals();
}
