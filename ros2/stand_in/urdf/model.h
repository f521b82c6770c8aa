#pragma once

#include <map>
#include <memory>
#include <string>

// Stands in for the headers of urdf and urdfdom: the model of a robot_description. Nothing is parsed: the test
// registers a model under a name, and this name is the text of robot_description.
namespace urdf {

struct Vector3 {
  double x = 0.0, y = 0.0, z = 0.0;
};
struct Rotation {
  double x = 0.0, y = 0.0, z = 0.0, w = 1.0;
};
struct Pose {
  Vector3 position;
  Rotation rotation;
};
struct JointLimits {
  double lower = 0.0, upper = 0.0, effort = 0.0, velocity = 0.0;
};
struct JointMimic {
  double offset = 0.0;
  double multiplier = 1.0;
  std::string joint_name;
};
struct JointDynamics {
  double damping = 0.0, friction = 0.0;
};
struct Joint {
  enum { UNKNOWN, REVOLUTE, CONTINUOUS, PRISMATIC, FLOATING, PLANAR, FIXED } type = UNKNOWN;
  std::string name;
  Vector3 axis;
  std::string child_link_name;
  std::string parent_link_name;
  Pose parent_to_joint_origin_transform;
  std::shared_ptr<JointDynamics> dynamics;
  std::shared_ptr<JointLimits> limits;
  std::shared_ptr<JointMimic> mimic;
};
struct Inertial {
  Pose origin;
  double mass = 0.0;
  double ixx = 0.0, ixy = 0.0, ixz = 0.0, iyy = 0.0, iyz = 0.0, izz = 0.0;
};
struct Link {
  std::string name;
  std::shared_ptr<Joint> parent_joint;
  std::shared_ptr<Inertial> inertial = nullptr;
};

class Model;

}  // namespace urdf

namespace stand_in {

inline std::map<std::string, urdf::Model>& descriptions();

}  // namespace stand_in

namespace urdf {

class Model {
 public:
  bool initString(const std::string& text) {
    const auto found = stand_in::descriptions().find(text);
    if (found != stand_in::descriptions().end()) *this = found->second;
    return found != stand_in::descriptions().end();
  }
  [[nodiscard]] std::shared_ptr<const Link> getLink(const std::string& name) const {
    const auto found = links_.find(name);
    return found == links_.end() ? nullptr : found->second;
  }

  std::map<std::string, std::shared_ptr<Link>> links_;
};

}  // namespace urdf

namespace stand_in {

inline std::map<std::string, urdf::Model>& descriptions() {
  static std::map<std::string, urdf::Model> all;
  return all;
}

}  // namespace stand_in
