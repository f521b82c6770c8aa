#pragma once

#include <fpbm/core/types.hpp>
#include <initializer_list>
#include <moveit_msgs/msg/planning_scene.hpp>
#include <string>

namespace stand_in {

using moveit_msgs::msg::CollisionObject;
using moveit_msgs::msg::PlanningScene;
using shape_msgs::msg::SolidPrimitive;

[[nodiscard]] inline geometry_msgs::msg::Pose at(const fpbm::Vector<3>& p) {
  geometry_msgs::msg::Pose pose;
  pose.position = {p(0), p(1), p(2)};
  return pose;
}

/// An object with one primitive, as MoveIt's Python interface makes it: the pose is the pose of the primitive.
[[nodiscard]] inline CollisionObject object(const std::string& id, std::uint8_t type, std::vector<double> dimensions,
                                            const fpbm::Vector<3>& p) {
  CollisionObject object;
  object.header.frame_id = "base";
  object.id = id;
  object.primitives.push_back({type, std::move(dimensions)});
  object.primitive_poses.push_back(at(p));
  return object;
}
[[nodiscard]] inline CollisionObject box(const std::string& id, const fpbm::Vector<3>& size, const fpbm::Vector<3>& p) {
  return object(id, SolidPrimitive::BOX, {size(0), size(1), size(2)}, p);
}
[[nodiscard]] inline CollisionObject sphere(const std::string& id, double radius, const fpbm::Vector<3>& p) {
  return object(id, SolidPrimitive::SPHERE, {radius}, p);
}
[[nodiscard]] inline CollisionObject cylinder(const std::string& id, double height, double radius,
                                              const fpbm::Vector<3>& p) {
  return object(id, SolidPrimitive::CYLINDER, {height, radius}, p);
}
/// The plane z = height, solid below.
[[nodiscard]] inline CollisionObject floor(const std::string& id, double height) {
  CollisionObject object;
  object.header.frame_id = "base";
  object.id = id;
  object.planes.push_back({{0.0, 0.0, 1.0, -height}});
  return object;
}
[[nodiscard]] inline CollisionObject operation(std::uint8_t operation, const std::string& id,
                                               const fpbm::Vector<3>& p = fpbm::Vector<3>::Zero()) {
  CollisionObject object;
  object.header.frame_id = "base";
  object.id = id;
  object.pose = at(p);
  object.operation = operation;
  return object;
}

[[nodiscard]] inline PlanningScene scene(std::initializer_list<CollisionObject> objects, bool is_diff = true) {
  PlanningScene scene;
  scene.world.collision_objects = objects;
  scene.is_diff = is_diff;
  return scene;
}

}  // namespace stand_in
