#pragma once

#include <string>
#include <vector>

// Stands in for the header that ROS generates from diagnostic_msgs/DiagnosticStatus.
namespace diagnostic_msgs::msg {

struct KeyValue {
  std::string key;
  std::string value;
};
struct DiagnosticStatus {
  static constexpr unsigned char OK = 0;
  static constexpr unsigned char WARN = 1;
  static constexpr unsigned char ERROR = 2;
  unsigned char level = OK;
  std::string name;
  std::string message;
  std::string hardware_id;
  std::vector<KeyValue> values;
};

}  // namespace diagnostic_msgs::msg
