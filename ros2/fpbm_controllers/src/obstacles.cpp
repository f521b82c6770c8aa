#include "fpbm_controllers/obstacles.hpp"

#include <cmath>
#include <stdexcept>

#include "fpbm_controllers/target.hpp"

namespace fpbm_controllers {

namespace {

using moveit_msgs::msg::CollisionObject;
using shape_msgs::msg::SolidPrimitive;
using Obstacle = fpbm::Obstacle<>;

void require(bool good, const char* reason) {
  if (!good) throw std::invalid_argument(reason);
}

/// As in MoveIt, a quaternion of zeros is the identity.
[[nodiscard]] fpbm::Transform<> pose_of(geometry_msgs::msg::Pose message) {
  auto& o = message.orientation;
  if (o.x == 0.0 && o.y == 0.0 && o.z == 0.0 && o.w == 0.0) o.w = 1.0;
  const std::optional<fpbm::Transform<>> pose = transform_of(message);
  require(pose.has_value(), "all numbers must be finite, and the length of a quaternion 1");
  return *pose;
}

[[nodiscard]] bool is_identity(const geometry_msgs::msg::Pose& message) {
  const fpbm::Transform<> pose = pose_of(message);
  return pose.p.isZero(0.0) && pose.R.isIdentity(0.0);
}

/// A primitive as a shape. A cylinder becomes the capsule with the same radius and axis, which contains the cylinder.
[[nodiscard]] fpbm::WorldShape<> shape_of(const SolidPrimitive& solid, const fpbm::Transform<>& pose) {
  using Vector = fpbm::Vector<3>;
  const auto& size = solid.dimensions;
  const auto require_sizes = [&size](std::size_t count) {
    require(size.size() == count, "a box must have 3 dimensions, a sphere 1, and a cylinder 2");
    for (const double each : size) require(std::isfinite(each) && each >= 0.0, "dimensions must be 0 or positive");
  };
  switch (solid.type) {
    case SolidPrimitive::BOX:
      require_sizes(3);
      return fpbm::Cuboid<>{pose, Vector(size[0] / 2.0, size[1] / 2.0, size[2] / 2.0)};
    case SolidPrimitive::SPHERE:
      require_sizes(1);
      return fpbm::Capsule<>{pose.p, pose.p, size[SolidPrimitive::SPHERE_RADIUS]};
    case SolidPrimitive::CYLINDER: {
      require_sizes(2);
      const Vector end(0.0, 0.0, size[SolidPrimitive::CYLINDER_HEIGHT] / 2.0);
      return fpbm::placed(fpbm::Capsule<>{-end, end, size[SolidPrimitive::CYLINDER_RADIUS]}, pose);
    }
    default: break;
  }
  throw std::invalid_argument("a primitive must be a box, a sphere or a cylinder: enclose the shape");
}

/// The half-space below the plane n·x + d = 0, on the side opposite to n.
[[nodiscard]] fpbm::WorldShape<> shape_of(const shape_msgs::msg::Plane& plane, const fpbm::Transform<>& pose) {
  const auto& c = plane.coef;
  const fpbm::Vector<3> n(c[0], c[1], c[2]);
  const double length = n.norm();
  require(std::isfinite(length) && length > 0.0 && std::isfinite(c[3]), "a plane must have a finite normal, not zero");
  const fpbm::Vector<3> normal = fpbm::times(pose.R, fpbm::Vector<3>(n / length));
  return fpbm::HalfSpace<>{normal, normal.dot(pose.p) - c[3] / length};
}

[[nodiscard]] std::vector<Obstacle> shapes_of(const CollisionObject& object) {
  require(object.meshes.empty(), "a mesh is not supported: give boxes, spheres, cylinders or planes that contain it");
  const fpbm::Transform<> pose = pose_of(object.pose);
  std::vector<Obstacle> shapes;
  const auto add = [&](const auto& solids, const std::vector<geometry_msgs::msg::Pose>& poses) {
    require(poses.size() <= solids.size(), "has more poses than shapes");
    for (std::size_t i = 0; i < solids.size(); ++i) {
      const fpbm::Transform<> own = i < poses.size() ? pose_of(poses[i]) : fpbm::Transform<>{};
      shapes.emplace_back(object.id, shape_of(solids[i], pose * own));
      shapes.back().require_sound({"object"});
    }
  };
  add(object.primitives, object.primitive_poses);
  add(object.planes, object.plane_poses);
  require(!shapes.empty(), "has no shape");
  return shapes;
}

/// As in MoveIt, the pose of a single shape becomes the pose of an object without a pose, so that a later MOVE replaces
/// the pose of the shape.
void take_pose_of_shape(CollisionObject& object) {
  auto& poses = object.primitives.empty() ? object.plane_poses : object.primitive_poses;
  if (object.primitives.size() + object.planes.size() != 1 || poses.size() != 1 || !is_identity(object.pose)) return;
  std::swap(object.pose, poses[0]);
}

}  // namespace

Obstacles::Obstacles(ClearanceSettings settings) : settings_(std::move(settings)) {
  (void)apply(moveit_msgs::msg::PlanningScene{});
}

std::vector<std::string> Obstacles::apply(const moveit_msgs::msg::PlanningScene& scene) {
  if (!scene.is_diff) {
    objects_.clear();
    shapes_.clear();
  }
  std::vector<std::string> warnings;
  for (const Object& object : scene.world.collision_objects) {
    try {
      apply(object);
    } catch (const std::invalid_argument& error) {
      warnings.push_back("obstacle '" + object.id + "' dropped: " + error.what());
    }
  }
  std::vector<Obstacle> all;
  for (const auto& [id, shapes] : shapes_) all.insert(all.end(), shapes.begin(), shapes.end());
  clearance_ =
      std::make_shared<Clearance>(settings_.tree, settings_.capsules, all, settings_.margin, settings_.allowed);
  for (const fpbm::ShapePair& pair : clearance_->excluded_pairs()) {
    if (!pair.world) continue;
    const auto [link, obstacle] = clearance_->names(pair);
    warnings.push_back("obstacle '" + obstacle + "' is closer to link '" + link +
                       "' than clearance.margin in all of 256 postures: this pair is not checked");
  }
  return warnings;
}

void Obstacles::apply(const Object& object) {
  if (object.operation == Object::REMOVE) {
    if (object.id.empty()) {
      objects_.clear();
      shapes_.clear();
    } else {
      require(objects_.erase(object.id) > 0, "does not exist, and cannot be removed");
      shapes_.erase(object.id);
    }
    return;
  }
  if (object.header.frame_id != settings_.frame) {
    throw std::invalid_argument("its frame is '" + object.header.frame_id + "', not '" + settings_.frame + "'");
  }
  const auto known = objects_.find(object.id);
  if (object.operation == Object::MOVE) {
    require(known != objects_.end(), "does not exist, and cannot be moved");
    Object moved = known->second;
    moved.pose = object.pose;
    put(moved);
  } else if (object.operation == Object::APPEND && known != objects_.end()) {
    Object joined = known->second;
    const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
    joined.primitive_poses.resize(joined.primitives.size());
    joined.plane_poses.resize(joined.planes.size());
    append(joined.primitives, object.primitives);
    append(joined.primitive_poses, object.primitive_poses);
    append(joined.planes, object.planes);
    append(joined.plane_poses, object.plane_poses);
    append(joined.meshes, object.meshes);
    put(joined);
  } else {
    require(object.operation == Object::ADD || object.operation == Object::APPEND, "has an unknown operation");
    Object added = object;
    take_pose_of_shape(added);
    put(added);
  }
}

void Obstacles::put(Object object) {
  std::vector<Obstacle> shapes = shapes_of(object);
  std::size_t count = shapes.size();
  for (const auto& [id, others] : shapes_) count += id == object.id ? 0 : others.size();
  if (count > settings_.most_shapes) {
    throw std::invalid_argument(
        "all obstacles would have " + std::to_string(count) +
        " shapes: must be at most clearance.obstacles = " + std::to_string(settings_.most_shapes));
  }
  shapes_[object.id] = std::move(shapes);
  objects_[object.id] = std::move(object);
}

}  // namespace fpbm_controllers
