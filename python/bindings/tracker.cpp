#include "tracker.hpp"

#include <stdexcept>

namespace fpbm::bindings {

template <typename Space>
template <Level kLevel>
auto AnyTracker<Space>::make(const Arm& arm, const Scheme& scheme, const State<kDynamic>& start,
                             const TrackerOptions<>& options, const JointLimits<kDynamic>& limits) -> At<kLevel> {
  const Limits<kLevel, kDynamic> kept(limits, options.dt);
  const Scheme damped = scheme.with_default_damping(options.singular);
  return {arm, Space{}, damped.make<kLevel, Space>(arm), start, options, kept};
}

template <typename Space>
AnyTracker<Space>::AnyTracker(const Arm& arm, const Scheme& scheme, const State<kDynamic>& start,
                              const TrackerOptions<>& options, const JointLimits<kDynamic>& limits)
    : tracker_(scheme.level == Level::kVelocity
                   ? decltype(tracker_)(make<Level::kVelocity>(arm, scheme, start, options, limits))
                   : decltype(tracker_)(make<Level::kAcceleration>(arm, scheme, start, options, limits))) {}

template <typename Space>
auto AnyTracker<Space>::tick(const Target& reference) noexcept -> Result {
  return std::visit([&](auto& tracker) { return tracker.tick(reference); }, tracker_);
}

template <typename Space>
auto AnyTracker<Space>::tick(Follower<Space>& follower) noexcept -> Result {
  return std::visit([&](auto& tracker) { return tracker.tick(follower); }, tracker_);
}

template <typename Space>
auto AnyTracker<Space>::resolve_measured(const JointVector& q, const JointVector& qd, const Target& reference)
    -> Result {
  auto* tracker = std::get_if<At<Level::kAcceleration>>(&tracker_);
  if (tracker == nullptr) {
    throw std::invalid_argument("resolve_measured: a velocity-level scheme has no accelerations");
  }
  return tracker->resolve_measured(q, qd, reference);
}

template <typename Space>
void AnyTracker<Space>::stop() noexcept {
  std::visit([](auto& tracker) { tracker.stop(); }, tracker_);
}

template <typename Space>
void AnyTracker<Space>::resume() noexcept {
  std::visit([](auto& tracker) { tracker.resume(); }, tracker_);
}

template <typename Space>
auto AnyTracker<Space>::arm() const noexcept -> const Arm& {
  return std::visit([](const auto& tracker) -> const Arm& { return tracker.arm(); }, tracker_);
}

template <typename Space>
const State<kDynamic>& AnyTracker<Space>::state() const noexcept {
  return std::visit([](const auto& tracker) -> const State<kDynamic>& { return tracker.state(); }, tracker_);
}

template <typename Space>
typename Space::template Point<double> AnyTracker<Space>::tip() const noexcept {
  return std::visit([](const auto& tracker) { return tracker.tip(); }, tracker_);
}

template class AnyTracker<Position<2>>;
template class AnyTracker<PlanarPose>;
template class AnyTracker<Position<3>>;
template class AnyTracker<Pose>;

}  // namespace fpbm::bindings
