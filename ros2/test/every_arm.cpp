#include "every_arm.hpp"

#include <cmath>
#include <controller_interface/controller_interface.hpp>
#include <fpbm/model/presets.hpp>
#include <fpbm_controllers/target_controller_parameters.hpp>
#include <geometry_msgs/msg/twist_stamped.hpp>
#include <string>
#include <vector>

#include "check.hpp"

namespace {

using controller_interface::CallbackReturn;

/// How far the joints of an arm go in 0.3 s at a twist [rad]; -1 where the controller refuses it.
double way_of(const std::string& arm, std::size_t joints) {
  auto& parameters = stand_in::parameters;
  parameters = {};
  parameters.arm = arm;
  parameters.base_frame = "base";
  parameters.joints.assign(joints, "joint");
  const auto controller = stand_in::exported_controller();
  if (controller->on_init() != CallbackReturn::SUCCESS || controller->on_configure({}) != CallbackReturn::SUCCESS) {
    return -1.0;
  }
  std::vector<double> q{0.1, -0.9, 0.2, -1.5, 0.3, 1.2, 0.4};
  q.resize(joints);
  const std::vector<double> start = q;
  controller->assign_interfaces({q.begin(), q.end()}, {q.begin(), q.end()});
  if (controller->on_activate({}) != CallbackReturn::SUCCESS) return -1.0;
  using Twist = geometry_msgs::msg::TwistStamped;
  Twist twist;
  twist.header.frame_id = "base";
  twist.twist.linear.z = 0.05;
  std::any_cast<std::shared_ptr<rclcpp::Subscription<Twist>>>(controller->get_node()->topics.at("~/target_twist"))
      ->hear(twist);
  for (int i = 0; i < 300; ++i) (void)controller->update(rclcpp::Time(), rclcpp::Duration(0, 1000000));
  double way = 0.0;
  for (std::size_t i = 0; i < joints; ++i) way += std::abs(q[i] - start[i]);
  return way;
}

}  // namespace

void every_arm() {
  for (const auto& arm : fpbm::presets::kAll) {
    const std::size_t joints = arm.chain().joints.size();
    const double way = way_of(arm.name, joints);
    const bool good = way > 0.001 && way < 1.0 && way_of(arm.name, joints - 1) == -1.0;
    check(good, (std::string(arm.name) + ": way of all joints in 0.3 s [rad]").c_str(), way);
  }
}
