#include "support/compiled_tracker_members.hpp"

/// In float, of fixed and of run-time size.
namespace fpbm::test {

constexpr int kOpen = Eigen::Dynamic;

template class CompiledTracker<PlanarArm<4, float>, Position<2>, AccelerationScheme<4, float>>;
template class CompiledTracker<PlanarArm<4, float>, Position<2>, VelocityScheme<4, float>>;
template class CompiledTracker<SerialArm<kOpen, float>, Position<3>, AccelerationScheme<kOpen, float>>;
template class CompiledTracker<SerialArm<kOpen, float>, Position<3>, VelocityScheme<kOpen, float>>;

}  // namespace fpbm::test
