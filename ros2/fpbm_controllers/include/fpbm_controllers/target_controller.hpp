#pragma once

#include <controller_interface/controller_interface.hpp>
#include <cstdint>
#include <diagnostic_msgs/msg/diagnostic_array.hpp>
#include <fpbm/fpbm.hpp>
#include <fpbm_controllers/report.hpp>
#include <fpbm_controllers/target.hpp>
#include <fpbm_controllers/target_controller_parameters.hpp>
#include <geometry_msgs/msg/pose_stamped.hpp>
#include <geometry_msgs/msg/twist_stamped.hpp>
#include <memory>
#include <optional>
#include <rclcpp/rclcpp.hpp>
#include <realtime_tools/realtime_thread_safe_box.hpp>
#include <string>
#include <vector>

namespace fpbm_controllers {

/// Brings the tip to poses, or moves it at twists, that come as messages at any rate, and keeps the joint limits at
/// every tick.
///
/// A tick goes on from the last command, never from the measured posture: this is only compared with it.
class TargetController : public controller_interface::ControllerInterface {
 public:
  controller_interface::CallbackReturn on_init() override;
  [[nodiscard]] controller_interface::InterfaceConfiguration command_interface_configuration() const override;
  [[nodiscard]] controller_interface::InterfaceConfiguration state_interface_configuration() const override;
  controller_interface::CallbackReturn on_configure(const rclcpp_lifecycle::State& previous) override;
  controller_interface::CallbackReturn on_activate(const rclcpp_lifecycle::State& previous) override;
  controller_interface::CallbackReturn on_deactivate(const rclcpp_lifecycle::State& previous) override;
  controller_interface::return_type update(const rclcpp::Time& time, const rclcpp::Duration& period) override;

 private:
  static constexpr int kDof = Eigen::Dynamic;  // One instantiation serves arms of any length.
  using Joints = fpbm::Vector<kDof>;
  using JointLimits = fpbm::JointLimits<kDof>;
  using Arm = fpbm::SerialArm<kDof>;
  using Scheme = fpbm::AccelerationScheme<kDof>;
  using Tracker = fpbm::Tracker<Arm, fpbm::Pose, Scheme>;

  /// Throws std::invalid_argument where a parameter does not fit.
  void read_parameters();
  /// The arm's, or what is given in place of them.
  [[nodiscard]] JointLimits limits() const;
  [[nodiscard]] Scheme scheme(const Joints& start) const;

  void open_topics();
  template <typename Message>
  [[nodiscard]] std::shared_ptr<rclcpp::Subscription<Message>> listen(const std::string& topic);
  void publish_tip();
  void publish_diagnostics();

  void take_target() noexcept;
  /// Whether every joint's position could be read; the others keep their last reading.
  [[nodiscard]] bool measure();
  /// How far the last reading is from the last command, by the joint where that is largest [rad]; infinite where a
  /// reading is no number.
  [[nodiscard]] double following_error() const;
  /// Whether every joint took its command.
  [[nodiscard]] bool command(const Joints& q, const Joints& qd);

  std::shared_ptr<target_controller::ParamListener> listener_;
  target_controller::Params params_;
  std::optional<Arm> arm_;
  fpbm::TrackerOptions<> options_;
  std::optional<fpbm::Limits<Scheme::kLevel, kDof>> limits_;

  // Of an active controller, and of the loop alone.
  std::optional<Tracker> tracker_;
  std::optional<fpbm::TargetFilter<fpbm::Pose>> filter_;
  std::uint64_t seen_ = 0;  ///< The newest target's count.
  std::uint64_t refused_ = 0;
  std::uint64_t missed_ = 0;
  Joints measured_;
  bool lost_ = false;

  // Between the loop, which never waits for them, and the node's callbacks.
  realtime_tools::RealtimeThreadSafeBox<Target> target_;
  realtime_tools::RealtimeThreadSafeBox<Report> report_;

  std::uint64_t received_ = 0;  ///< Of the callbacks alone.
  std::shared_ptr<rclcpp::Subscription<geometry_msgs::msg::PoseStamped>> poses_;
  std::shared_ptr<rclcpp::Subscription<geometry_msgs::msg::TwistStamped>> twists_;
  std::shared_ptr<rclcpp::Publisher<geometry_msgs::msg::PoseStamped>> tip_;
  std::shared_ptr<rclcpp::Publisher<diagnostic_msgs::msg::DiagnosticArray>> diagnostics_;
  std::shared_ptr<rclcpp::TimerBase> tip_timer_;
  std::shared_ptr<rclcpp::TimerBase> diagnostics_timer_;
};

}  // namespace fpbm_controllers
