#include "fpbm_controllers/parameter_listener.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace fpbm_controllers {

namespace {

using rclcpp::ParameterValue;
using Parameters = rclcpp::node_interfaces::NodeParametersInterface;

/// An integer or an array of integers as floating-point numbers.
[[nodiscard]] std::optional<ParameterValue> as_double(const ParameterValue& value) {
  if (value.get_type() == rclcpp::PARAMETER_INTEGER) {
    return ParameterValue(static_cast<double>(value.get<std::int64_t>()));
  }
  if (value.get_type() != rclcpp::PARAMETER_INTEGER_ARRAY) return std::nullopt;
  const auto& integers = value.get<std::vector<std::int64_t>>();
  return ParameterValue(std::vector<double>(integers.begin(), integers.end()));
}

/// If an error message names a parameter with an integer value, declares this parameter as a floating-point number.
[[nodiscard]] bool declare_as_double(Parameters& parameters, const std::string& message) {
  rcl_interfaces::msg::ParameterDescriptor descriptor;
  descriptor.read_only = true;
  for (const auto& [name, value] : parameters.get_parameter_overrides()) {
    const auto number = as_double(value);
    if (!number || parameters.has_parameter(name) || message.find("'" + name + "'") == std::string::npos) continue;
    (void)parameters.declare_parameter(name, *number, descriptor, true);
    return true;
  }
  return false;
}

/// Throws if a given parameter is neither declared nor a parameter of ROS.
void require_known(const Parameters& parameters) {
  constexpr std::array<const char*, 5> kOfRos{"type", "fallback_controllers", "node_options_args", "qos_overrides.",
                                              "async_parameters."};
  for (const auto& given : parameters.get_parameter_overrides()) {
    const std::string& name = given.first;
    const bool of_ros = std::any_of(kOfRos.begin(), kOfRos.end(), [&](const std::string& own) {
      return own.back() == '.' ? name.compare(0, own.size(), own) == 0 : name == own;
    });
    if (!of_ros && !parameters.has_parameter(name)) {
      throw std::invalid_argument(name + ": is not a parameter of this controller: correct its name, or remove it");
    }
  }
}

}  // namespace

std::shared_ptr<target_controller::ParamListener> listen_to_parameters(
    const std::shared_ptr<rclcpp_lifecycle::LifecycleNode>& node) {
  const auto parameters = node->get_node_parameters_interface();
  for (;;) {
    try {
      auto listener = std::make_shared<target_controller::ParamListener>(node);
      require_known(*parameters);
      return listener;
    } catch (const rclcpp::exceptions::InvalidParameterTypeException& error) {
      if (!declare_as_double(*parameters, error.what())) throw;
    }
  }
}

}  // namespace fpbm_controllers
