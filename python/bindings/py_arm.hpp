#pragma once

#include <memory>
#include <string>

#include "arm.hpp"

namespace fpbm::bindings {

/// A planar arm as Python sees it.
class PyPlanarArm {
 public:
  explicit PyPlanarArm(const ArmModel::Joints& lengths) : lengths_(lengths), model_(choose_planar_model<>(lengths)) {}

  [[nodiscard]] int dof() const noexcept { return static_cast<int>(lengths_.size()); }
  [[nodiscard]] const ArmModel::Joints& lengths() const noexcept { return lengths_; }
  [[nodiscard]] const ArmModel& model() const noexcept { return *model_; }

  /// Throws std::invalid_argument unless task names one that a planar arm has.
  static void require_task(const std::string& task) {
    if (task != "position") throw std::invalid_argument("task = '" + task + "': a planar arm has task 'position'");
  }

 private:
  ArmModel::Joints lengths_;
  std::shared_ptr<const ArmModel> model_;
};

}  // namespace fpbm::bindings
