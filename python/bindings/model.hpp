#pragma once

#include "lanes.hpp"
#include "whole_arm.hpp"

namespace fpbm::bindings {

template <typename Arm, typename Space>
class Model final : public TaskModel<Space> {
 public:
  explicit Model(std::shared_ptr<const Arm> arm) : arm_(std::move(arm)) {}

  [[nodiscard]] Kinematics<Space, kDynamic> kinematics(const Joints& q, const Joints& qd) const override {
    Kinematics<Space, N> result;
    arm_->kinematics(q, qd, result);
    return {result.tip, result.J, result.Jd};
  }

  [[nodiscard]] RolloutResult<kDynamic> simulate(const PyScheme& scheme, const AnyPath<Space>& path,
                                                 const State<kDynamic>& start, const TimeGrid<double>& grid,
                                                 const Wanted<Space>& wanted) const override {
    if (scheme.has_wrappers()) return bindings::simulate(scheme, whole(), path, start, grid, wanted);
    const State<N> fixed{start.q, start.qd};
    Recorder<Space, N> record(wanted, scheme.level());
    const RolloutResult<N> result = scheme.visit_core<N>(
        arm_->limits(), [&](const auto& chosen) { return rollout(*arm_, path, chosen, fixed, grid, record); });
    record.finish();
    return {result.status, result.time, {result.last.q, result.last.qd}, result.samples};
  }

  [[nodiscard]] int lanes() const noexcept override {
    return bindings::run_in_lanes<Arm, Space>() == nullptr ? 1 : lane_code()->lanes;
  }

  void run_in_lanes(const AnyPath<Space>& path, const TimeGrid<double>& grid, const PyScheme* const* schemes,
                    const Joints* starts, const std::atomic<bool>& stop, Outcome* outcomes) const override {
    bindings::run_in_lanes<Arm, Space>()(*arm_, path, grid, schemes, starts, stop, outcomes);
  }

  void require(const PyScheme& scheme) const override { bindings::require(scheme, whole()); }

 private:
  static constexpr int N = Arm::kDof;

  [[nodiscard]] WholeArm<Space> whole() const {
    using Poses = typename PoseOver<typename ArmTraits<Arm>::Positions>::type;
    std::shared_ptr<const TaskModel<Pose>> poses;
    if constexpr (std::is_same_v<Poses, Pose>) poses = std::make_shared<Model<Arm, Pose>>(arm_);
    const JointLimits<N> limits = arm_->limits();
    return {
        borrowed<TaskModel<Space>>(*this), poses, {limits.lower, limits.upper, limits.velocity, limits.acceleration}};
  }

  std::shared_ptr<const Arm> arm_;
};

template <typename Arm>
ModelsOf<Arm> make_models(const typename ArmTraits<Arm>::Source& source) {
  using Positions = typename ArmTraits<Arm>::Positions;
  const auto arm = std::make_shared<const Arm>(source);
  return {std::make_shared<Model<Arm, Positions>>(arm),
          std::make_shared<Model<Arm, typename PoseOver<Positions>::type>>(arm)};
}

}  // namespace fpbm::bindings
