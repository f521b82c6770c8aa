#pragma once

#include <vector>

// Stands in for the header that ROS generates from std_msgs/Float64MultiArray.
namespace std_msgs::msg {

struct Float64MultiArray {
  std::vector<double> data;
};

}  // namespace std_msgs::msg
