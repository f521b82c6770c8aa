#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "arm.hpp"

namespace fpbm::bindings {

/// Fixed-size code for this many joints; beyond, the heap-free code of run-time size.
template <template <int, typename> class Arm>
inline constexpr std::pair<int, int> kFixedDof{FPBM_SERIAL_DOF};
template <>
inline constexpr std::pair<int, int> kFixedDof<PlanarArm>{FPBM_PLANAR_DOF};

/// The choice of N.
template <template <int, typename> class Arm, int N = kFixedDof<Arm>.first>
ModelsOf<Arm<kDynamic, double>> choose_models(const typename ArmTraits<Arm<kDynamic, double>>::Source& source,
                                              std::size_t dof) {
  if constexpr (N > kFixedDof<Arm>.second) {
    return make_models<Arm<kDynamic, double>>(source);
  } else {
    if (dof == N) return make_models<Arm<N, double>>(source);
    return choose_models<Arm, N + 1>(source, dof);
  }
}

/// Throws std::invalid_argument where a task has more rows than the arm has joints.
inline void require_redundant(int rows, int dof) {
  if (dof < rows) {
    throw std::invalid_argument("task: it has " + std::to_string(rows) + " rows, and the arm " + std::to_string(dof) +
                                " joints: must not be more rows than joints");
  }
}

/// An arm as Python sees it.
class PyArm {
 public:
  virtual ~PyArm() = default;  // So that an arm is known in Python as what it was made.

  [[nodiscard]] int dof() const noexcept { return static_cast<int>(limits_.lower.size()); }
  [[nodiscard]] const JointLimits<kDynamic>& limits() const noexcept { return limits_; }
  [[nodiscard]] const std::vector<std::string>& joint_names() const noexcept { return joint_names_; }

  /// Calls visitor(const TaskModel<Space>&) for the task space of that name.
  /// Throws std::invalid_argument where there is none.
  template <typename Visitor>
  auto visit(const std::string& task, Visitor&& visitor) const {
    return std::visit(
        [&](const auto& models) {
          if (task == "position") return visitor(*models.position);
          if (task == "pose") return visitor(*models.pose);
          throw std::invalid_argument("task = '" + task + "': must be 'position' or 'pose'");
        },
        models_);
  }

  /// The model of tip positions in Positions, for those that keep it. Throws std::bad_variant_access for another space.
  template <typename Positions>
  [[nodiscard]] std::shared_ptr<const TaskModel<Positions>> positions() const {
    return std::get<ArmModels<Positions>>(models_).position;
  }

 protected:
  template <typename Positions>
  PyArm(ArmModels<Positions> models, JointLimits<kDynamic> limits, std::vector<std::string> joint_names)
      : models_(std::move(models)), limits_(std::move(limits)), joint_names_(std::move(joint_names)) {}

 private:
  std::variant<ArmModels<Position<2>>, ArmModels<Position<3>>> models_;
  JointLimits<kDynamic> limits_;
  std::vector<std::string> joint_names_;
};

class PyPlanarArm : public PyArm {
 public:
  explicit PyPlanarArm(const Joints& lengths)
      : PyArm(choose_models<PlanarArm>(lengths, static_cast<std::size_t>(lengths.size())),
              PlanarArm<kDynamic>(lengths).limits(), names(lengths.size())),
        lengths_(lengths) {}

  [[nodiscard]] const Joints& lengths() const noexcept { return lengths_; }

 private:
  static std::vector<std::string> names(Eigen::Index dof) {
    std::vector<std::string> result;
    for (Eigen::Index i = 1; i <= dof; ++i) result.push_back("joint_" + std::to_string(i));
    return result;
  }

  Joints lengths_;
};

class PySerialArm : public PyArm {
 public:
  explicit PySerialArm(const Chain<>& chain) : PySerialArm(chain, is_coupled(chain)) {}

 private:
  PySerialArm(const Chain<>& chain, bool coupled)
      : PyArm(coupled ? make_models<CoupledArm<kDynamic>>(chain) : choose_models<SerialArm>(chain, chain.joints.size()),
              coupled ? CoupledArm<kDynamic>(chain).limits() : SerialArm<kDynamic>(chain).limits(), names(chain)) {}

  /// Of the joints that have a drive of their own.
  static std::vector<std::string> names(const Chain<>& chain) {
    std::vector<std::string> result;
    for (const Joint<>& joint : chain.joints) {
      if (joint.mimic.joint < 0) result.push_back(joint.name);
    }
    return result;
  }

  static bool is_coupled(const Chain<>& chain) {
    for (const Joint<>& joint : chain.joints) {
      if (joint.mimic.joint >= 0) return true;
    }
    return false;
  }
};

}  // namespace fpbm::bindings
