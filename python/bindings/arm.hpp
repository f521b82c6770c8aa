#pragma once

#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "fpbm/any/any_arm.hpp"
#include "fpbm/core/detail/validation.hpp"
#include "fpbm/model/chain.hpp"
#include "model.hpp"

namespace fpbm::bindings {

/// Tip, J and Jd in any task space, from an arm or from another library.
struct AnyKinematics {
  std::variant<Kinematics<Position<2>, kDynamic>, Kinematics<PlanarPose, kDynamic>, Kinematics<Position<3>, kDynamic>,
               Kinematics<Pose, kDynamic>>
      value;
  bool has_rate = true;  ///< Whether Jd is known.
};

/// Throws std::invalid_argument if a task in Space has more rows than the arm has joints.
template <typename Space>
void require_enough_joints(Eigen::Index dof) {
  if (dof >= Space::kRows) return;
  const char* remedy = "give a stack with fewer rows, for example fp.PositionTask(rows=('x', 'z'))";
  if constexpr (std::is_same_v<Space, PlanarPose>) remedy = "give task='position'";
  if constexpr (std::is_same_v<Space, Pose>) {
    remedy = "give task='position' or stack=fp.Stack(fp.PositionTask(), fp.AxisTask())";
  }
  validation::reject("task", ": has " + std::to_string(Space::kRows) + " rows, and the arm has " + std::to_string(dof) +
                                 " joints: must not have more rows than joints: " + remedy);
}

/// A planar arm or an arm in space.
struct Arm : Model {
  using Any = std::variant<AnyArm<Position<2>>, AnyArm<Position<3>>>;

  /// An arm in the plane. chain: the same joints and tip in space.
  Arm(const JointVector& lengths, const Chain<>& chain, const Vector<3>& gravity_);
  Arm(const Chain<>& chain, const Vector<3>& gravity_);

  Any any;
  std::variant<JointVector, Chain<>> source;  ///< Link lengths [m] of a planar arm, or the chain of an arm in space.

  /// Calls visitor(arm, Space) with the AnyArm and the task space of that name.
  /// Throws std::invalid_argument if the task space does not exist.
  template <typename Visitor>
  auto visit(const std::string& task, Visitor&& visitor) const {
    return std::visit(
        [&](const auto& arm) {
          if (task == "position") return visitor(arm, positions(arm));
          if (task == "pose") return visitor(arm, poses(arm));
          validation::reject("task", " = '" + task + "': must be 'position' or 'pose'");
        },
        any);
  }

 private:
  template <typename Source>
  Arm(const Any& any_, const Source& source_, const Chain<>& chain, const Vector<3>& gravity_, bool in_plane)
      : Model(tree_of(chain), gravity_, in_plane), any(any_), source(source_) {}

  template <typename Positions>
  static Positions positions(const AnyArm<Positions>&) {
    return {};
  }
  template <typename Positions>
  static typename PoseOver<Positions>::type poses(const AnyArm<Positions>&) {
    return {};
  }
};

/// Calls visitor(arm, Space) with the task space of that name, and with a pointer to the AnyArm, null for a robot.
/// Throws std::invalid_argument if the task does not exist or has more rows than the arm has joints, or if a robot has
/// no stack.
template <typename Visitor>
auto visit_space(const Model& model, const std::string& task, bool has_stack, Visitor&& visitor) {
  if (const auto* arm = dynamic_cast<const Arm*>(&model)) {
    return arm->visit(task, [&](const auto& any, auto space) {
      if (!has_stack) require_enough_joints<decltype(space)>(arm->dof());
      return visitor(&any, space);
    });
  }
  if (!has_stack) validation::reject("stack", ": must be given for a Robot, which has no tip of its own");
  const AnyArm<Position<3>>* none = nullptr;
  return task == "pose" ? visitor(none, Pose{}) : visitor(none, Position<3>{});
}

}  // namespace fpbm::bindings
