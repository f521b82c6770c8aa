#pragma once

#include <cstdint>
#include <diagnostic_msgs/msg/diagnostic_array.hpp>
#include <fpbm_controllers/report.hpp>
#include <fpbm_controllers/target.hpp>
#include <geometry_msgs/msg/pose_stamped.hpp>
#include <geometry_msgs/msg/twist_stamped.hpp>
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <rclcpp_lifecycle/lifecycle_node.hpp>
#include <realtime_tools/realtime_thread_safe_box.hpp>
#include <string>
#include <vector>

namespace fpbm_controllers {

/// What the loop and the node's callbacks exchange. The loop never waits for it. Each callback shares its ownership,
/// since the topics may close while a callback runs.
struct Exchange {
  realtime_tools::RealtimeThreadSafeBox<Target> target;
  realtime_tools::RealtimeThreadSafeBox<Report> report;

  // Of the callbacks alone.
  std::string base_frame;
  std::string arm;
  std::vector<std::string> joints;
  std::uint64_t received = 0;
  Report logged;     ///< The last report whose events were logged,
  Report diagnosed;  ///< and the last that was published.
};

/// The controller's topics. They close when it is destroyed.
class TargetTopics {
 public:
  struct Settings {
    std::string base_frame;
    std::string arm;
    std::vector<std::string> joints;
    double tip_rate;          ///< [Hz]
    double diagnostics_rate;  ///< [Hz]
  };

  TargetTopics(rclcpp_lifecycle::LifecycleNode& node, const Settings& settings);

  [[nodiscard]] Exchange& exchange() noexcept { return *exchange_; }

 private:
  template <typename Message>
  [[nodiscard]] std::shared_ptr<rclcpp::Subscription<Message>> listen(rclcpp_lifecycle::LifecycleNode& node,
                                                                      const std::string& topic) const;

  std::shared_ptr<Exchange> exchange_ = std::make_shared<Exchange>();
  std::shared_ptr<rclcpp::Subscription<geometry_msgs::msg::PoseStamped>> poses_;
  std::shared_ptr<rclcpp::Subscription<geometry_msgs::msg::TwistStamped>> twists_;
  std::shared_ptr<rclcpp::TimerBase> tip_timer_;
  std::shared_ptr<rclcpp::TimerBase> diagnostics_timer_;
};

}  // namespace fpbm_controllers
