#pragma once

#include <variant>

#include "fpbm/any/any_path.hpp"
#include "fpbm/clearance/guard.hpp"
#include "fpbm/realtime/path_follower.hpp"
#include "fpbm/realtime/tracker.hpp"
#include "scheme.hpp"

namespace fpbm::bindings {

/// fpbm::Tracker of any arm for a task in Space, under any scheme of one level, clear of shapes; and of either level.
/// A clearance of nothing is all but free, and spares a second tracker.
template <Level kLevel, typename Space>
using TrackerAt = Tracker<AnyArmFor<Space>, Space, AnyScheme<kLevel, Space>, Guard<kLevel, kDynamic>>;
template <typename Space>
using AnyTracker = std::variant<TrackerAt<Level::kVelocity, Space>, TrackerAt<Level::kAcceleration, Space>>;

template <typename Space>
using AnyFollower = PathFollower<AnyPath<Space>>;

/// Throws std::invalid_argument where scheme, state, options, limits or clearance do not fit, as fpbm::Tracker does.
template <typename Space>
AnyTracker<Space> make_tracker(const AnyArmFor<Space>& arm, const Scheme& scheme, const State<kDynamic>& start,
                               const TrackerOptions<>& options, const JointLimits<kDynamic>& limits,
                               const JointVector& qdd0, const Clearance<kDynamic>& clearance) {
  const auto make = [&](const auto& any) -> AnyTracker<Space> {
    constexpr Level kLevel = std::decay_t<decltype(any)>::kLevel;
    return TrackerAt<kLevel, Space>(arm, Space{}, any, start, options, Limits<kLevel, kDynamic>(limits, options.dt),
                                    qdd0, Guard<kLevel, kDynamic>(clearance));
  };
  return std::visit(make, scheme.make<Space>(arm));
}

}  // namespace fpbm::bindings
