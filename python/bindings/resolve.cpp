#include "kinematics.hpp"
#include "objectives.hpp"

namespace fpbm::bindings {

template <typename Space>
Status resolve(const PyScheme& scheme, const Kinematics<Space, kDynamic>& kinematics, const Reference<Space>& reference,
               const State<kDynamic>& state, Joints& out) {
  return std::visit([&](const auto& alone) { return alone.resolve(kinematics, reference, state, out); },
                    scheme_alone<Space>(scheme, state.q.size()));
}

template <typename Space>
Status resolve(const PyScheme& scheme, const WholeArm<Space>& arm, const Reference<Space>& reference,
               const State<kDynamic>& state, Joints& out) {
  const Kinematics<Space, kDynamic> kinematics = arm.model->kinematics(state.q, state.qd);
  return std::visit([&](const auto& whole) { return whole.resolve(kinematics, reference, state, out); },
                    whole_scheme(scheme, arm));
}

template <typename Space>
RolloutResult<kDynamic> simulate(const PyScheme& scheme, const WholeArm<Space>& arm, const AnyPath<Space>& path,
                                 const State<kDynamic>& start, const TimeGrid<double>& grid,
                                 const Wanted<Space>& wanted) {
  Recorder<Space, kDynamic> record(wanted, scheme.level());
  const auto result = std::visit(
      [&](const auto& whole) { return rollout(AnyArm<Space>(arm.model, arm.dof()), path, whole, start, grid, record); },
      whole_scheme(scheme, arm));
  record.finish();
  return result;
}

template <typename Space>
void require(const PyScheme& scheme, const WholeArm<Space>& arm) {
  (void)whole_scheme(scheme, arm);
}

template Status resolve(const PyScheme&, const Kinematics<Position<2>, kDynamic>&, const Reference<Position<2>>&,
                        const State<kDynamic>&, Joints&);
template Status resolve(const PyScheme&, const WholeArm<Position<2>>&, const Reference<Position<2>>&,
                        const State<kDynamic>&, Joints&);
template RolloutResult<kDynamic> simulate(const PyScheme&, const WholeArm<Position<2>>&, const AnyPath<Position<2>>&,
                                          const State<kDynamic>&, const TimeGrid<double>&, const Wanted<Position<2>>&);
template void require(const PyScheme&, const WholeArm<Position<2>>&);
template Status resolve(const PyScheme&, const Kinematics<PlanarPose, kDynamic>&, const Reference<PlanarPose>&,
                        const State<kDynamic>&, Joints&);
template Status resolve(const PyScheme&, const WholeArm<PlanarPose>&, const Reference<PlanarPose>&,
                        const State<kDynamic>&, Joints&);
template RolloutResult<kDynamic> simulate(const PyScheme&, const WholeArm<PlanarPose>&, const AnyPath<PlanarPose>&,
                                          const State<kDynamic>&, const TimeGrid<double>&, const Wanted<PlanarPose>&);
template void require(const PyScheme&, const WholeArm<PlanarPose>&);
template Status resolve(const PyScheme&, const Kinematics<Position<3>, kDynamic>&, const Reference<Position<3>>&,
                        const State<kDynamic>&, Joints&);
template Status resolve(const PyScheme&, const WholeArm<Position<3>>&, const Reference<Position<3>>&,
                        const State<kDynamic>&, Joints&);
template RolloutResult<kDynamic> simulate(const PyScheme&, const WholeArm<Position<3>>&, const AnyPath<Position<3>>&,
                                          const State<kDynamic>&, const TimeGrid<double>&, const Wanted<Position<3>>&);
template void require(const PyScheme&, const WholeArm<Position<3>>&);
template Status resolve(const PyScheme&, const Kinematics<Pose, kDynamic>&, const Reference<Pose>&,
                        const State<kDynamic>&, Joints&);
template Status resolve(const PyScheme&, const WholeArm<Pose>&, const Reference<Pose>&, const State<kDynamic>&,
                        Joints&);
template RolloutResult<kDynamic> simulate(const PyScheme&, const WholeArm<Pose>&, const AnyPath<Pose>&,
                                          const State<kDynamic>&, const TimeGrid<double>&, const Wanted<Pose>&);
template void require(const PyScheme&, const WholeArm<Pose>&);

}  // namespace fpbm::bindings
