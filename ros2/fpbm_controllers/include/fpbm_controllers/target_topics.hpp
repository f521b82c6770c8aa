#pragma once

#include <cstddef>
#include <cstdint>
#include <diagnostic_msgs/msg/diagnostic_array.hpp>
#include <fpbm_controllers/joint_messages.hpp>
#include <fpbm_controllers/obstacles.hpp>
#include <fpbm_controllers/report.hpp>
#include <fpbm_controllers/target.hpp>
#include <fpbm_controllers/task_settings.hpp>
#include <geometry_msgs/msg/pose_stamped.hpp>
#include <geometry_msgs/msg/twist_stamped.hpp>
#include <memory>
#include <moveit_msgs/msg/planning_scene.hpp>
#include <optional>
#include <rclcpp/rclcpp.hpp>
#include <rclcpp_lifecycle/lifecycle_node.hpp>
#include <realtime_tools/realtime_thread_safe_box.hpp>
#include <std_msgs/msg/float64.hpp>
#include <string>
#include <utility>
#include <vector>

namespace fpbm_controllers {

/// The targets of a task, which the callbacks pass to the loop.
struct TargetExchange {
  realtime_tools::RealtimeThreadSafeBox<Target> target;

  // Only for the callbacks.
  std::string frame_id;  ///< Frame of targets: the base frame or the reference frame.
  std::uint64_t received = 0;
};

/// An object for the loop, which swaps its own object for a new object: only the callbacks allocate and free.
template <typename T>
struct Offer {
  std::shared_ptr<T> object;
  bool is_new = false;
};
template <typename T>
using OfferBox = realtime_tools::RealtimeThreadSafeBox<Offer<T>>;

/// Swaps an object of the loop for a new object. Returns whether there is a new object.
template <typename T>
bool take(OfferBox<T>& box, std::shared_ptr<T>& own) noexcept {
  bool is_new = false;
  (void)box.try_set([&own, &is_new](Offer<T>& offer) {
    is_new = std::exchange(offer.is_new, false);
    if (is_new) std::swap(own, offer.object);
  });
  return is_new;
}

/// Data that the loop and the node's callbacks exchange. The loop never waits for a callback. Each callback shares the
/// ownership of the data, because the topics may close while a callback runs.
struct Exchange {
  explicit Exchange(std::size_t count) : tasks(count) {}

  std::vector<TargetExchange> tasks;
  realtime_tools::RealtimeThreadSafeBox<double> speed{1.0};  ///< In (0, 1].
  OfferBox<Clearance> clearance;
  OfferBox<JointChunk> chunk;
  realtime_tools::RealtimeThreadSafeBox<Report> report;

  // Used only by the callbacks.
  std::string arm;
  std::vector<std::string> joints;
  std::vector<std::string> names;           ///< Names of the tasks.
  std::optional<Obstacles> obstacles;       ///< None without a clearance.
  std::optional<JointMessages> messages;    ///< None with target poses.
  std::vector<std::string> scene_warnings;  ///< Warnings about the last scene, which are not repeated.
  Report logged;                            ///< The last report whose events were logged.
  Report diagnosed;                         ///< The last published report.
};

/// The controller's topics: the targets and the tip of each task, or joint positions and the tip, the speed, the
/// obstacles if there is a clearance, and the diagnostics. The destructor closes the topics.
class TargetTopics {
 public:
  TargetTopics(rclcpp_lifecycle::LifecycleNode& node, const target_controller::Params& params,
               const std::vector<TaskSettings>& tasks, std::optional<Obstacles> obstacles,
               const fpbm::JointLimits<Eigen::Dynamic>& limits);

  [[nodiscard]] Exchange& exchange() noexcept { return *exchange_; }

 private:
  template <typename Message>
  [[nodiscard]] std::shared_ptr<rclcpp::Subscription<Message>> listen(rclcpp_lifecycle::LifecycleNode& node,
                                                                      const std::string& topic, std::size_t task) const;
  template <typename Message>
  [[nodiscard]] std::shared_ptr<rclcpp::Subscription<Message>> listen_to_joints(rclcpp_lifecycle::LifecycleNode& node,
                                                                                const std::string& name) const;

  std::shared_ptr<Exchange> exchange_;
  std::vector<std::shared_ptr<rclcpp::Subscription<geometry_msgs::msg::PoseStamped>>> poses_;
  std::vector<std::shared_ptr<rclcpp::Subscription<geometry_msgs::msg::TwistStamped>>> twists_;
  std::shared_ptr<rclcpp::Subscription<trajectory_msgs::msg::JointTrajectory>> trajectories_;
  std::shared_ptr<rclcpp::Subscription<std_msgs::msg::Float64MultiArray>> positions_;
  std::shared_ptr<rclcpp::Subscription<std_msgs::msg::Float64>> speed_;
  std::shared_ptr<rclcpp::Subscription<moveit_msgs::msg::PlanningScene>> obstacles_;
  std::shared_ptr<rclcpp::TimerBase> tip_timer_;
  std::shared_ptr<rclcpp::TimerBase> diagnostics_timer_;
};

}  // namespace fpbm_controllers
