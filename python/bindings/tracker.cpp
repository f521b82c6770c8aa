#include "tracker_at.hpp"

namespace fpbm::bindings {

template <typename Space>
std::unique_ptr<AnyTracker<Space>> make_tracker(const typename TrackedArm<Space>::type& arm, const Scheme& scheme,
                                                const TrackerStart& from) {
  return std::visit(
      [&](const auto& any) -> std::unique_ptr<AnyTracker<Space>> {
        return std::make_unique<TrackerAt<std::decay_t<decltype(any)>, Space>>(arm, any, from);
      },
      scheme.make<Space>(arm));
}

template std::unique_ptr<AnyTracker<Position<2>>> make_tracker<Position<2>>(const AnyArm<Position<2>>&, const Scheme&,
                                                                            const TrackerStart&);
template std::unique_ptr<AnyTracker<PlanarPose>> make_tracker<PlanarPose>(const AnyArm<Position<2>>&, const Scheme&,
                                                                          const TrackerStart&);
template std::unique_ptr<AnyTracker<Position<3>>> make_tracker<Position<3>>(const AnyArm<Position<3>>&, const Scheme&,
                                                                            const TrackerStart&);
template std::unique_ptr<AnyTracker<Pose>> make_tracker<Pose>(const AnyArm<Position<3>>&, const Scheme&,
                                                              const TrackerStart&);

}  // namespace fpbm::bindings
