#include <algorithm>
#include <cmath>
#include <fpbm/model/coupled_arm.hpp>
#include <hardware_interface/component_parser.hpp>
#include <string>
#include <vector>

#include "check.hpp"
#include "tests.hpp"

namespace {

using controller_interface::CallbackReturn;
using fpbm::presets::kAll;

struct Given {
  std::string arm;  ///< Name of the preset.
  fpbm::Chain<> chain;
  std::vector<std::string> joints;  ///< Actuated joints.
};

Given given(const std::string& arm) {
  for (const auto& preset : kAll) {
    if (arm != preset.name) continue;
    Given result{arm, preset.chain(), {}};
    for (const auto& joint : result.chain.joints) result.joints.push_back(joint.name);
    return result;
  }
  return {};
}

class Controller {
 public:
  /// Sets the parameters of the controller, and the robot_description of the chain.
  explicit Controller(const Given& from) {
    auto& parameters = stand_in::parameters = {};
    parameters.arm = from.arm;
    parameters.base_frame = "base";
    parameters.tip_frame = "flange";
    parameters.joints = from.joints;
    stand_in::descriptions()["robot"] = stand_in::description_of(from.chain);
    description.robot_description = "robot";
    description.update_rate = description.controller_manager_update_rate = 1000;
  }

  [[nodiscard]] bool configure() {
    (void)logged("");
    return controller_->init(description, {}) == controller_interface::return_type::OK &&
           controller_->configure() == CallbackReturn::SUCCESS;
  }
  /// Whether the controller rejects its configuration, with a message that contains `text`.
  [[nodiscard]] bool refuses(const std::string& text) { return !configure() && logged(text); }

  /// Activates the controller at q.
  [[nodiscard]] bool activate() {
    q.resize(stand_in::parameters.joints.size());
    locks_ = std::vector<stand_in::Lock>(2 * q.size());
    std::vector<hardware_interface::LoanedCommandInterface> commands;
    std::vector<hardware_interface::LoanedStateInterface> states;
    for (std::size_t i = 0; i < q.size(); ++i) {
      commands.emplace_back(q[i], locks_[i]);
      states.emplace_back(q[i], locks_[q.size() + i]);
    }
    controller_->assign_interfaces(std::move(commands), std::move(states));
    return controller_->on_activate({}) == CallbackReturn::SUCCESS;
  }
  /// A message on a topic, and then ticks of 1 ms.
  template <typename Message>
  void send(const std::string& topic, const Message& message, int ticks) {
    std::any_cast<std::weak_ptr<rclcpp::Subscription<Message>>>(controller_->get_node()->topics.at(topic))
        .lock()
        ->hear(message);
    for (int i = 0; i < ticks; ++i) (void)controller_->update(rclcpp::Time(), rclcpp::Duration(0, 1000000));
  }
  /// Sum of the displacements of all joints in 0.3 s after a twist [rad]; -1 if the activation fails.
  double displacement() {
    if (!activate()) return -1.0;
    const std::vector<double> start = q;
    geometry_msgs::msg::TwistStamped twist;
    twist.header.frame_id = stand_in::parameters.base_frame;
    twist.twist.linear.z = 0.05;
    send("~/target_twist", twist, 300);
    double sum = 0.0;
    for (std::size_t i = 0; i < q.size(); ++i) sum += std::abs(q[i] - start[i]);
    return sum;
  }
  /// Tip pose that the controller publishes.
  fpbm::Transform<> tip() {
    using Pose = geometry_msgs::msg::PoseStamped;
    for (const auto& timer : controller_->get_node()->timers) {
      if (const auto alive = timer.lock()) alive->fire();
    }
    const auto publisher =
        std::any_cast<std::weak_ptr<rclcpp::Publisher<Pose>>>(controller_->get_node()->topics.at("~/tip_pose")).lock();
    return fpbm_controllers::target_of(publisher->last)->pose;
  }

  controller_interface::ControllerInterfaceParams description;
  std::vector<double> q{0.1, -0.9, 0.2, -1.5, 0.3, 1.2, 0.4};

 private:
  std::unique_ptr<controller_interface::ControllerInterface> controller_ = stand_in::exported_plugin();
  std::vector<stand_in::Lock> locks_;
};

/// Every preset with the description of its arm, with a missing joint, and with the description of every other arm.
void every_preset() {
  for (const auto& preset : kAll) {
    const Given own = given(preset.name);
    Controller controller(own);
    for (std::size_t i = 0; i < own.joints.size(); ++i) {
      const auto& bounds = own.chain.joints[i].bounds;
      controller.q[i] = std::clamp(controller.q[i], bounds.lower + 0.2, bounds.upper - 0.2);
    }
    const double displacement = controller.configure() ? controller.displacement() : -1.0;
    check(displacement > 0.001 && displacement < 1.0, (own.arm + ": displacement of all joints in 0.3 s [rad]").c_str(),
          displacement);
    Controller short_of_one(own);
    stand_in::parameters.joints.pop_back();
    check(short_of_one.refuses(own.joints.back()), (own.arm + ": refused with a joint too few, which is named").c_str(),
          1);
    for (const auto& other : kAll) {
      if (own.arm == other.name) continue;
      Controller mistaken(own);
      stand_in::parameters.arm = other.name;
      check(mistaken.refuses("joint"), (own.arm + ": refused with the preset " + other.name).c_str(), 1);
    }
  }
}

/// An SO-101 with five joints: the tip reaches the position of a pose and the direction of its z axis; the rotation
/// about the axis is free.
void few_joints() {
  const Given so101 = given("so101");
  fpbm::SerialArm<5> arm(so101.chain);
  fpbm::Kinematics<fpbm::Pose, 5> kinematics;
  const fpbm::Vector<5> start(0.1, -0.4, 0.5, 0.6, 0.2);
  arm.kinematics(start + fpbm::Vector<5>(0.1, 0.1, -0.1, -0.15, 0.0), kinematics);
  fpbm::Transform<> target = kinematics.tip;
  target.R = target.R * fpbm::rotation(fpbm::Vector<3>(0.0, 0.0, 0.5));
  Controller controller(so101);
  controller.q.assign(start.begin(), start.end());
  check(controller.configure() && controller.activate(), "so101: configured and active", 1);
  geometry_msgs::msg::PoseStamped pose;
  pose.header.frame_id = stand_in::parameters.base_frame;
  const fpbm::Vector<4> w = fpbm::quaternion(target.R);
  pose.pose.position.x = target.p(0);
  pose.pose.position.y = target.p(1);
  pose.pose.position.z = target.p(2);
  pose.pose.orientation.w = w(0);
  pose.pose.orientation.x = w(1);
  pose.pose.orientation.y = w(2);
  pose.pose.orientation.z = w(3);
  controller.send("~/target_pose", pose, 6000);
  const fpbm::Transform<> tip = controller.tip();
  const double off = (tip.p - target.p).norm();
  check(off < 1e-6, "so101: error of the position [m]", off);
  const double turned = (tip.R.col(2) - target.R.col(2)).norm();
  check(turned < 1e-4, "so101: error of the z axis [rad]", turned);

  target.p(2) += 2.0;  // Unreachable: the arm stops at the workspace boundary.
  pose.pose.position.z = target.p(2);
  controller.send("~/target_pose", pose, 8000);
  const std::vector<double> before = controller.q;
  controller.send("~/target_pose", pose, 1000);
  double moved = 0.0;
  for (std::size_t i = 0; i < before.size(); ++i) moved = std::max(moved, std::abs(controller.q[i] - before[i]));
  check(moved < 1e-3, "so101: motion in 1 s with an unreachable target [rad]", moved);
}

/// A velocity of 0 in the description is not a bound.
void no_velocities() {
  Given panda = given("panda");
  for (auto& joint : panda.chain.joints) joint.bounds.velocity = 0.0;
  Controller controller(panda);
  const bool good = controller.configure();
  check(good && controller.displacement() > 0.001, "velocity 0 in robot_description: the bounds are the preset's", 1);
}

void frames() {
  const Given panda = given("panda");
  Controller root(panda);
  stand_in::parameters.base_frame = "base_link";
  check(root.configure() && root.displacement() > 0.001, "base_link, the parent of base: configured", 1);
  fpbm::SerialArm<7> arm(panda.chain);
  fpbm::Kinematics<fpbm::Pose, 7> kinematics;
  arm.kinematics(fpbm::Vector<7>(root.q.data()), kinematics);
  fpbm::Transform<> turned;
  turned.R = fpbm::rotation(fpbm::Vector<3>(0.0, 0.0, 3.0));
  check(distance(root.tip(), turned * kinematics.tip) < 1e-9, "base_link: distance of the tip from the arm's [m, rad]",
        distance(root.tip(), turned * kinematics.tip));

  Controller no_tip(panda);
  stand_in::parameters.tip_frame = "hand";
  check(no_tip.refuses("hand"), "a tip that robot_description lacks: named", 1);
  Controller moving_base(panda);
  stand_in::parameters.base_frame = "link_of_panda_joint3";
  check(moving_base.refuses("panda_joint1"), "a base that leaves out joints: refused, the first is named", 1);
  Controller upside_down(panda);
  stand_in::parameters.base_frame = "flange";
  stand_in::parameters.tip_frame = "base";
  check(upside_down.refuses("panda_joint"), "a base that moves with joints of the arm: refused", 1);
  Controller swapped(panda);
  std::swap(stand_in::parameters.joints[2], stand_in::parameters.joints[3]);
  check(swapped.refuses("panda_joint3"), "joints in another order: refused, the first is named", 1);
  Controller nothing(panda);
  nothing.description.robot_description = "";
  check(nothing.refuses("robot_description"), "no robot_description: refused", 1);
}

void differences() {
  Given bent = given("panda");
  bent.chain.joints[4].placement.p(1) += 0.05;
  Controller shifted(bent);
  check(shifted.refuses("panda_joint6"), "a link 5 cm longer than the preset's: refused, a joint is named", 1);
  bent = given("panda");
  bent.chain.joints[3].bounds.velocity *= 1.5;
  Controller faster(bent);
  check(faster.refuses("panda_joint4"), "a velocity above the preset's: refused, the joint is named", 1);
}

void limits() {
  Given panda = given("panda");
  panda.chain.joints[3].bounds.velocity = 0.5;
  Controller slow(panda);
  check(slow.configure() && logged("velocity 0.5 (robot_description)"), "a velocity of robot_description: in the log",
        1);
  Controller controlled(panda);
  joint_limits::JointLimits limit;
  limit.has_velocity_limits = limit.has_acceleration_limits = true;
  limit.max_velocity = 0.25;
  limit.max_acceleration = 1.5;
  stand_in::hardware()["robot"].limits["panda_joint4"] = limit;
  check(controlled.configure(), "limits of ros2_control: configured", 1);
  stand_in::hardware().clear();
  check(logged("velocity 0.25 (ros2_control), acceleration 1.5 (ros2_control)"), "limits of ros2_control: in the log",
        1);
  Controller wider(panda);
  stand_in::parameters.limits.velocity.assign(7, 2.0);
  check(wider.configure() && logged("velocity 0.5 (robot_description)"), "limits.velocity never widen", 1);

  limit.min_position = -1e-3;  // A tag without limits, on a description without a velocity.
  limit.has_velocity_limits = true;
  limit.max_velocity = 0.0;
  limit.has_effort_limits = true;
  limit.has_acceleration_limits = false;
  stand_in::hardware()["robot"].limits["panda_joint4"] = limit;
  Controller zero(panda);
  check(zero.configure() && logged("velocity 0.5 (robot_description), acceleration 12.5 (preset)"),
        "velocity and effort 0 of ros2_control: not limits", 1);
  stand_in::hardware().clear();

  Given no_preset = given("panda");
  no_preset.arm = "";
  Controller unbounded(no_preset);
  check(unbounded.refuses("limits.acceleration"), "no bound on acceleration: refused", 1);
  Controller bounded(no_preset);
  stand_in::parameters.limits.acceleration.assign(7, 5.0);
  check(bounded.configure() && bounded.displacement() > 0.001, "no preset, limits.acceleration: configured", 1);
}

/// The first five joints of a Panda. A pose has six rows: the motion is damped at all times.
void too_few_joints() {
  Given shorter = given("panda");
  shorter.arm = "";
  shorter.chain.joints.resize(5);
  shorter.joints.resize(5);
  Controller controller(shorter);
  stand_in::parameters.limits.acceleration.assign(5, 5.0);
  check(controller.configure() && controller.displacement() > 0.001, "an arm of 5 joints: moves", 1);
}

/// A Panda whose last joint follows the previous joint.
void mimic() {
  Given geared = given("panda");
  geared.arm = "";
  geared.chain.joints[6].mimic = {5, -0.5, 0.3};
  geared.joints.pop_back();
  Controller controller(geared);
  stand_in::parameters.limits.acceleration.assign(6, 5.0);
  check(controller.configure(), "a mimic joint: configured", 1);
  check(controller.displacement() > 0.001, "a mimic joint: activated", 1);
  fpbm::CoupledArm<6> arm(geared.chain);
  fpbm::Kinematics<fpbm::Pose, 6> kinematics;
  arm.kinematics(fpbm::Vector<6>(controller.q.data()), kinematics);
  check(distance(controller.tip(), kinematics.tip) < 1e-9, "a mimic joint: distance of the tip from the arm's [m, rad]",
        distance(controller.tip(), kinematics.tip));
}

}  // namespace

void descriptions() {
  every_preset();
  few_joints();
  no_velocities();
  frames();
  differences();
  limits();
  too_few_joints();
  mimic();
}
