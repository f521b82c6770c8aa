#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "fpbm/model/robot.hpp"

namespace fpbm {
template <int, typename, int>
class Dynamics;
}  // namespace fpbm

namespace fpbm::bindings {

inline constexpr int kDynamic = Eigen::Dynamic;
using JointVector = Vector<kDynamic>;
using AnyDynamics = Dynamics<kDynamic, double, kDynamic>;

/// The joints and frames of a robot or an arm, for all code that reads a robot's state, such as tasks and clearances.
struct Model {
  Model(const Tree<>& tree_, const Vector<3>& gravity_, bool planar_ = false)
      : tree(tree_), robot(tree_), gravity(gravity_), planar(planar_) {
    for (const auto& [joint, parent] : tree.joints) {
      if (joint.mimic.joint < 0) joint_names.push_back(joint.name);
    }
  }
  virtual ~Model() = default;  // Polymorphic, so that Python gets an object of the derived class.

  [[nodiscard]] int dof() const noexcept { return robot.dof(); }
  [[nodiscard]] const JointLimits<kDynamic>& limits() const noexcept { return robot.limits(); }
  /// Link and offset of a frame: the frame of that name, the link that the joint of that name moves, or 'base'. Throws
  /// std::invalid_argument if no frame has that name.
  [[nodiscard]] std::pair<int, Transform<>> frame(const std::string& name) const;

  /// Dynamics of the robot, made in the first call. Throws std::invalid_argument if a drive moves no mass, or an
  /// inertia is not physical.
  [[nodiscard]] const AnyDynamics& dynamics() const;
  /// dynamics(), or null if dynamics() throws.
  [[nodiscard]] std::shared_ptr<const AnyDynamics> dynamics_if_known() const noexcept;

  Tree<> tree;
  Robot<kDynamic> robot;
  Vector<3> gravity;                      ///< Acceleration of gravity in the base frame [m/s²].
  bool planar;                            ///< Whether the model is a planar arm.
  std::vector<std::string> joint_names;   ///< Names of the drives.
  mutable std::shared_ptr<void> inverse;  ///< The solver of the last call of inverse().

 private:
  mutable std::shared_ptr<const AnyDynamics> dynamics_;
};

/// Torques of the drives for a motion, by inverse dynamics.
[[nodiscard]] JointVector torque_of(const AnyDynamics& dynamics, const JointVector& q, const JointVector& qd,
                                    const JointVector& qdd);

}  // namespace fpbm::bindings
