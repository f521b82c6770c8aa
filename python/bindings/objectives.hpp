#pragma once

#include <memory>
#include <utility>
#include <variant>

#include "whole_arm.hpp"

/// Schemes with all their objectives, behind few types, in code of run-time size: each objective times each scheme,
/// task and number of joints would be too much code.
namespace fpbm::bindings {

/// An arm as the library's templates see one.
template <typename Space>
class AnyArm {
 public:
  using Scalar = double;
  static constexpr int kDof = kDynamic;

  AnyArm(std::shared_ptr<const TaskModel<Space>> model, int dof) : model_(std::move(model)), dof_(dof) {}

  [[nodiscard]] int dof() const noexcept { return dof_; }
  void kinematics(const Joints& q, const Joints& qd, Kinematics<Space, kDynamic>& out) const {
    out = model_->kinematics(q, qd);
  }
  void kinematics(const Joints& q, Kinematics<Space, kDynamic>& out) const {
    out = model_->kinematics(q, Joints::Zero(q.size()));
  }

 private:
  std::shared_ptr<const TaskModel<Space>> model_;
  int dof_;
};

/// Any scheme of one level, for tasks in Space.
template <Level kLevel_, typename Space>
class AnyScheme {
 public:
  static constexpr Level kLevel = kLevel_;

  template <typename Scheme>
  explicit AnyScheme(const Scheme& scheme) : held_(std::make_shared<Held<Scheme>>(scheme)) {}

  void require_dof(Eigen::Index dof) const { held_->require_dof(dof); }
  [[nodiscard]] Status resolve(const Kinematics<Space, kDynamic>& kinematics, const Reference<Space>& reference,
                               const State<kDynamic>& state, Joints& u) const noexcept {
    return held_->resolve(kinematics, reference, state, u);
  }

 private:
  struct Holder {
    Holder() = default;
    Holder(const Holder&) = delete;
    Holder& operator=(const Holder&) = delete;
    virtual ~Holder() = default;
    virtual void require_dof(Eigen::Index dof) const = 0;
    [[nodiscard]] virtual Status resolve(const Kinematics<Space, kDynamic>& kinematics,
                                         const Reference<Space>& reference, const State<kDynamic>& state,
                                         Joints& u) const noexcept = 0;
  };

  template <typename Scheme>
  struct Held final : Holder {
    explicit Held(const Scheme& scheme_) : scheme(scheme_) {}
    void require_dof(Eigen::Index dof) const override { scheme.require_dof(dof); }
    [[nodiscard]] Status resolve(const Kinematics<Space, kDynamic>& kinematics, const Reference<Space>& reference,
                                 const State<kDynamic>& state, Joints& u) const noexcept override {
      return scheme.resolve(kinematics, reference, state, u);
    }
    Scheme scheme;
  };

  std::shared_ptr<const Holder> held_;
};

/// A scheme of either level.
template <typename Space>
using WholeScheme = std::variant<AnyScheme<Level::kVelocity, Space>, AnyScheme<Level::kAcceleration, Space>>;

/// The scheme as Python has it, objectives and all. Throws std::invalid_argument where a parameter does not fit the
/// arm.
template <typename Space>
[[nodiscard]] WholeScheme<Space> whole_scheme(const PyScheme& scheme, const WholeArm<Space>& arm);

/// The scheme for a number of joints, without an arm. Throws std::invalid_argument where it needs one.
template <typename Space>
[[nodiscard]] WholeScheme<Space> scheme_alone(const PyScheme& scheme, Eigen::Index dof);

}  // namespace fpbm::bindings
