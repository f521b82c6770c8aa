#pragma once

#include <any>
#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <rclcpp/rclcpp.hpp>
#include <string>
#include <utility>
#include <vector>

// Stands in for ros2_control's header of this name and for those that it brings along: only what the controller uses,
// with interfaces that are plain numbers. Signatures are those of ros2_control 4.46 (Jazzy) and 6.8 (Rolling).
namespace rclcpp_lifecycle {

class State {};

namespace node_interfaces {

struct LifecycleNodeInterface {
  enum class CallbackReturn : std::uint8_t { SUCCESS = 97, FAILURE = 98, ERROR = 99 };
};

}  // namespace node_interfaces

class LifecycleNode {
 public:
  [[nodiscard]] const char* get_name() const { return "targets"; }
  [[nodiscard]] rclcpp::Logger get_logger() const { return {}; }
  [[nodiscard]] std::shared_ptr<rclcpp::Clock> get_clock() { return clock_; }

  template <typename Message, typename Callback>
  std::shared_ptr<rclcpp::Subscription<Message>> create_subscription(const std::string& topic, const rclcpp::QoS&,
                                                                     Callback&& callback) {
    const auto made = std::make_shared<rclcpp::Subscription<Message>>(std::forward<Callback>(callback));
    topics[topic] = made;
    return made;
  }
  template <typename Message>
  std::shared_ptr<rclcpp::Publisher<Message>> create_publisher(const std::string& topic, const rclcpp::QoS&) {
    const auto made = std::make_shared<rclcpp::Publisher<Message>>();
    topics[topic] = made;
    return made;
  }
  template <typename Rep, typename Period, typename Callback>
  std::shared_ptr<rclcpp::TimerBase> create_wall_timer(std::chrono::duration<Rep, Period>, Callback callback) {
    timers.push_back(std::make_shared<rclcpp::TimerBase>(callback));
    return timers.back();
  }

  std::map<std::string, std::any> topics;
  std::vector<std::shared_ptr<rclcpp::TimerBase>> timers;

 private:
  std::shared_ptr<rclcpp::Clock> clock_ = std::make_shared<rclcpp::Clock>();
};

}  // namespace rclcpp_lifecycle

namespace stand_in {

inline bool locked = false;  ///< Whether another thread has locked every interface.

}  // namespace stand_in

namespace hardware_interface {

class LoanedStateInterface {
 public:
  explicit LoanedStateInterface(double& value) : value_(&value) {}
  template <typename T = double>
  [[nodiscard]] std::optional<T> get_optional(unsigned int = 10) const {
    return stand_in::locked ? std::nullopt : std::optional<T>(*value_);
  }

 protected:
  double* value_;
};

class LoanedCommandInterface : public LoanedStateInterface {
 public:
  using LoanedStateInterface::LoanedStateInterface;
  template <typename T>
  [[nodiscard]] bool set_value(const T& value, unsigned int = 10) {
    if (!stand_in::locked) *value_ = value;
    return !stand_in::locked;
  }
};

}  // namespace hardware_interface

namespace controller_interface {

using CallbackReturn = rclcpp_lifecycle::node_interfaces::LifecycleNodeInterface::CallbackReturn;
enum class return_type : std::uint8_t { OK = 0, ERROR = 1 };
enum class interface_configuration_type : std::uint8_t { ALL = 0, INDIVIDUAL = 1, NONE = 2 };

struct InterfaceConfiguration {
  interface_configuration_type type = interface_configuration_type::NONE;
  std::vector<std::string> names = {};
};

class ControllerInterface {
 public:
  virtual ~ControllerInterface() = default;
  virtual CallbackReturn on_init() = 0;
  [[nodiscard]] virtual InterfaceConfiguration command_interface_configuration() const = 0;
  [[nodiscard]] virtual InterfaceConfiguration state_interface_configuration() const = 0;
  virtual CallbackReturn on_configure(const rclcpp_lifecycle::State&) { return CallbackReturn::SUCCESS; }
  virtual CallbackReturn on_activate(const rclcpp_lifecycle::State&) { return CallbackReturn::SUCCESS; }
  virtual CallbackReturn on_deactivate(const rclcpp_lifecycle::State&) { return CallbackReturn::SUCCESS; }
  virtual return_type update(const rclcpp::Time& time, const rclcpp::Duration& period) = 0;

  void assign_interfaces(std::vector<hardware_interface::LoanedCommandInterface>&& command_interfaces,
                         std::vector<hardware_interface::LoanedStateInterface>&& state_interfaces) {
    command_interfaces_ = std::move(command_interfaces);
    state_interfaces_ = std::move(state_interfaces);
  }
  [[nodiscard]] unsigned int get_update_rate() const { return 1000; }
  std::shared_ptr<rclcpp_lifecycle::LifecycleNode> get_node() { return node_; }
  [[nodiscard]] std::shared_ptr<const rclcpp_lifecycle::LifecycleNode> get_node() const { return node_; }

 protected:
  std::vector<hardware_interface::LoanedCommandInterface> command_interfaces_;
  std::vector<hardware_interface::LoanedStateInterface> state_interfaces_;

 private:
  std::shared_ptr<rclcpp_lifecycle::LifecycleNode> node_ = std::make_shared<rclcpp_lifecycle::LifecycleNode>();
};

}  // namespace controller_interface

namespace stand_in {

/// The controller that PLUGINLIB_EXPORT_CLASS has named.
std::unique_ptr<controller_interface::ControllerInterface> exported_controller();

}  // namespace stand_in
