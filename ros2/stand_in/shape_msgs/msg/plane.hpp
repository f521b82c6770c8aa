#pragma once

#include <array>

// Stands in for the header that ROS generates from shape_msgs/Plane.
namespace shape_msgs::msg {

struct Plane {
  std::array<double, 4> coef{};
};

}  // namespace shape_msgs::msg
