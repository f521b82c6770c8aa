#include "fpbm_controllers/target_topics.hpp"

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <utility>

namespace fpbm_controllers {

namespace {

using TipPublisher = rclcpp::Publisher<geometry_msgs::msg::PoseStamped>;

/// Best effort, because a reliable subscription receives no messages of a best-effort publisher, such as a sensor. Only
/// the newest message is kept.
[[nodiscard]] rclcpp::QoS quality() {
  return rclcpp::QoS(1).best_effort();
}

void publish_tips(const Report& report, const Exchange& exchange,
                  const std::vector<std::shared_ptr<TipPublisher>>& publishers) {
  for (std::size_t k = 0; k < publishers.size(); ++k) {
    geometry_msgs::msg::PoseStamped message;
    message.header.stamp = report.time;
    message.header.frame_id = exchange.tasks[k].frame_id;
    message.pose = message_of(report.tasks[k].at);
    publishers[k]->publish(message);
  }
}

void publish_diagnostics(const std::string& node, Exchange& exchange,
                         rclcpp::Publisher<diagnostic_msgs::msg::DiagnosticArray>& publisher) {
  const Report report = exchange.report.get();
  if (!report.active) return;
  std::optional<NearestPair> nearest;
  if (exchange.obstacles) nearest = nearest_pair(*exchange.obstacles->clearance(), report.q);
  diagnostic_msgs::msg::DiagnosticArray message;
  message.header.stamp = report.time;
  message.status.push_back(diagnostic_of(report, exchange.diagnosed, exchange.joints, exchange.names, nearest));
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
  for (std::size_t k = 0; k < exchange.names.size(); ++k) {
    const std::uint64_t rejected = report.tasks[k].rejected;
    if (rejected <= before.tasks[k].rejected) continue;
    const std::uint64_t count = rejected - before.tasks[k].rejected;
    RCLCPP_WARN(logger, "%s%s rejected: %s stamp is %s", counted(count, "target").c_str(),
                of_task(exchange.names[k]).c_str(), count == 1 ? "its" : "the last",
                rejected_message(report.tasks[k]).c_str());
  }
  if (report.missed > before.missed) {
    RCLCPP_WARN(logger, "%s with an interface that another thread had locked",
                counted(report.missed - before.missed, "tick").c_str());
  }
  if (report.limited > 0 && before.limited == 0) {
    RCLCPP_WARN(logger, "%s", limited_message(report, exchange.joints).c_str());
  }
  exchange.logged = report;
}

}  // namespace

TargetTopics::TargetTopics(rclcpp_lifecycle::LifecycleNode& node, const target_controller::Params& params,
                           const std::vector<TaskSettings>& tasks, std::optional<Obstacles> obstacles,
                           const fpbm::JointLimits<Eigen::Dynamic>& limits)
    : exchange_(std::make_shared<Exchange>(tasks.size())) {
  exchange_->obstacles = std::move(obstacles);
  exchange_->arm = params.arm;
  exchange_->joints = params.joints;
  std::vector<std::shared_ptr<TipPublisher>> tips;
  for (std::size_t k = 0; k < tasks.size(); ++k) {
    const TaskSettings& task = tasks[k];
    exchange_->names.push_back(task.name);
    exchange_->tasks[k].frame_id = task.reference.empty() ? params.base_frame : task.reference;
    tips.push_back(
        node.create_publisher<geometry_msgs::msg::PoseStamped>(task.topic("tip_pose"), rclcpp::SystemDefaultsQoS()));
    if (params.input == "joints") continue;
    poses_.push_back(listen<geometry_msgs::msg::PoseStamped>(node, task.topic("target_pose"), k));
    twists_.push_back(listen<geometry_msgs::msg::TwistStamped>(node, task.topic("target_twist"), k));
  }
  if (params.input == "joints") {
    exchange_->messages.emplace(params.joints, limits);
    trajectories_ = listen_to_joints<trajectory_msgs::msg::JointTrajectory>(node, "joint_trajectory");
    positions_ = listen_to_joints<std_msgs::msg::Float64MultiArray>(node, "joint_positions");
  }
  speed_ = node.create_subscription<std_msgs::msg::Float64>(
      "~/speed", quality(),
      [exchange = exchange_, logger = node.get_logger(),
       clock = node.get_clock()](const std_msgs::msg::Float64& message) {
        if (message.data > 0.0 && message.data <= 1.0) {
          exchange->speed.set(message.data);
          return;
        }
        RCLCPP_WARN_THROTTLE(logger, *clock, 1000, "speed dropped: it is %s, and must be in (0, 1]",
                             std::to_string(message.data).c_str());
      });
  if (exchange_->obstacles) {
    // Reliable, because a lost difference would lose an obstacle.
    obstacles_ = node.create_subscription<moveit_msgs::msg::PlanningScene>(
        "~/obstacles", rclcpp::QoS(100),
        [exchange = exchange_, logger = node.get_logger()](const moveit_msgs::msg::PlanningScene& scene) {
          std::vector<std::string> warnings = exchange->obstacles->apply(scene);
          for (const std::string& text : warnings) {
            const auto& before = exchange->scene_warnings;
            if (std::count(before.begin(), before.end(), text) == 0) RCLCPP_WARN(logger, "%s", text.c_str());
          }
          exchange->scene_warnings = std::move(warnings);
          exchange->clearance.set({exchange->obstacles->clearance(), true});
        });
  }
  using Diagnostics = rclcpp::Publisher<diagnostic_msgs::msg::DiagnosticArray>;
  const std::shared_ptr<Diagnostics> diagnostics =
      node.create_publisher<diagnostic_msgs::msg::DiagnosticArray>("/diagnostics", rclcpp::SystemDefaultsQoS());
  const auto period = [](double rate) { return std::chrono::duration<double>(1.0 / rate); };
  tip_timer_ =
      node.create_wall_timer(period(params.tip_rate), [exchange = exchange_, tips, logger = node.get_logger()] {
        const Report report = exchange->report.get();
        log_events(report, *exchange, logger);
        if (report.active) publish_tips(report, *exchange, tips);
      });
  diagnostics_timer_ = node.create_wall_timer(period(params.diagnostics_rate),
                                              [exchange = exchange_, diagnostics, name = std::string(node.get_name())] {
                                                publish_diagnostics(name, *exchange, *diagnostics);
                                              });
}

template <typename Message>
std::shared_ptr<rclcpp::Subscription<Message>> TargetTopics::listen(rclcpp_lifecycle::LifecycleNode& node,
                                                                    const std::string& topic, std::size_t task) const {
  return node.create_subscription<Message>(
      topic, quality(),
      [exchange = exchange_, task, logger = node.get_logger(), clock = node.get_clock()](const Message& message) {
        TargetExchange& own = exchange->tasks[task];
        const std::string of = of_task(exchange->names[task]);
        if (message.header.frame_id != own.frame_id) {
          RCLCPP_WARN_THROTTLE(logger, *clock, 1000, "target%s dropped: its frame is '%s', not '%s'", of.c_str(),
                               message.header.frame_id.c_str(), own.frame_id.c_str());
          return;
        }
        std::optional<Target> target = target_of(message);
        if (!target) {
          RCLCPP_WARN_THROTTLE(logger, *clock, 1000,
                               "target%s dropped: all numbers must be finite, and the quaternion's length 1",
                               of.c_str());
          return;
        }
        target->count = ++own.received;
        own.target.set(*target);
      });
}

template <typename Message>
std::shared_ptr<rclcpp::Subscription<Message>> TargetTopics::listen_to_joints(rclcpp_lifecycle::LifecycleNode& node,
                                                                              const std::string& name) const {
  return node.create_subscription<Message>(
      "~/" + name, quality(),
      [exchange = exchange_, name, logger = node.get_logger(), clock = node.get_clock()](const Message& message) {
        try {
          exchange->chunk.set({std::make_shared<JointChunk>(exchange->messages->chunk_of(message)), true});
        } catch (const std::invalid_argument& error) {
          RCLCPP_WARN_THROTTLE(logger, *clock, 1000, "%s dropped: %s", name.c_str(), error.what());
        }
      });
}

}  // namespace fpbm_controllers
