#pragma once

// Stands in for the header that ROS makes of std_msgs/Bool.
namespace std_msgs::msg {

struct Bool {
  bool data;
};

}  // namespace std_msgs::msg
