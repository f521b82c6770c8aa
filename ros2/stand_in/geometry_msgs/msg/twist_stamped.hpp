#pragma once

#include <geometry_msgs/msg/pose_stamped.hpp>

// Stands in for the header that ROS generates from geometry_msgs/TwistStamped, and for the headers of its members.
namespace geometry_msgs::msg {

struct Vector3 {
  double x = 0.0, y = 0.0, z = 0.0;
};
struct Twist {
  Vector3 linear;
  Vector3 angular;
};
struct TwistStamped {
  std_msgs::msg::Header header;
  Twist twist;
};

}  // namespace geometry_msgs::msg
