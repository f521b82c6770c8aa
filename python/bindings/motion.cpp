#include "motion.hpp"

namespace fpbm::bindings {

template <typename Space>
RolloutResult<kDynamic> Motion<Space>::simulate(const Output<Space>& output) const {
  if (stack != nullptr) return simulate_stack(output);
  Recorder<Space> record(output, scheme.level);
  const auto result = std::visit([&](const auto& any) { return rollout(*arm, path, any, start, grid, record); },
                                 scheme.make<Space>(*arm));
  record.finish();
  return result;
}

template <typename Space>
FastestClock Motion<Space>::clock(const Spline<kDynamic>& joints, const JointLimits<kDynamic>& limits,
                                  AnyBounds& bounds, const FastestOptions& options) const {
  return fastest_clock(joints, path, limits, bounds, options);
}

template struct Motion<Position<2>>;
template struct Motion<PlanarPose>;
template struct Motion<Position<3>>;
template struct Motion<Pose>;

}  // namespace fpbm::bindings
