#include <chrono>

#include "fpbm_controllers/target_controller.hpp"

namespace fpbm_controllers {

template <typename Message>
std::shared_ptr<rclcpp::Subscription<Message>> TargetController::listen(const std::string& topic) {
  return get_node()->template create_subscription<Message>(
      topic, rclcpp::SystemDefaultsQoS(), [this](const Message& message) {
        const auto node = get_node();
        if (message.header.frame_id != params_.base_frame) {
          RCLCPP_WARN_THROTTLE(node->get_logger(), *node->get_clock(), 1000,
                               "target dropped: its frame is '%s', not '%s'", message.header.frame_id.c_str(),
                               params_.base_frame.c_str());
          return;
        }
        std::optional<Target> target = target_of(message);
        if (!target) {
          RCLCPP_WARN_THROTTLE(node->get_logger(), *node->get_clock(), 1000,
                               "target dropped: a number is not finite, or the quaternion's length is not 1");
          return;
        }
        target->count = ++received_;
        target_.set(*target);
      });
}

void TargetController::publish_tip() {
  const Report report = report_.get();
  if (!report.active) return;
  geometry_msgs::msg::PoseStamped message;
  message.header.stamp = report.time;
  message.header.frame_id = params_.base_frame;
  message.pose = message_of(report.tip);
  tip_->publish(message);
}

void TargetController::publish_diagnostics() {
  const Report report = report_.get();
  if (!report.active) return;
  diagnostic_msgs::msg::DiagnosticArray message;
  message.header.stamp = report.time;
  message.status.push_back(diagnostic_of(report));
  message.status.back().name = std::string(get_node()->get_name()) + ": motion";
  message.status.back().hardware_id = params_.arm;
  diagnostics_->publish(message);
}

void TargetController::open_topics() {
  const auto node = get_node();
  poses_ = listen<geometry_msgs::msg::PoseStamped>("~/target_pose");
  twists_ = listen<geometry_msgs::msg::TwistStamped>("~/target_twist");
  tip_ = node->create_publisher<geometry_msgs::msg::PoseStamped>("~/tip_pose", rclcpp::SystemDefaultsQoS());
  diagnostics_ =
      node->create_publisher<diagnostic_msgs::msg::DiagnosticArray>("/diagnostics", rclcpp::SystemDefaultsQoS());
  const auto period = [](double rate) { return std::chrono::duration<double>(1.0 / rate); };
  tip_timer_ = node->create_wall_timer(period(params_.tip_rate), [this] { publish_tip(); });
  diagnostics_timer_ = node->create_wall_timer(period(params_.diagnostics_rate), [this] { publish_diagnostics(); });
}

}  // namespace fpbm_controllers
