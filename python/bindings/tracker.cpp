#include "tracker.hpp"

#include <variant>

#include "fpbm/realtime/path_follower.hpp"
#include "fpbm/realtime/tracker.hpp"
#include "scheme.hpp"

namespace fpbm::bindings {

template <typename Space>
AnyFollower<Space>::AnyFollower(const AnyPath<Space>& path, const typename Space::template Point<double>& start,
                                double ramp)
    : follower_(std::make_unique<PathFollower<AnyPath<Space>>>(path, start, ramp)) {}

template <typename Space>
AnyFollower<Space>::AnyFollower(AnyFollower&&) noexcept = default;
template <typename Space>
AnyFollower<Space>& AnyFollower<Space>::operator=(AnyFollower&&) noexcept = default;
template <typename Space>
AnyFollower<Space>::~AnyFollower() = default;

template <typename Space>
void AnyFollower<Space>::pause() noexcept {
  follower_->pause();
}
template <typename Space>
void AnyFollower<Space>::resume() noexcept {
  follower_->resume();
}
template <typename Space>
double AnyFollower<Space>::time() const noexcept {
  return follower_->time();
}
template <typename Space>
bool AnyFollower<Space>::done() const noexcept {
  return follower_->done();
}
template <typename Space>
Reference<Space> AnyFollower<Space>::ahead(double seconds) const noexcept {
  return follower_->ahead(seconds);
}

template <typename Space>
struct AnyTracker<Space>::Trackers {
  template <Level kLevel>
  using At = Tracker<Arm, Space, AnyScheme<kLevel, Space>>;

  std::variant<At<Level::kVelocity>, At<Level::kAcceleration>> either;

  template <Level kLevel>
  static At<kLevel> make(const Arm& arm, const Scheme& scheme, const State<kDynamic>& start,
                         const TrackerOptions<>& options, const JointLimits<kDynamic>& limits) {
    const Limits<kLevel, kDynamic> kept(limits, options.dt);
    const Scheme damped = scheme.with_default_damping(options.singular);
    return {arm, Space{}, damped.make<kLevel, Space>(arm), start, options, kept};
  }
};

template <typename Space>
AnyTracker<Space>::AnyTracker(const Arm& arm, const Scheme& scheme, const State<kDynamic>& start,
                              const TrackerOptions<>& options, const JointLimits<kDynamic>& limits) {
  if (scheme.level == Level::kVelocity) {
    trackers_.reset(new Trackers{Trackers::template make<Level::kVelocity>(arm, scheme, start, options, limits)});
  } else {
    trackers_.reset(new Trackers{Trackers::template make<Level::kAcceleration>(arm, scheme, start, options, limits)});
  }
}

template <typename Space>
AnyTracker<Space>::AnyTracker(AnyTracker&&) noexcept = default;
template <typename Space>
AnyTracker<Space>& AnyTracker<Space>::operator=(AnyTracker&&) noexcept = default;
template <typename Space>
AnyTracker<Space>::~AnyTracker() = default;

template <typename Space>
auto AnyTracker<Space>::tick(const Reference<Space>& reference) noexcept -> Result {
  return std::visit([&](auto& tracker) { return tracker.tick(reference); }, trackers_->either);
}

template <typename Space>
auto AnyTracker<Space>::tick(AnyFollower<Space>& follower) noexcept -> Result {
  return std::visit([&](auto& tracker) { return tracker.tick(*follower.follower_); }, trackers_->either);
}

template <typename Space>
auto AnyTracker<Space>::resolve_measured(const JointVector& q, const JointVector& qd, const Reference<Space>& reference)
    -> Result {
  auto* tracker = std::get_if<1>(&trackers_->either);
  if (tracker == nullptr) {
    throw std::invalid_argument("resolve_measured: a velocity-level scheme has no accelerations");
  }
  return tracker->resolve_measured(q, qd, reference);
}

template <typename Space>
void AnyTracker<Space>::stop() noexcept {
  std::visit([](auto& tracker) { tracker.stop(); }, trackers_->either);
}

template <typename Space>
void AnyTracker<Space>::resume() noexcept {
  std::visit([](auto& tracker) { tracker.resume(); }, trackers_->either);
}

template <typename Space>
auto AnyTracker<Space>::arm() const noexcept -> const Arm& {
  return std::visit([](const auto& tracker) -> const Arm& { return tracker.arm(); }, trackers_->either);
}

template <typename Space>
const State<kDynamic>& AnyTracker<Space>::state() const noexcept {
  return std::visit([](const auto& tracker) -> const State<kDynamic>& { return tracker.state(); }, trackers_->either);
}

template <typename Space>
typename Space::template Point<double> AnyTracker<Space>::tip() const noexcept {
  return std::visit([](const auto& tracker) { return tracker.tip(); }, trackers_->either);
}

template class AnyFollower<Position<2>>;
template class AnyFollower<PlanarPose>;
template class AnyFollower<Position<3>>;
template class AnyFollower<Pose>;
template class AnyTracker<Position<2>>;
template class AnyTracker<PlanarPose>;
template class AnyTracker<Position<3>>;
template class AnyTracker<Pose>;

}  // namespace fpbm::bindings
