#include "fpbm_controllers/target_topics.hpp"

#include <chrono>

namespace fpbm_controllers {

namespace {

void publish_tip(const Report& report, const Exchange& exchange,
                 rclcpp::Publisher<geometry_msgs::msg::PoseStamped>& publisher) {
  geometry_msgs::msg::PoseStamped message;
  message.header.stamp = report.time;
  message.header.frame_id = exchange.base_frame;
  message.pose = message_of(report.tip);
  publisher.publish(message);
}

void publish_diagnostics(const std::string& node, Exchange& exchange,
                         rclcpp::Publisher<diagnostic_msgs::msg::DiagnosticArray>& publisher) {
  const Report report = exchange.report.get();
  if (!report.active) return;
  diagnostic_msgs::msg::DiagnosticArray message;
  message.header.stamp = report.time;
  message.status.push_back(diagnostic_of(report, exchange.diagnosed, exchange.joints));
  message.status.back().name = node + ": motion";
  message.status.back().hardware_id = exchange.arm;
  exchange.diagnosed = report;
  publisher.publish(message);
}

/// Events of the loop, which itself writes no log.
void log_events(const Report& report, Exchange& exchange, const rclcpp::Logger& logger) {
  const Report& before = exchange.logged;
  if (report.fault != Fault::kNone && before.fault == Fault::kNone) {
    RCLCPP_ERROR(logger, "%s", message_of(report, exchange.joints).c_str());
  }
  if (report.refused > before.refused) {
    RCLCPP_WARN(logger, "%s targets refused: their stamps are not newer than those before. Check the sender's clock.",
                std::to_string(report.refused - before.refused).c_str());
  }
  if (report.missed > before.missed) {
    RCLCPP_WARN(logger, "%s ticks with an interface that another thread had locked",
                std::to_string(report.missed - before.missed).c_str());
  }
  exchange.logged = report;
}

}  // namespace

TargetTopics::TargetTopics(rclcpp_lifecycle::LifecycleNode& node, const Settings& settings) {
  exchange_->base_frame = settings.base_frame;
  exchange_->arm = settings.arm;
  exchange_->joints = settings.joints;
  poses_ = listen<geometry_msgs::msg::PoseStamped>(node, "~/target_pose");
  twists_ = listen<geometry_msgs::msg::TwistStamped>(node, "~/target_twist");

  using Tip = rclcpp::Publisher<geometry_msgs::msg::PoseStamped>;
  const std::shared_ptr<Tip> tip =
      node.create_publisher<geometry_msgs::msg::PoseStamped>("~/tip_pose", rclcpp::SystemDefaultsQoS());
  using Diagnostics = rclcpp::Publisher<diagnostic_msgs::msg::DiagnosticArray>;
  const std::shared_ptr<Diagnostics> diagnostics =
      node.create_publisher<diagnostic_msgs::msg::DiagnosticArray>("/diagnostics", rclcpp::SystemDefaultsQoS());
  const auto period = [](double rate) { return std::chrono::duration<double>(1.0 / rate); };
  tip_timer_ =
      node.create_wall_timer(period(settings.tip_rate), [exchange = exchange_, tip, logger = node.get_logger()] {
        const Report report = exchange->report.get();
        log_events(report, *exchange, logger);
        if (report.active) publish_tip(report, *exchange, *tip);
      });
  diagnostics_timer_ = node.create_wall_timer(period(settings.diagnostics_rate),
                                              [exchange = exchange_, diagnostics, name = std::string(node.get_name())] {
                                                publish_diagnostics(name, *exchange, *diagnostics);
                                              });
}

/// Best effort, since a subscription that asks for reliable messages gets none of a sensor's; and the newest alone.
template <typename Message>
std::shared_ptr<rclcpp::Subscription<Message>> TargetTopics::listen(rclcpp_lifecycle::LifecycleNode& node,
                                                                    const std::string& topic) const {
  return node.create_subscription<Message>(
      topic, rclcpp::QoS(1).best_effort(),
      [exchange = exchange_, logger = node.get_logger(), clock = node.get_clock()](const Message& message) {
        if (message.header.frame_id != exchange->base_frame) {
          RCLCPP_WARN_THROTTLE(logger, *clock, 1000, "target dropped: its frame is '%s', not '%s'",
                               message.header.frame_id.c_str(), exchange->base_frame.c_str());
          return;
        }
        std::optional<Target> target = target_of(message);
        if (!target) {
          RCLCPP_WARN_THROTTLE(logger, *clock, 1000,
                               "target dropped: a number is not finite, or the quaternion's length is not 1");
          return;
        }
        target->count = ++exchange->received;
        exchange->target.set(*target);
      });
}

}  // namespace fpbm_controllers
