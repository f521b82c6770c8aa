// A Panda draws a circle under ros2_control: Tracker::tick() in a controller's update(), which commands joint positions
// and can be paused and resumed by messages on ~/run.
// This has been compiled and run against a stand-in of ros2_control (its interfaces since 4.27) only, never on a robot.

#include <atomic>
#include <controller_interface/controller_interface.hpp>
#include <exception>
#include <fpbm/fpbm.hpp>
#include <fpbm/realtime/tracker.hpp>
#include <hardware_interface/types/hardware_interface_type_values.hpp>
#include <memory>
#include <optional>
#include <pluginlib/class_list_macros.hpp>
#include <std_msgs/msg/bool.hpp>
#include <stdexcept>
#include <string>
#include <vector>

namespace fpbm_controllers {

using controller_interface::CallbackReturn;
using controller_interface::InterfaceConfiguration;
using controller_interface::return_type;

class TrackingController : public controller_interface::ControllerInterface {
 public:
  CallbackReturn on_init() override {
    auto_declare<std::vector<std::string>>("joints", {"panda_joint1", "panda_joint2", "panda_joint3", "panda_joint4",
                                                      "panda_joint5", "panda_joint6", "panda_joint7"});
    auto_declare<double>("radius", 0.1);            // [m]
    auto_declare<double>("duration", 5.0);          // [s]
    auto_declare<double>("following_error", 0.05);  // [rad], above which the arm is brought to rest
    return CallbackReturn::SUCCESS;
  }

  InterfaceConfiguration command_interface_configuration() const override { return positions_of_joints(); }
  InterfaceConfiguration state_interface_configuration() const override { return positions_of_joints(); }

  /// Builds everything whose construction may throw or allocate.
  CallbackReturn on_configure(const rclcpp_lifecycle::State&) override {
    const auto node = get_node();
    try {
      joints_ = node->get_parameter("joints").as_string_array();
      if (joints_.size() != kDof) throw std::invalid_argument("joints: must be seven names");
      following_error_ = node->get_parameter("following_error").as_double();
      options_.dt = 1.0 / static_cast<double>(get_update_rate());
      limits_.emplace(arm_.limits(), options_.dt);
      const fpbm::Path circle(fpbm::Circle(node->get_parameter("radius").as_double()),
                              node->get_parameter("duration").as_double(), fpbm::Quintic{});
      path_.emplace(fpbm::InPlane(circle, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}));  // Its orientation is held.
    } catch (const std::exception& error) {
      RCLCPP_ERROR(node->get_logger(), "%s", error.what());
      return CallbackReturn::FAILURE;
    }
    run_subscription_ = node->create_subscription<std_msgs::msg::Bool>(
        "~/run", rclcpp::SystemDefaultsQoS(), [this](const std_msgs::msg::Bool& message) { run_ = message.data; });
    return CallbackReturn::SUCCESS;
  }

  /// Begins where the arm stands. All that is built here has a fixed size and lies within the controller.
  CallbackReturn on_activate(const rclcpp_lifecycle::State&) override {
    const std::optional<Joints> start = measured();
    if (!start) return CallbackReturn::FAILURE;
    try {
      const auto homeward = fpbm::NullSpace<kDof>().with_damping(4.0).with_rest_posture(*start, 4.0);
      const Scheme scheme = fpbm::FPBM<kDof>(0.6, Joints{8, 8, 4, 4, 2, 1, 1}, 20.0, 100.0, homeward);
      tracker_.emplace(arm_, fpbm::Pose{}, scheme, fpbm::State<kDof>{*start, Joints::Zero()}, options_, *limits_);
    } catch (const std::exception& error) {  // A joint outside its limits, say.
      RCLCPP_ERROR(get_node()->get_logger(), "%s", error.what());
      return CallbackReturn::FAILURE;
    }
    follower_.emplace(*path_, tracker_->tip());
    run_ = running_ = true;
    return CallbackReturn::SUCCESS;
  }

  /// One tick a call, always of the length that the limits were made for: a late call makes the arm late, never fast.
  return_type update(const rclcpp::Time&, const rclcpp::Duration&) override {
    const std::optional<Joints> q = measured();
    if (!q) return return_type::ERROR;
    // The measured state is compared with the tracker's own, never fed to it.
    if (!((*q - tracker_->state().q).cwiseAbs().maxCoeff() < following_error_)) tracker_->stop();

    if (const bool run = run_; run != running_) {
      running_ = run;
      run ? follower_->resume() : follower_->pause();
    }
    const auto tick = tracker_->tick(*follower_);
    bool written = true;
    for (std::size_t i = 0; i < kDof; ++i) {
      written = command_interfaces_[i].set_value(tick.q(static_cast<Eigen::Index>(i))) && written;
    }
    return written ? return_type::OK : return_type::ERROR;
  }

 private:
  static constexpr int kDof = 7;
  using Joints = fpbm::Vector<kDof>;
  using Arm = fpbm::SerialArm<kDof>;
  using Scheme = fpbm::AccelerationScheme<kDof>;
  using Path = fpbm::WithRotation<fpbm::InPlane<fpbm::Path<fpbm::Circle<>, fpbm::Quintic>>>;

  [[nodiscard]] InterfaceConfiguration positions_of_joints() const {
    InterfaceConfiguration configuration{controller_interface::interface_configuration_type::INDIVIDUAL, {}};
    for (const auto& joint : joints_) {
      configuration.names.push_back(joint + "/" + hardware_interface::HW_IF_POSITION);
    }
    return configuration;
  }

  /// Joint positions in the order of the interfaces; nothing where one cannot be read.
  [[nodiscard]] std::optional<Joints> measured() const {
    Joints q;
    for (std::size_t i = 0; i < kDof; ++i) {
      const std::optional<double> value = state_interfaces_[i].get_optional();
      if (!value) return std::nullopt;
      q(static_cast<Eigen::Index>(i)) = *value;
    }
    return q;
  }

  const Arm arm_{fpbm::presets::panda()};
  std::vector<std::string> joints_;
  double following_error_ = 0.0;
  fpbm::TrackerOptions<> options_;
  std::optional<fpbm::Limits<Scheme::kLevel, kDof>> limits_;
  std::optional<Path> path_;
  std::optional<fpbm::Tracker<Arm, fpbm::Pose, Scheme>> tracker_;
  std::optional<fpbm::PathFollower<Path>> follower_;
  std::shared_ptr<rclcpp::Subscription<std_msgs::msg::Bool>> run_subscription_;
  std::atomic<bool> run_{true};  ///< What the last message asked for.
  bool running_ = true;          ///< What the follower does.
};

}  // namespace fpbm_controllers

PLUGINLIB_EXPORT_CLASS(fpbm_controllers::TrackingController, controller_interface::ControllerInterface)
