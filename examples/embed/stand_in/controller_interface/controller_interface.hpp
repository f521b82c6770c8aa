#pragma once

#include <cstdio>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

// Stands in for ros2_control's header of this name and for those of rclcpp that it brings along: only what the
// controller uses, with interfaces that are plain numbers.
namespace rclcpp {

class Time {};
class Duration {};
struct SystemDefaultsQoS {};

template <typename Message>
struct Subscription {
  std::function<void(const Message&)> callback;
};

class Parameter {
 public:
  using Value = std::variant<double, std::vector<std::string>>;
  explicit Parameter(Value value) : value_(std::move(value)) {}
  [[nodiscard]] double as_double() const { return std::get<double>(value_); }
  [[nodiscard]] std::vector<std::string> as_string_array() const { return std::get<std::vector<std::string>>(value_); }

 private:
  Value value_;
};

}  // namespace rclcpp

#define RCLCPP_ERROR(logger, ...) (static_cast<void>(logger), std::fprintf(stderr, __VA_ARGS__))

namespace rclcpp_lifecycle {

class State {};

class LifecycleNode {
 public:
  void declare(const std::string& name, const rclcpp::Parameter::Value& value) { parameters_.emplace(name, value); }
  [[nodiscard]] rclcpp::Parameter get_parameter(const std::string& name) const {
    return rclcpp::Parameter(parameters_.at(name));
  }
  [[nodiscard]] int get_logger() const { return 0; }

  template <typename Message, typename Callback>
  std::shared_ptr<rclcpp::Subscription<Message>> create_subscription(const std::string&, rclcpp::SystemDefaultsQoS,
                                                                     Callback&& callback) {
    return std::make_shared<rclcpp::Subscription<Message>>(rclcpp::Subscription<Message>{callback});
  }

 private:
  std::map<std::string, rclcpp::Parameter::Value> parameters_;
};

}  // namespace rclcpp_lifecycle

namespace hardware_interface {

class LoanedStateInterface {
 public:
  explicit LoanedStateInterface(double& value) : value_(&value) {}
  template <typename T = double>
  [[nodiscard]] std::optional<T> get_optional() const {
    return *value_;
  }

 protected:
  double* value_;
};

class LoanedCommandInterface : public LoanedStateInterface {
 public:
  using LoanedStateInterface::LoanedStateInterface;
  template <typename T>
  [[nodiscard]] bool set_value(const T& value) {
    *value_ = value;
    return true;
  }
};

}  // namespace hardware_interface

namespace controller_interface {

enum class CallbackReturn { SUCCESS, FAILURE, ERROR };
enum class return_type : unsigned char { OK = 0, ERROR = 1 };
enum class interface_configuration_type : unsigned char { ALL = 0, INDIVIDUAL = 1, NONE = 2 };

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
  virtual return_type update(const rclcpp::Time&, const rclcpp::Duration&) = 0;

  void assign_interfaces(std::vector<hardware_interface::LoanedCommandInterface>&& command_interfaces,
                         std::vector<hardware_interface::LoanedStateInterface>&& state_interfaces) {
    command_interfaces_ = std::move(command_interfaces);
    state_interfaces_ = std::move(state_interfaces);
  }
  [[nodiscard]] unsigned int get_update_rate() const { return 1000; }
  std::shared_ptr<rclcpp_lifecycle::LifecycleNode> get_node() { return node_; }

 protected:
  template <typename T>
  void auto_declare(const std::string& name, const T& value) {
    node_->declare(name, value);
  }

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
