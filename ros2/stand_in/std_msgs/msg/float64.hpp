#pragma once

// Stands in for the header that ROS generates from std_msgs/Float64.
namespace std_msgs::msg {

struct Float64 {
  double data = 0.0;
};

}  // namespace std_msgs::msg
