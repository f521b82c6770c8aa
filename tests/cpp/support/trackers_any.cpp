#include "support/compiled_tracker_members.hpp"

/// Arms of run-time size, at both levels.
namespace fpbm::test {

constexpr int kOpen = Eigen::Dynamic;
using InSpace = AnyArm<Position<3>>;
using Flat = AnyArm<Position<2>>;

template class CompiledTracker<InSpace, Pose, AccelerationScheme<kOpen>>;
template class CompiledTracker<InSpace, Pose, VelocityScheme<kOpen>>;
template class CompiledTracker<InSpace, Position<3>, AccelerationScheme<kOpen>>;
template class CompiledTracker<InSpace, Position<3>, VelocityScheme<kOpen>>;
template class CompiledTracker<Flat, PlanarPose, AccelerationScheme<kOpen>>;
template class CompiledTracker<Flat, PlanarPose, VelocityScheme<kOpen>>;
template class CompiledTracker<Flat, Position<2>, AccelerationScheme<kOpen>>;
template class CompiledTracker<Flat, Position<2>, VelocityScheme<kOpen>>;

}  // namespace fpbm::test
