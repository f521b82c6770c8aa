#pragma once

#include <any>
#include <chrono>
#include <cmath>
#include <controller_interface/controller_interface_params.hpp>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <rclcpp/rclcpp.hpp>
#include <string>
#include <utility>
#include <vector>

// Stands in for ros2_control's header of this name and for the headers that it includes: only the members that the
// controller uses. Command and state interfaces are references to numbers. The signatures equal ros2_control 4.46
// (Jazzy) and 6.8 (Rolling).
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
  std::shared_ptr<rclcpp::Subscription<Message>> create_subscription(const std::string& topic, const rclcpp::QoS& qos,
                                                                     Callback&& callback) {
    const auto made = std::make_shared<rclcpp::Subscription<Message>>(qos, std::forward<Callback>(callback));
    topics[topic] = std::weak_ptr<rclcpp::Subscription<Message>>(made);
    return made;
  }
  template <typename Message>
  std::shared_ptr<rclcpp::Publisher<Message>> create_publisher(const std::string& topic, const rclcpp::QoS&) {
    const auto made = std::make_shared<rclcpp::Publisher<Message>>();
    topics[topic] = std::weak_ptr<rclcpp::Publisher<Message>>(made);
    return made;
  }
  /// Throws if the period is not a number, or less than a nanosecond.
  template <typename Rep, typename Period, typename Callback>
  std::shared_ptr<rclcpp::TimerBase> create_wall_timer(std::chrono::duration<Rep, Period> period, Callback callback) {
    if (!(period.count() >= Rep(1e-9))) throw std::invalid_argument("timer period must be positive");
    const auto made = std::make_shared<rclcpp::TimerBase>(callback);
    timers.push_back(made);
    return made;
  }

  [[nodiscard]] std::shared_ptr<rclcpp::node_interfaces::NodeParametersInterface> get_node_parameters_interface() {
    return parameters_;
  }
  [[nodiscard]] bool has_parameter(const std::string& name) const { return parameters_->has_parameter(name); }
  [[nodiscard]] rclcpp::Parameter get_parameter(const std::string& name) const {
    return parameters_->get_parameter(name);
  }

  std::map<std::string, std::any> topics;  ///< Weak pointers, like the references in a node of ROS.
  std::vector<std::weak_ptr<rclcpp::TimerBase>> timers;

 private:
  std::shared_ptr<rclcpp::Clock> clock_ = std::make_shared<rclcpp::Clock>();
  std::shared_ptr<rclcpp::node_interfaces::NodeParametersInterface> parameters_ =
      std::make_shared<rclcpp::node_interfaces::NodeParametersInterface>();
};

}  // namespace rclcpp_lifecycle

namespace stand_in {

inline bool locked = false;  ///< Whether another thread has locked every interface.
inline int refusals = 0;     ///< Number of commands to locked interfaces.

/// Lock of an interface by another thread. calls: number of further calls that fail.
struct Lock {
  int calls = 0;
  [[nodiscard]] bool refuses() { return locked || (calls > 0 && calls-- > 0); }
};

}  // namespace stand_in

namespace hardware_interface {

class LoanedStateInterface {
 public:
  LoanedStateInterface(double& value, stand_in::Lock& lock) : value_(&value), lock_(&lock) {}
  template <typename T = double>
  [[nodiscard]] std::optional<T> get_optional(unsigned int = 10) const {
    return lock_->refuses() ? std::nullopt : std::optional<T>(*value_);
  }

 protected:
  double* value_;
  stand_in::Lock* lock_;
};

class LoanedCommandInterface : public LoanedStateInterface {
 public:
  using LoanedStateInterface::LoanedStateInterface;
  template <typename T>
  [[nodiscard]] bool set_value(const T& value, unsigned int = 10) {
    const bool refused = lock_->refuses();
    if (refused) {
      ++stand_in::refusals;
    } else {
      *value_ = value;
    }
    return !refused;
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

/// The callbacks have the defaults of rclcpp_lifecycle.
class ControllerInterface {
 public:
  virtual ~ControllerInterface() = default;
  virtual CallbackReturn on_init() = 0;
  [[nodiscard]] virtual InterfaceConfiguration command_interface_configuration() const = 0;
  [[nodiscard]] virtual InterfaceConfiguration state_interface_configuration() const = 0;
  virtual CallbackReturn on_configure(const rclcpp_lifecycle::State&) { return CallbackReturn::SUCCESS; }
  virtual CallbackReturn on_cleanup(const rclcpp_lifecycle::State&) { return CallbackReturn::SUCCESS; }
  virtual CallbackReturn on_activate(const rclcpp_lifecycle::State&) { return CallbackReturn::SUCCESS; }
  virtual CallbackReturn on_deactivate(const rclcpp_lifecycle::State&) { return CallbackReturn::SUCCESS; }
  virtual CallbackReturn on_shutdown(const rclcpp_lifecycle::State&) { return CallbackReturn::SUCCESS; }
  virtual CallbackReturn on_error(const rclcpp_lifecycle::State&) { return CallbackReturn::FAILURE; }
  virtual return_type update(const rclcpp::Time& time, const rclcpp::Duration& period) = 0;

  /// Declares the parameters of every controller, then calls on_init().
  return_type init(const ControllerInterfaceParams& given,
                   const std::map<std::string, rclcpp::ParameterValue>& overrides) {
    params_ = given;
    const auto parameters = node_->get_node_parameters_interface();
    parameters->overrides = overrides;
    const auto rate = static_cast<std::int64_t>(given.controller_manager_update_rate);
    parameters->declare_parameter("update_rate", rclcpp::ParameterValue(rate));
    parameters->declare_parameter("is_async", rclcpp::ParameterValue(false));
    parameters->declare_parameter("use_sim_time", rclcpp::ParameterValue(false));
    return on_init() == CallbackReturn::SUCCESS ? return_type::OK : return_type::ERROR;
  }
  /// If the update rate does not divide the rate of the manager, the update rate becomes a whole number of hertz near a
  /// rate that divides the rate of the manager.
  CallbackReturn configure() {
    const std::int64_t own = node_->get_parameter("update_rate").as_int();
    const std::int64_t manager = params_.controller_manager_update_rate;
    if (own > 0 && own <= manager) {
      const auto ticks = std::llround(static_cast<double>(manager) / static_cast<double>(own));
      params_.update_rate = static_cast<unsigned int>(manager % own == 0 ? own : manager / ticks);
    }
    async_ = node_->get_parameter("is_async").as_bool();
    return on_configure({});
  }
  void assign_interfaces(std::vector<hardware_interface::LoanedCommandInterface>&& command_interfaces,
                         std::vector<hardware_interface::LoanedStateInterface>&& state_interfaces) {
    command_interfaces_ = std::move(command_interfaces);
    state_interfaces_ = std::move(state_interfaces);
  }
  void release_interfaces() {
    command_interfaces_.clear();
    state_interfaces_.clear();
  }
  [[nodiscard]] unsigned int get_update_rate() const { return params_.update_rate; }
  [[nodiscard]] bool is_async() const { return async_; }
  [[nodiscard]] const std::string& get_robot_description() const { return params_.robot_description; }
  std::shared_ptr<rclcpp_lifecycle::LifecycleNode> get_node() { return node_; }
  [[nodiscard]] std::shared_ptr<const rclcpp_lifecycle::LifecycleNode> get_node() const { return node_; }

 protected:
  std::vector<hardware_interface::LoanedCommandInterface> command_interfaces_;
  std::vector<hardware_interface::LoanedStateInterface> state_interfaces_;

 private:
  ControllerInterfaceParams params_;
  bool async_ = false;
  std::shared_ptr<rclcpp_lifecycle::LifecycleNode> node_ = std::make_shared<rclcpp_lifecycle::LifecycleNode>();
};

}  // namespace controller_interface

namespace stand_in {

/// A controller of the class in PLUGINLIB_EXPORT_CLASS.
std::unique_ptr<controller_interface::ControllerInterface> exported_plugin();

}  // namespace stand_in
