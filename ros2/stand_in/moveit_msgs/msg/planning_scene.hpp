#pragma once

#include <moveit_msgs/msg/collision_object.hpp>
#include <vector>

// Stands in for the headers that ROS generates from moveit_msgs/PlanningScene and moveit_msgs/PlanningSceneWorld: only
// the members that the controller uses.
namespace moveit_msgs::msg {

struct PlanningSceneWorld {
  std::vector<CollisionObject> collision_objects;
};
struct PlanningScene {
  PlanningSceneWorld world;
  bool is_diff = false;
};

}  // namespace moveit_msgs::msg
