#pragma once

#include "arm.hpp"
#include "fpbm/model/planar_arm.hpp"

namespace fpbm::bindings {

template <int N>
class PlanarModel final : public ArmModel {
 public:
  explicit PlanarModel(const Joints& lengths) : arm_(lengths) {}

  [[nodiscard]] Kinematics<Position<2>, kDynamic> kinematics(const Joints& q, const Joints& qd) const override {
    Kinematics<Position<2>, N> result;
    arm_.kinematics(q, qd, result);
    return {result.tip, result.J, result.Jd};
  }

  [[nodiscard]] Status resolve(const PyScheme& scheme, const Reference<Position<2>>& reference,
                               const State<kDynamic>& state, Joints& out) const override {
    const State<N> fixed{state.q, state.qd};
    Kinematics<Position<2>, N> kinematics;
    arm_.kinematics(fixed.q, fixed.qd, kinematics);
    Vector<N> result = Vector<N>::Zero(arm_.dof());
    const Status status = scheme.visit<N>(
        arm_.dof(), [&](const auto& chosen) { return chosen.resolve(kinematics, reference, fixed, result); });
    out = result;
    return status;
  }

  [[nodiscard]] RolloutResult<kDynamic> simulate(const PyScheme& scheme, const PyPath& path,
                                                 const State<kDynamic>& start, const TimeGrid<double>& grid,
                                                 const Buffers& buffers) const override {
    const State<N> fixed{start.q, start.qd};
    const MotionBuffers<2, N> record{buffers.t, buffers.q,     buffers.qd,   buffers.qdd,
                                     buffers.x, buffers.x_ref, buffers.error};
    const Path<AnyShape, AnyTimeLaw>& plain = path;
    const RolloutResult<N> result = scheme.visit<N>(
        arm_.dof(), [&](const auto& chosen) { return rollout(arm_, plain, chosen, fixed, grid, record); });
    return {result.status, result.time, {result.last.q, result.last.qd}, result.samples};
  }

 private:
  PlanarArm<N> arm_;
};

template <int N>
std::unique_ptr<const ArmModel> make_planar_model(const ArmModel::Joints& lengths) {
  return std::make_unique<PlanarModel<N>>(lengths);
}

}  // namespace fpbm::bindings
