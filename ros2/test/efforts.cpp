#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <diagnostic_msgs/msg/diagnostic_array.hpp>
#include <fpbm/model/dynamics.hpp>
#include <limits>
#include <string>
#include <two_arms.hpp>
#include <vector>

#include "check.hpp"
#include "tests.hpp"
#include "yaml.hpp"

namespace {

using diagnostic_msgs::msg::DiagnosticArray;
using diagnostic_msgs::msg::DiagnosticStatus;
using fpbm::Transform;
using geometry_msgs::msg::PoseStamped;
using stand_in::Lifecycle;
using stand_in::Robot;
using stand_in::TwoArms;
using Torques = fpbm::Vector<7>;
using Dynamics = fpbm::Dynamics<7>;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// A Panda with dry and viscous friction, whose masses are 2 % below the masses of robot_description, moved by torques.
class TorqueArm : public Robot {
 public:
  TorqueArm() {
    auto& own = stand_in::parameters;
    own.command_interfaces = {"effort"};
    own.state_interfaces = {"position", "velocity"};
    own.effort.kp.assign(7, 2500.0);
    watched = false;
  }

  bool adds_gravity = false;  ///< Whether the robot itself adds the torque of gravity.
  bool friction = true;
  Torques push = Torques::Zero();  ///< Torques of a person [Nm].

 protected:
  /// The joint velocities are constant in steps of a quarter of a period.
  void move(double period) override {
    constexpr int kSteps = 4;
    Eigen::Map<Torques> position(q.data());
    Eigen::Map<Torques> turning(measured_velocity.data());
    const bool lost = !position.allFinite();
    if (lost) position = position_;  // A reading that is lost does not change the arm.
    for (int i = 0; i < kSteps && !held; ++i) {
      dynamics_.robot().update(position, turning, state_);
      Torques drive = Eigen::Map<const Torques>(torque.data()) + push - dynamics_.bias(state_);
      if (adds_gravity) drive += dynamics_.gravity_torque(state_);
      if (friction) drive -= friction_.cwiseProduct((turning.array() / 0.01).tanh().matrix() + 2.0 * turning);
      turning += period / kSteps * Eigen::Matrix<double, 7, 7>(dynamics_.mass_matrix(state_)).llt().solve(drive);
      position += period / kSteps * turning;
    }
    position_ = position;
    for (const std::size_t i : lost_) q[i] = kNaN;
  }

 public:
  std::vector<std::size_t> lost_;  ///< Torques whose readings are NaN.

 private:
  [[nodiscard]] static fpbm::Chain<> lighter() {
    fpbm::Chain<> chain = fpbm::presets::panda();
    for (auto& joint : chain.joints) {
      joint.moved.mass /= 1.02;
      joint.moved.inertia /= 1.02;
    }
    return chain;
  }

  Dynamics dynamics_{lighter()};
  Torques friction_ = 0.003 * dynamics_.robot().limits().effort;
  Dynamics::State state_;
  Torques position_ = Eigen::Map<const Torques>(q.data());
};

/// Pose to which a person leads the tip at t [s].
Transform<> led(const Transform<>& start, double t) {
  const double share = std::pow(std::sin(1.5 * std::min(t, 2.0)), 2);
  Transform<> pose = start;
  pose.p += fpbm::Vector<3>(0.05, 0.15, 0.1) * share;
  pose.R = fpbm::rotation(fpbm::Vector<3>(0.0, 0.2 * share, 0.3 * share)) * pose.R;
  return pose;
}

/// The pose of the commanded posture.
Transform<> commanded(Robot& robot) {
  return fpbm_controllers::target_of(robot.said<PoseStamped>("~/tip_pose").last)->pose;
}

/// Largest error of the tip in a motion.
struct Error {
  double position = 0.0;     ///< [m]
  double orientation = 0.0;  ///< [rad]
};
Error follow(TorqueArm& robot, int ticks = 3000) {
  const Transform<> start = robot.tip();
  Error largest;
  for (int i = 0; i < ticks; ++i) {
    if (i % 50 == 0) robot.hear("~/target_pose", pose_message(led(start, 1e-3 * i)));
    robot.tick();
    const Transform<> at = robot.tip();
    const Transform<> goal = commanded(robot);
    largest.position = std::max(largest.position, (at.p - goal.p).norm());
    largest.orientation = std::max(largest.orientation, (at.R - goal.R).norm() / std::sqrt(2.0));
  }
  return largest;
}

double fastest(const TorqueArm& robot) {
  double largest = 0.0;
  for (const double v : robot.measured_velocity) largest = std::max(largest, std::abs(v));
  return largest;
}

void computed_torque() {
  TorqueArm robot;
  robot.command.fill(0.0);  // Without position commands, this is not the last command.
  check(robot.load() && robot.activate(), "computed torque: activated", 1);
  const Error error = follow(robot);
  check(error.position < 1e-3, "computed torque, masses 2 % wrong: position error of the tip [m]", error.position);
  check(error.orientation < 0.01, "computed torque, masses 2 % wrong: orientation error [rad]", error.orientation);
  robot.tick(8000);
  const double at_rest = distance(robot.tip(), commanded(robot));
  check(at_rest < 0.003 && fastest(robot) < 1e-4, "computed torque: error at rest [m, rad]", at_rest);
  check(robot.effort_ratio < 1.0, "computed torque: largest torque, of the effort", robot.effort_ratio);
  check(robot.allocated == 0, "computed torque: allocations", static_cast<double>(robot.allocated));
  check(robot.command[0] == 0.0, "computed torque: no position is commanded", robot.command[0]);

  TorqueArm stiff;
  stand_in::parameters.effort.kp.assign(7, 1e4);
  check(stiff.load() && stiff.activate(), "four times the gains: activated", 1);
  const double less = follow(stiff).position / error.position;
  check(less < 0.35, "four times the gains: position error, of the error before", less);

  TorqueArm supported;
  supported.adds_gravity = true;
  stand_in::parameters.effort.robot_adds_gravity = true;
  check(supported.load() && supported.activate(), "the robot adds gravity: activated", 1);
  const Error of_friction = follow(supported);
  check(of_friction.position < error.position, "the robot adds gravity: position error of the tip [m]",
        of_friction.position);
}

/// Largest difference of the torques from the inverse dynamics of the commands in a motion [Nm]. names: of the topics.
template <typename Arm, typename Model, typename Lead>
double difference(Arm& robot, const Model& model, bool adds_gravity, const Lead& lead) {
  using Vector = typename Model::JointVector;
  const auto vector = [](const auto& array) { return Vector(Eigen::Map<const Vector>(array.data())); };
  Vector q = vector(robot.q);
  Vector qd = Vector::Zero();
  typename Model::State state;
  double largest = 0.0;
  for (int i = 0; i < 1500; ++i) {
    lead(i);
    robot.tick();
    const Vector next = vector(robot.velocity);
    model.robot().update(q, qd, state);
    Vector torque = model.inverse_dynamics(state, (next - qd) / 1e-3);
    if (adds_gravity) torque -= model.gravity_torque(state);
    largest = std::max(largest, (vector(robot.torque) - torque).cwiseAbs().maxCoeff());
    q = vector(robot.command);
    qd = next;
  }
  return largest;
}

void feed_forward() {
  const auto run = [](Robot& robot, const char* what, const Dynamics& model, bool adds_gravity = false) {
    stand_in::parameters.command_interfaces = {"position", "velocity", "effort"};
    stand_in::parameters.effort.robot_adds_gravity = adds_gravity;
    robot.lag = 10;
    robot.offset = 0.002;  // Feed-forward does not depend on the measured state.
    check(robot.load() && robot.activate(), (std::string(what) + ": activated").c_str(), 1);
    robot.command = robot.q;
    const Transform<> start = robot.tip();
    const double error = difference(robot, model, adds_gravity, [&](int i) {
      if (i % 50 == 0) robot.hear("~/target_pose", pose_message(led(start, 1e-3 * i)));
    });
    check(error < 1e-9, (std::string(what) + ": difference from inverse dynamics [Nm]").c_str(), error);
    check(robot.speed() > 0.1 && robot.allocated == 0, (std::string(what) + ": allocations").c_str(),
          static_cast<double>(robot.allocated));
    check(robot.excess < 1e-9, (std::string(what) + ": position, velocity beyond a limit [rad, rad/s]").c_str(),
          robot.excess);
  };
  fpbm::Chain<> chain = fpbm::presets::panda();
  {
    Robot robot;
    run(robot, "feed-forward", Dynamics(chain));
  }
  {
    Robot robot;
    run(robot, "feed-forward, the robot adds gravity", Dynamics(chain), true);
  }
  {
    Robot robot;
    stand_in::parameters.effort.gravity = {0.0, 6.0, -7.0};
    run(robot, "feed-forward, inclined base", Dynamics(chain, {0.0, 6.0, -7.0}));
  }
  {
    Robot robot;
    stand_in::parameters.effort.payload.mass = 1.5;
    stand_in::parameters.effort.payload.centre = {0.01, -0.02, 0.1};
    Dynamics model(chain);
    Transform<> tool;
    tool.p = {0.02, 0.01, 0.1034};
    tool.R << 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0;
    (void)model.set_payload(fpbm::Robot<7>::kTip, {1.5, {0.01, -0.02, 0.1}}, tool);
    run(robot, "feed-forward, payload", model);
  }
  {
    Robot robot;  // A rotated hand with a finger, which a joint outside the chain moves; friction.
    for (auto& joint : chain.joints) joint.drive = {0.0, 1.5, 0.5};
    urdf::Model& described = stand_in::descriptions()["panda"] = stand_in::description_of(chain);
    Transform<> hand;
    hand.R = fpbm::rotation(fpbm::Vector<3>(0.0, 0.0, -0.7854));
    Transform<> finger;
    finger.p = {0.0, 0.02, 0.06};
    stand_in::add(described, "to_hand", "flange", "hand", hand);
    stand_in::add(described, "to_finger", "hand", "finger", finger).type = urdf::Joint::PRISMATIC;
    fpbm::LinkInertia<> palm{0.7, {0.01, 0.0, 0.03}};
    palm.inertia.diagonal() = fpbm::Vector<3>(0.001, 0.0025, 0.0017);
    palm.inertia(0, 1) = palm.inertia(1, 0) = 2e-4;
    palm.inertia(0, 2) = palm.inertia(2, 0) = -3e-4;
    palm.inertia(1, 2) = palm.inertia(2, 1) = 1e-4;
    const fpbm::LinkInertia<> pad{0.1, {0.0, 0.01, 0.02}};
    described.links_["hand"]->inertial = stand_in::inertial_of(palm);
    described.links_["finger"]->inertial = stand_in::inertial_of(pad);
    Dynamics model(chain);
    const Transform<> at = chain.tip * hand;
    (void)model.set_payload(7, fpbm::joined(fpbm::placed(at, palm), fpbm::placed(at * finger, pad)));
    run(robot, "feed-forward, hand and finger", model);
  }
}

/// While an arm with position commands waits for a locked joint, the feed-forward torque is the torque at rest.
void feed_forward_at_a_lock() {
  Robot robot;
  stand_in::parameters.command_interfaces = {"position", "velocity", "effort"};
  check(robot.load() && robot.activate(), "feed-forward, a lock: activated", 1);
  const Transform<> start = robot.tip();
  for (int i = 0; i < 500; ++i) {
    if (i % 50 == 0) robot.hear("~/target_pose", pose_message(led(start, 1e-3 * i)));
    robot.tick();
  }
  robot.command_locks[2].calls = 3;
  robot.tick(2);
  const Dynamics model(fpbm::presets::panda());
  Dynamics::State state;
  model.robot().update(Torques(robot.command.data()), Torques::Zero(), state);
  const double error = (Torques(robot.torque.data()) - model.gravity_torque(state)).cwiseAbs().maxCoeff();
  check(error < 1e-9, "feed-forward, a lock: difference from the torque at rest [Nm]", error);
}

/// config/fr3_torques.yaml with the description of an FR3.
void config() {
  TorqueArm robot;
  stand_in::parameters = {};
  urdf::Model& model = stand_in::descriptions()["panda"] = {};
  model.links_["fr3_link0"] = std::make_shared<urdf::Link>(urdf::Link{"fr3_link0", nullptr});
  stand_in::add_chain(model, fpbm::presets::fr3(), "fr3_link0");
  stand_in::add(model, "to_link8", "flange", "fr3_link8", {});
  check(robot.load(ParameterFile::read(CONFIG_FOLDER "/fr3_torques.yaml", "targets")), "fr3_torques.yaml: configured",
        1);
}

void two_arms_together() {
  TwoArms robot;
  auto& own = stand_in::parameters;
  own.command_interfaces = {"position", "velocity", "effort"};
  own.tasks = {"left", "right"};
  own.task.tasks_map["left"].frame = "left_flange";
  own.task.tasks_map["right"].frame = "right_flange";
  check(robot.load() && robot.activate(), "feed-forward, two arms: activated", 1);
  fpbm::Tree<> tree;
  for (const double side : {0.4, -0.4}) {
    Transform<> base;
    base.p(1) = side;
    (void)fpbm::add_arm(tree, fpbm::presets::panda(), side > 0.0 ? "left" : "right", 0, base);
  }
  const Transform<> start = robot.tip("left");
  const double error = difference(robot, fpbm::Dynamics<14>(tree), false, [&](int i) {
    PoseStamped message = pose_message(led(start, 1e-3 * i));
    message.header.frame_id = "table";
    if (i % 50 == 0) robot.hear("~/left/target_pose", message);
  });
  check(error < 1e-9, "feed-forward, two arms: difference from inverse dynamics [Nm]", error);
  check(robot.speed() > 0.1, "feed-forward, two arms: speed [rad/s]", robot.speed());
}

/// Whether the arm stops, with torques within the efforts. creep: largest velocity at the end [rad/s].
void stops(TorqueArm& robot, const std::string& what, double creep = 1e-3) {
  robot.tick(1500);
  const auto& status = robot.said<DiagnosticArray>("/diagnostics").last.status.at(0);
  check(status.level == DiagnosticStatus::ERROR, (what + ": level of the diagnostics").c_str(), status.level);
  check(fastest(robot) < creep, (what + ": velocity at the end [rad/s]").c_str(), fastest(robot));
  check(robot.effort_ratio <= 1.0, (what + ": largest torque, of the effort").c_str(), robot.effort_ratio);
}

/// Moves the arm, and returns its velocity [rad/s].
double start_moving(TorqueArm& robot) {
  Transform<> elsewhere = robot.tip();
  elsewhere.p(1) += 0.3;
  robot.hear("~/target_pose", pose_message(elsewhere));
  robot.tick(500);
  return fastest(robot);
}

void in_faults() {
  {
    TorqueArm robot;
    check(robot.load() && robot.activate(), "a reading is NaN: activated", 1);
    const double fast = start_moving(robot);
    (void)logged("");
    const auto before = robot.q;
    robot.lost_ = {3};
    robot.q[3] = kNaN;
    stops(robot, "a reading is NaN", 0.01);  // Without a position, only the velocity is fed back.
    double moved = 0.0;
    for (std::size_t i = 0; i < 7; ++i) moved = i == 3 ? moved : std::max(moved, std::abs(robot.q[i] - before[i]));
    check(fast > 0.3 && moved < 0.2, "a reading is NaN: stopping distance [rad]", moved);
    check(logged("panda_joint4"), "a reading is NaN: the joint is named", 1);
  }
  {
    TorqueArm robot;
    check(robot.load() && robot.activate(), "a velocity is NaN: activated", 1);
    (void)start_moving(robot);
    (void)logged("");
    const double saved = robot.measured_velocity[2];
    robot.measured_velocity[2] = kNaN;
    robot.held = true;
    robot.tick();
    robot.held = false;
    robot.measured_velocity[2] = saved;
    stops(robot, "a velocity is NaN");
    check(logged("panda_joint3"), "a velocity is NaN: the joint is named", 1);
  }
  {
    TorqueArm robot;
    check(robot.load() && robot.activate(), "pushed away: activated", 1);
    (void)start_moving(robot);
    robot.push(5) = 8.0;
    robot.tick(300);
    robot.push(5) = 0.0;
    stops(robot, "pushed away");
  }
  {
    TorqueArm robot;
    check(robot.load() && robot.activate(), "a torque is locked: activated", 1);
    (void)start_moving(robot);
    robot.command_locks[1].calls = 3;
    robot.tick(3);
    robot.state_locks[8].calls = 2;
    robot.tick(50);
    const double error = distance(robot.tip(), commanded(robot));
    check(error < 0.02, "torque and velocity locked for ticks: error of the tip [m, rad]", error);
    robot.command_locks[1].calls = 5;
    robot.tick(5);
    stops(robot, "a torque is locked for 5 ticks");

    Transform<> ends[2];
    for (const bool locks : {false, true}) {
      TorqueArm arm;
      check(arm.load() && arm.activate(), "a torque is locked in two of three ticks: activated", locks);
      (void)start_moving(arm);
      for (int i = 0; i < 300; ++i) {
        if (locks && i % 6 == 0) arm.command_locks[2].calls = 4;
        arm.tick();
      }
      ends[locks ? 1 : 0] = commanded(arm);
    }
    const double apart = distance(ends[0], ends[1]);
    check(apart == 0.0, "a torque is locked in two of three ticks: the motion does not wait [m, rad]", apart);
  }
  {
    TorqueArm robot;
    check(robot.load() && robot.activate(), "no further targets: activated", 1);
    (void)follow(robot, 500);
    robot.tick(8000);
    check(fastest(robot) < 1e-3, "no further targets: velocity at the end [rad/s]", fastest(robot));
    robot.deactivate();
    check(robot.torque == Robot::Joints{}, "deactivated: the torques are 0", robot.torque[1]);
    robot.measured_velocity.fill(0.0);
    check(robot.activate(), "activated again", 1);
    const double error = follow(robot, 500).position;
    check(error < 1e-3, "activated again: position error of the tip [m]", error);
  }
  {
    TorqueArm robot;
    stand_in::parameters.limits.effort = {87.0, 10.0, 87.0, 87.0, 12.0, 12.0, 12.0};
    check(robot.load() && robot.activate(), "a torque at its bound: activated", 1);
    (void)logged("");
    for (int i = 0; i < 3; ++i) {
      robot.tick(10);
      (void)robot.said<DiagnosticArray>("/diagnostics");
    }
    const std::string log = stand_in::log;
    check(std::abs(robot.torque[1]) <= 10.0, "a torque at its bound: torque [Nm]", robot.torque[1]);
    check(logged("'panda_joint2': its torque is limited"), "a torque at its bound: logged", 1);
    check(log.find("limited") == log.rfind("limited"), "a torque at its bound: logged once", 1);
  }
}

/// A configuration that the controller rejects, with a message that contains `named`.
template <typename Change>
void refused(const char* what, const std::string& named, const Change& change) {
  TorqueArm robot;
  change(robot);
  (void)logged("");
  check(!robot.load() && logged(named), (std::string(what) + ": refused, named").c_str(), 1);
}

void refusals() {
  auto& own = stand_in::parameters;
  const auto link = [](const char* name) -> urdf::Link& { return *stand_in::descriptions()["panda"].links_.at(name); };
  refused("a link without mass", "link 'link_of_panda_joint3' has no mass",
          [&](auto&) { link("link_of_panda_joint3").inertial = nullptr; });
  refused("a negative moment", "panda_joint3", [&](auto&) { link("link_of_panda_joint3").inertial->ixx = -1.0; });
  const auto no_effort = [&](auto&) {
    own.arm = "";
    link("link_of_panda_joint5").parent_joint->limits->effort = 0.0;
  };
  refused("effort 0", "limits.effort: joint 'panda_joint5'", no_effort);
  refused("no gains", "effort.kp", [&](auto&) { own.effort.kp.clear(); });
  refused("six gains", "effort.kp", [&](auto&) { own.effort.kp.pop_back(); });
  refused("a gain that is NaN", "effort.kp", [&](auto&) { own.effort.kp[2] = kNaN; });
  refused("a gain too high for the tick", "effort.kd", [&](auto&) { own.effort.kp[6] = 1.1e6; });
  refused("no measured velocities", "state_interfaces", [&](auto&) { own.state_interfaces = {"position"}; });
  refused("effort before position", "command_interfaces", [&](auto&) {
    own.command_interfaces = {"effort", "position"};
  });
  refused("velocity alone", "command_interfaces", [&](auto&) { own.command_interfaces = {"velocity"}; });
  refused("a payload that is infinite", "effort.payload",
          [&](auto&) { own.effort.payload.mass = std::numeric_limits<double>::infinity(); });
  refused("gravity that is NaN", "effort.gravity", [&](auto&) { own.effort.gravity[1] = kNaN; });
  TorqueArm positions;
  own.command_interfaces = {"position", "velocity"};
  own.effort.kp.clear();
  link("link_of_panda_joint3").inertial = nullptr;
  no_effort(positions);
  own.arm = "panda";
  check(positions.load(), "positions without mass and effort: configured", 1);

  TorqueArm robot;
  no_effort(robot);
  own.limits.effort.assign(7, 50.0);
  check(robot.load(), "effort 0, limits.effort given: configured", 1);
  robot.measured_velocity[2] = kNaN;
  check(!robot.activate() && logged("panda_joint3"), "a velocity that is NaN: not activated, joint named", 1);
  robot.measured_velocity[2] = 0.0;
  check(robot.activate(), "activated once all can be read", 1);
}

}  // namespace

void efforts() {
  computed_torque();
  feed_forward();
  feed_forward_at_a_lock();
  config();
  two_arms_together();
  in_faults();
  refusals();
}
