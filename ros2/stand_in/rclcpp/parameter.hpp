#pragma once

#include <cstdint>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

// Stands in for rclcpp's headers of parameters: values, their types, and the declarations of a node.
namespace rcl_interfaces::msg {

struct ParameterDescriptor {
  bool read_only = false;
};
struct ListParametersResult {
  std::vector<std::string> names;
};

}  // namespace rcl_interfaces::msg

namespace rclcpp {

enum ParameterType : std::uint8_t {
  PARAMETER_NOT_SET,
  PARAMETER_BOOL,
  PARAMETER_INTEGER,
  PARAMETER_DOUBLE,
  PARAMETER_STRING,
  PARAMETER_INTEGER_ARRAY,
  PARAMETER_DOUBLE_ARRAY,
  PARAMETER_STRING_ARRAY,
};

class ParameterValue {
 public:
  ParameterValue() = default;
  template <typename T>
  explicit ParameterValue(const T& value) : value_(value) {}
  explicit ParameterValue(int value) : value_(std::int64_t{value}) {}
  [[nodiscard]] ParameterType get_type() const { return static_cast<ParameterType>(value_.index()); }
  template <typename T>
  [[nodiscard]] const T& get() const {
    return std::get<T>(value_);
  }

 private:
  std::variant<std::monostate, bool, std::int64_t, double, std::string, std::vector<std::int64_t>, std::vector<double>,
               std::vector<std::string>>
      value_;
};

class Parameter {
 public:
  explicit Parameter(ParameterValue value) : value_(std::move(value)) {}
  [[nodiscard]] std::int64_t as_int() const { return value_.get<std::int64_t>(); }
  [[nodiscard]] bool as_bool() const { return value_.get<bool>(); }
  [[nodiscard]] const ParameterValue& get_parameter_value() const { return value_; }

 private:
  ParameterValue value_;
};

namespace exceptions {

class InvalidParameterTypeException : public std::runtime_error {
 public:
  InvalidParameterTypeException(const std::string& name, const std::string& message)
      : std::runtime_error("parameter '" + name + "' has invalid type: " + message) {}
};
class InvalidParameterValueException : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace exceptions

namespace node_interfaces {

class NodeParametersInterface {
 public:
  [[nodiscard]] const std::map<std::string, ParameterValue>& get_parameter_overrides() const { return overrides; }
  [[nodiscard]] bool has_parameter(const std::string& name) const { return declared.count(name) > 0; }
  [[nodiscard]] Parameter get_parameter(const std::string& name) const { return Parameter(declared.at(name)); }
  /// Only for all parameters of any depth.
  [[nodiscard]] rcl_interfaces::msg::ListParametersResult list_parameters(const std::vector<std::string>&,
                                                                          std::uint64_t) const {
    rcl_interfaces::msg::ListParametersResult result;
    for (const auto& [name, value] : declared) result.names.push_back(name);
    return result;
  }
  /// A parameter has one type, the type of its default.
  const ParameterValue& declare_parameter(const std::string& name, const ParameterValue& value,
                                          const rcl_interfaces::msg::ParameterDescriptor& = {},
                                          bool ignore_override = false) {
    const auto given = overrides.find(name);
    const bool overridden = !ignore_override && given != overrides.end();
    if (overridden && given->second.get_type() != value.get_type()) {
      throw exceptions::InvalidParameterTypeException(name, "not the type of its default");
    }
    return declared[name] = overridden ? given->second : value;
  }

  std::map<std::string, ParameterValue> overrides;
  std::map<std::string, ParameterValue> declared;
};

}  // namespace node_interfaces

}  // namespace rclcpp
