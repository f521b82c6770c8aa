#include "fpbm_controllers/parameter_listener.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <numeric>
#include <optional>
#include <rclcpp/rclcpp.hpp>
#include <stdexcept>
#include <string>
#include <utility>
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

/// Number of letters to insert, remove or replace, without regard to case, so that one name becomes the other.
[[nodiscard]] std::size_t distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t corner = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const bool same =
          std::tolower(static_cast<unsigned char>(a[i])) == std::tolower(static_cast<unsigned char>(b[j]));
      const std::size_t replaced = corner + (same ? 0 : 1);
      corner = std::exchange(row[j + 1], std::min({replaced, row[j] + 1, row[j + 1] + 1}));
    }
  }
  return row.back();
}

[[nodiscard]] bool begins(const std::string& name, const std::string& with) {
  return name.compare(0, with.size(), with) == 0;
}

/// Throws if a given parameter resembles a parameter of the controller, or is in one of its groups. Warns of all other
/// unknown parameters: the controller manager forwards its own parameters, for example those under /**.
void check_names(const Parameters& parameters, const rclcpp::Logger& logger) {
  constexpr std::array<const char*, 5> kOfRos{"type", "fallback_controllers", "node_options_args", "qos_overrides.",
                                              "async_parameters."};
  constexpr std::array<const char*, 10> kGroups{"clearance.", "effort.", "limits.",     "scheme.", "stream.",
                                                "target.",    "task.",   "task_bound.", "tool.",   "torque_bounds."};
  const std::vector<std::string> declared = parameters.list_parameters({}, 0).names;
  std::string unknown;
  for (const auto& given : parameters.get_parameter_overrides()) {
    const std::string& name = given.first;
    const bool of_ros = std::any_of(kOfRos.begin(), kOfRos.end(), [&](const std::string& own) {
      return own.back() == '.' ? begins(name, own) : name == own;
    });
    if (of_ros || parameters.has_parameter(name)) continue;
    const auto nearest = std::min_element(
        declared.begin(), declared.end(),
        [&](const std::string& a, const std::string& b) { return distance(name, a) < distance(name, b); });
    if (nearest != declared.end() && distance(name, *nearest) <= std::clamp<std::size_t>(nearest->size() / 4, 1, 2)) {
      throw std::invalid_argument(name + ": is not a parameter of this controller: give " + *nearest +
                                  ", or remove the parameter");
    }
    if (std::any_of(kGroups.begin(), kGroups.end(), [&](const char* group) { return begins(name, group); })) {
      throw std::invalid_argument(name + ": is not a parameter of this controller: correct its name, or remove it");
    }
    unknown += (unknown.empty() ? "" : ", ") + name;
  }
  if (!unknown.empty()) RCLCPP_WARN(logger, "ignored, not parameters of this controller: %s", unknown.c_str());
}

}  // namespace

std::shared_ptr<target_controller::ParamListener> listen_to_parameters(
    const std::shared_ptr<rclcpp_lifecycle::LifecycleNode>& node) {
  const auto parameters = node->get_node_parameters_interface();
  for (;;) {
    try {
      auto listener = std::make_shared<target_controller::ParamListener>(node);
      check_names(*parameters, node->get_logger());
      return listener;
    } catch (const rclcpp::exceptions::InvalidParameterTypeException& error) {
      if (!declare_as_double(*parameters, error.what())) throw;
    }
  }
}

}  // namespace fpbm_controllers
