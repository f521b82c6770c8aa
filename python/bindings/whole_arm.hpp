#pragma once

#include <memory>

#include "arm.hpp"

namespace fpbm::bindings {

/// All that a scheme with every objective can ask for of an arm with a task in Space.
template <typename Space>
struct WholeArm {
  std::shared_ptr<const TaskModel<Space>> model;
  std::shared_ptr<const TaskModel<Pose>> poses;  ///< Of the same arm; none in the plane.
  JointLimits<kDynamic> limits;

  [[nodiscard]] int dof() const noexcept { return static_cast<int>(limits.lower.size()); }
};

/// A pointer to what others own, and keep for as long as it is used.
template <typename Model>
[[nodiscard]] std::shared_ptr<const Model> borrowed(const Model& model) {
  return {std::shared_ptr<const void>(), &model};
}

/// One evaluation of a scheme with all its objectives, in code of run-time size. Throws std::invalid_argument where a
/// parameter does not fit the arm.
template <typename Space>
[[nodiscard]] Status resolve(const PyScheme& scheme, const WholeArm<Space>& arm, const Reference<Space>& reference,
                             const State<kDynamic>& state, Joints& out);

/// A whole motion under a scheme with all its objectives, in code of run-time size.
template <typename Space>
[[nodiscard]] RolloutResult<kDynamic> simulate(const PyScheme& scheme, const WholeArm<Space>& arm,
                                               const AnyPath<Space>& path, const State<kDynamic>& start,
                                               const TimeGrid<double>& grid, const Wanted<Space>& wanted);

/// Throws std::invalid_argument where a parameter of the scheme does not fit the arm.
template <typename Space>
void require(const PyScheme& scheme, const WholeArm<Space>& arm);

}  // namespace fpbm::bindings
