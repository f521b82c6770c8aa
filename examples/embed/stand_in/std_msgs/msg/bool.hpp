#pragma once

// Stands in for the header that ROS generates from std_msgs/Bool.
namespace std_msgs::msg {

struct Bool {
  bool data;
};

}  // namespace std_msgs::msg
