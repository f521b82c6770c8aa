#pragma once

#include <cstdint>
#include <vector>

// Stands in for the header that ROS generates from shape_msgs/SolidPrimitive, whose dimensions are a bounded vector.
namespace shape_msgs::msg {

struct SolidPrimitive {
  static constexpr std::uint8_t BOX = 1, SPHERE = 2, CYLINDER = 3, CONE = 4, PRISM = 5;
  static constexpr std::uint8_t BOX_X = 0, BOX_Y = 1, BOX_Z = 2, SPHERE_RADIUS = 0, CYLINDER_HEIGHT = 0,
                                CYLINDER_RADIUS = 1;
  std::uint8_t type = 0;
  std::vector<double> dimensions;
};

}  // namespace shape_msgs::msg
