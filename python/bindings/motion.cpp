#include "motion.hpp"

#include "fpbm/realtime/track.hpp"
#include "tracker.hpp"

namespace fpbm::bindings {
namespace {

template <typename Space>
AnyTracker<Space> tracker_of(const Motion<Space>& motion, const Limited& limited) {
  TrackerOptions<> options = limited.options;
  options.dt = motion.grid.dt();
  return {motion.arm, motion.scheme, motion.start, options, limited.limits};
}

}  // namespace

template <typename Space>
RolloutResult<kDynamic> Motion<Space>::simulate(const Output<Space>& output) const {
  Recorder<Space> record(output, scheme.level);
  const auto result =
      scheme.visit<Space>(arm, [&](const auto& any) { return rollout(arm, path, any, start, grid, record); });
  record.finish();
  return result;
}

template <typename Space>
RolloutResult<kDynamic> Motion<Space>::track(const Limited& limited, const Output<Space>& output) const {
  AnyTracker<Space> tracker = tracker_of(*this, limited);
  AnyFollower<Space> follower(path, tracker.tip());
  Recorder<Space> record(output, Level::kAcceleration);
  const auto result = fpbm::track(tracker, follower, grid, record);
  record.finish();
  return result;
}

template <typename Space>
void Motion<Space>::require(const Limited* limited) const {
  if (limited != nullptr) {
    (void)tracker_of(*this, *limited);
  } else {
    scheme.visit<Space>(arm, [&](const auto& any) { any.require_dof(arm.dof()); });
  }
}

template struct Motion<Position<2>>;
template struct Motion<PlanarPose>;
template struct Motion<Position<3>>;
template struct Motion<Pose>;

}  // namespace fpbm::bindings
