#include "fpbm/realtime/track.hpp"

#include <memory>

#include "motion.hpp"
#include "tracker.hpp"

namespace fpbm::bindings {
namespace {

template <typename Space>
std::unique_ptr<AnyTracker<Space>> tracker_of(const Motion<Space>& motion, const Limited& limited) {
  TrackerOptions<> options = limited.options;
  options.dt = motion.grid.dt();
  return make_tracker<Space>(motion.scheme, {motion.arm, motion.start, options, limited.limits,
                                             JointVector::Zero(motion.start.q.size()), limited.clearance});
}

}  // namespace

template <typename Space>
RolloutResult<kDynamic> Motion<Space>::track(const Limited& limited, const Output<Space>& output) const {
  const auto tracker = tracker_of(*this, limited);
  Recorder<Space> record(output, Level::kAcceleration);
  AnyFollower<Space> follower(path, tracker->tip());
  auto& clearance = tracker->clearance();
  const auto with_clearance = [&](const auto& sample, const auto& tick) noexcept {
    if (output.clearance != nullptr) {
      clearance.place(sample.q);
      output.clearance[sample.index] = clearance.nearest_pair().second;
    }
    return record(sample, tick);
  };
  const auto result = fpbm::track(*tracker, follower, grid, with_clearance);
  record.finish();
  return result;
}

template <typename Space>
template <int N>
LaneTracker<Space, N> Motion<Space>::tracker(const Limited& limited) const {
  return LaneTracker<Space, N>(tracker_of(*this, limited));
}

template <typename Space>
void Motion<Space>::require(const Limited* limited) const {
  if (limited != nullptr) {
    (void)tracker_of(*this, *limited);
  } else {
    (void)scheme.make<Space>(arm);
  }
}

template struct Motion<Position<2>>;
template struct Motion<PlanarPose>;
template struct Motion<Position<3>>;
template struct Motion<Pose>;
template LaneTracker<Position<2>, 4> Motion<Position<2>>::tracker<4>(const Limited&) const;
template LaneTracker<Position<3>, 7> Motion<Position<3>>::tracker<7>(const Limited&) const;
template LaneTracker<Pose, 7> Motion<Pose>::tracker<7>(const Limited&) const;

}  // namespace fpbm::bindings
