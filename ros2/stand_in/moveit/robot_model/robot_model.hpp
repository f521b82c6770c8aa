#pragma once

#include <Eigen/Geometry>
#include <map>
#include <string>
#include <vector>

// Stands in for MoveIt's headers of the robot model: only the members that the plugin uses. The test fills the members
// directly.
namespace moveit::core {

struct VariableBounds {
  double min_position_ = 0.0;
  double max_position_ = 0.0;
  bool position_bounded_ = false;
};

class JointModel {
 public:
  enum JointType { UNKNOWN, REVOLUTE, PRISMATIC, PLANAR, FLOATING, FIXED };
  using Bounds = std::vector<VariableBounds>;

  virtual ~JointModel() = default;
  [[nodiscard]] const std::string& getName() const { return name; }
  [[nodiscard]] JointType getType() const { return type; }
  [[nodiscard]] const Bounds& getVariableBounds() const { return bounds; }
  [[nodiscard]] const JointModel* getMimic() const { return mimic; }

  std::string name;
  JointType type = FIXED;
  Bounds bounds;
  const JointModel* mimic = nullptr;
};
template <JointModel::JointType kType>
class AxisJointModel : public JointModel {
 public:
  [[nodiscard]] const Eigen::Vector3d& getAxis() const { return axis; }

  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
};
using RevoluteJointModel = AxisJointModel<JointModel::REVOLUTE>;
using PrismaticJointModel = AxisJointModel<JointModel::PRISMATIC>;

class LinkModel {
 public:
  [[nodiscard]] const std::string& getName() const { return name; }
  [[nodiscard]] const JointModel* getParentJointModel() const { return joint; }
  [[nodiscard]] const LinkModel* getParentLinkModel() const { return parent; }
  [[nodiscard]] const Eigen::Isometry3d& getJointOriginTransform() const { return origin; }

  std::string name;
  const JointModel* joint = nullptr;
  const LinkModel* parent = nullptr;
  Eigen::Isometry3d origin = Eigen::Isometry3d::Identity();
};

class JointModelGroup {
 public:
  [[nodiscard]] const std::vector<std::string>& getVariableNames() const { return names; }

  std::vector<std::string> names;
};

class RobotModel {
 public:
  [[nodiscard]] const std::string& getModelFrame() const { return frame; }
  [[nodiscard]] const LinkModel* getLinkModel(const std::string& name) const { return find(links, name); }
  [[nodiscard]] const JointModelGroup* getJointModelGroup(const std::string& name) const { return find(groups, name); }

  std::string frame = "world";
  std::map<std::string, LinkModel> links;
  std::map<std::string, JointModelGroup> groups;

 private:
  template <typename Map>
  [[nodiscard]] static const typename Map::mapped_type* find(const Map& map, const std::string& name) {
    const auto found = map.find(name);
    return found == map.end() ? nullptr : &found->second;
  }
};

}  // namespace moveit::core
