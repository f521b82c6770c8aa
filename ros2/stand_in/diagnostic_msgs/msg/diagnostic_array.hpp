#pragma once

#include <diagnostic_msgs/msg/diagnostic_status.hpp>
#include <geometry_msgs/msg/pose_stamped.hpp>
#include <vector>

// Stands in for the header that ROS generates from diagnostic_msgs/DiagnosticArray.
namespace diagnostic_msgs::msg {

struct DiagnosticArray {
  std_msgs::msg::Header header;
  std::vector<DiagnosticStatus> status;
};

}  // namespace diagnostic_msgs::msg
