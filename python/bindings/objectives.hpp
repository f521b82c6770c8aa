#pragma once

#include <memory>
#include <stdexcept>
#include <type_traits>
#include <utility>
#include <variant>

#include "fpbm/model/gaze.hpp"
#include "fpbm/resolver/manipulability_ascent.hpp"
#include "fpbm/resolver/second_task.hpp"
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

/// The scheme with a second task in its null space.
template <Level kLevel, typename Space>
[[nodiscard]] AnyScheme<kLevel, Space> with_second_task(const AnyScheme<kLevel, Space>& scheme,
                                                        const PySecondTask& task, const WholeArm<Space>& arm) {
  using Result = AnyScheme<kLevel, Space>;
  constexpr bool kInPlane = std::is_same_v<Space, Position<2>> || std::is_same_v<Space, PlanarPose>;
  const auto with = [&](const auto& second, const auto& point) {
    return Result(SecondTask(scheme, second, std::decay_t<decltype(point)>(point), task.k1, task.k2));
  };
  if constexpr (kInPlane) {
    if (const auto* given = std::get_if<PySecondTask::Point<Position<2>>>(&task.what)) {
      return with(AnyArm<Position<2>>(given->arm, given->dof), Reference<Position<2>>::hold(given->x));
    }
    throw std::invalid_argument("second_task: of an arm in the plane, it must be the tip of another one in the plane");
  } else {
    if (const auto* given = std::get_if<PySecondTask::Point<Position<3>>>(&task.what)) {
      return with(AnyArm<Position<3>>(given->arm, given->dof), Reference<Position<3>>::hold(given->x));
    }
    if (const auto* given = std::get_if<PySecondTask::Direction>(&task.what)) {
      return with(Gaze(AnyArm<Pose>(arm.poses, arm.dof()), given->d), Reference<Position<2>>::hold(Vector<2>::Zero()));
    }
    throw std::invalid_argument("second_task: of an arm in space, it must be the tip of another one in space");
  }
}

/// Calls visitor(scheme) with the scheme as Python has it, objectives and all.
/// Throws std::invalid_argument where a parameter does not fit the arm.
template <typename Space, typename Visitor>
auto visit_whole(const PyScheme& scheme, const WholeArm<Space>& arm, Visitor&& visitor) {
  using Velocity = AnyScheme<Level::kVelocity, Space>;
  using Acceleration = AnyScheme<Level::kAcceleration, Space>;
  const auto core = scheme.visit_core<kDynamic>(arm.limits, [](const auto& chosen) {
    using Any = AnyScheme<std::decay_t<decltype(chosen)>::kLevel, Space>;
    return std::variant<Velocity, Acceleration>(Any(chosen));
  });
  return std::visit(
      [&](auto whole) {
        using Any = decltype(whole);
        if (scheme.manipulability_gain != 0.0) {
          whole = Any(ManipulabilityAscent(whole, AnyArm<Space>(arm.model, arm.dof()), scheme.manipulability_gain));
        }
        if (scheme.second_task) whole = with_second_task(whole, *scheme.second_task, arm);
        whole.require_dof(arm.dof());
        return visitor(whole);
      },
      core);
}

}  // namespace fpbm::bindings
