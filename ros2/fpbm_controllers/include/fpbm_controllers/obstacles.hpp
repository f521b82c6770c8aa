#pragma once

#include <cstddef>
#include <fpbm_controllers/motion_bounds.hpp>
#include <map>
#include <memory>
#include <moveit_msgs/msg/planning_scene.hpp>
#include <string>
#include <utility>
#include <vector>

namespace fpbm_controllers {

/// The arguments of a Clearance, except the obstacles.
struct ClearanceSettings {
  using Names = std::pair<std::string, std::string>;

  fpbm::Tree<> tree;
  std::vector<fpbm::LinkCapsule<>> capsules;
  std::vector<Names> allowed;
  double margin;            ///< [m]
  std::size_t most_shapes;  ///< Largest number of shapes of all obstacles.
  std::string frame;        ///< Frame of the obstacles.
};

/// The collision objects of MoveIt planning scenes as obstacles. Not for the loop.
class Obstacles {
 public:
  /// Throws std::invalid_argument if the clearance rejects a capsule.
  explicit Obstacles(ClearanceSettings settings);

  /// Applies a planning scene, as MoveIt does: a difference, or a whole scene. Returns a warning for each object that
  /// is dropped, and for each pair that is not checked.
  [[nodiscard]] std::vector<std::string> apply(const moveit_msgs::msg::PlanningScene& scene);

  /// The clearance of the robot among the present obstacles.
  [[nodiscard]] const std::shared_ptr<Clearance>& clearance() const noexcept { return clearance_; }

 private:
  using Object = moveit_msgs::msg::CollisionObject;

  /// Throws std::invalid_argument with the reason if the object is dropped.
  void apply(const Object& object);
  void put(Object object);

  ClearanceSettings settings_;
  std::map<std::string, Object> objects_;
  std::map<std::string, std::vector<fpbm::Obstacle<>>> shapes_;  ///< The shapes of each object.
  std::shared_ptr<Clearance> clearance_;
};

}  // namespace fpbm_controllers
