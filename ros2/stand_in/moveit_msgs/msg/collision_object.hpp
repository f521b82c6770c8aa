#pragma once

#include <cstdint>
#include <geometry_msgs/msg/pose_stamped.hpp>
#include <shape_msgs/msg/plane.hpp>
#include <shape_msgs/msg/solid_primitive.hpp>
#include <string>
#include <vector>

// Stands in for the headers that ROS generates from moveit_msgs/CollisionObject and shape_msgs/Mesh.
namespace shape_msgs::msg {

struct Mesh {};

}  // namespace shape_msgs::msg

namespace moveit_msgs::msg {

struct CollisionObject {
  static constexpr std::uint8_t ADD = 0, REMOVE = 1, APPEND = 2, MOVE = 3;
  std_msgs::msg::Header header;
  geometry_msgs::msg::Pose pose;
  std::string id;
  std::vector<shape_msgs::msg::SolidPrimitive> primitives;
  std::vector<geometry_msgs::msg::Pose> primitive_poses;
  std::vector<shape_msgs::msg::Mesh> meshes;
  std::vector<geometry_msgs::msg::Pose> mesh_poses;
  std::vector<shape_msgs::msg::Plane> planes;
  std::vector<geometry_msgs::msg::Pose> plane_poses;
  std::uint8_t operation = ADD;
};

}  // namespace moveit_msgs::msg
