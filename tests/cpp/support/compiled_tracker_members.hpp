#pragma once

#include <cstdlib>
#include <type_traits>

#include "support/compiled_tracker.hpp"

namespace fpbm::test {

template <typename Arm, typename Space, typename Scheme, typename Bounds_>
CompiledTracker<Arm, Space, Scheme, Bounds_>::CompiledTracker(const Arm& arm, Space space, const Scheme& scheme,
                                                              const JointState& start, const Options& options,
                                                              const MotionLimits& limits)
    : tracker_(std::make_unique<Tracker<Arm, Space, Scheme, Bounds_>>(arm, space, scheme, start, options, limits)) {}

template <typename Arm, typename Space, typename Scheme, typename Bounds_>
CompiledTracker<Arm, Space, Scheme, Bounds_>::CompiledTracker(const Arm& arm, Space space, const Scheme& scheme,
                                                              const JointState& start, const Options& options,
                                                              const MotionLimits& limits,
                                                              const JointVector& acceleration)
    : tracker_(std::make_unique<Tracker<Arm, Space, Scheme, Bounds_>>(arm, space, scheme, start, options, limits,
                                                                      acceleration)) {}

template <typename Arm, typename Space, typename Scheme, typename Bounds_>
CompiledTracker<Arm, Space, Scheme, Bounds_>::CompiledTracker(const Arm& arm, Space space, const Scheme& scheme,
                                                              const JointState& start, const Options& options)
    : tracker_(std::make_unique<Tracker<Arm, Space, Scheme, Bounds_>>(arm, space, scheme, start, options)) {}

template <typename Arm, typename Space, typename Scheme, typename Bounds_>
CompiledTracker<Arm, Space, Scheme, Bounds_>::CompiledTracker(const Arm& arm, Space space, const Scheme& scheme,
                                                              const JointVector& q0, const Options& options)
    : tracker_(std::make_unique<Tracker<Arm, Space, Scheme, Bounds_>>(arm, space, scheme, q0, options)) {}

template <typename Arm, typename Space, typename Scheme, typename Bounds_>
CompiledTracker<Arm, Space, Scheme, Bounds_>::CompiledTracker(CompiledTracker&&) noexcept = default;

template <typename Arm, typename Space, typename Scheme, typename Bounds_>
CompiledTracker<Arm, Space, Scheme, Bounds_>::~CompiledTracker() = default;

template <typename Arm, typename Space, typename Scheme, typename Bounds_>
auto CompiledTracker<Arm, Space, Scheme, Bounds_>::tick(const Target& reference) noexcept -> Result {
  return tracker_->tick(reference);
}

template <typename Arm, typename Space, typename Scheme, typename Bounds_>
auto CompiledTracker<Arm, Space, Scheme, Bounds_>::tick(
    [[maybe_unused]] PathFollower<AnyPath<Space>>& follower) noexcept -> Result {
  if constexpr (std::is_same_v<Scalar, double>) {
    return tracker_->tick(follower);
  } else {
    std::abort();
  }
}

template <typename Arm, typename Space, typename Scheme, typename Bounds_>
template <typename S>
auto CompiledTracker<Arm, Space, Scheme, Bounds_>::tick(TargetFilter<Space, S>& filter) noexcept -> Result {
  return tracker_->tick(filter);
}

template <typename Arm, typename Space, typename Scheme, typename Bounds_>
auto CompiledTracker<Arm, Space, Scheme, Bounds_>::resolve_measured([[maybe_unused]] const JointVector& q,
                                                                    [[maybe_unused]] const JointVector& qd,
                                                                    [[maybe_unused]] const Target& reference) noexcept
    -> Result {
  if constexpr (kLevel == Level::kAcceleration) {
    return tracker_->resolve_measured(q, qd, reference);
  } else {
    std::abort();
  }
}

template <typename Arm, typename Space, typename Scheme, typename Bounds_>
void CompiledTracker<Arm, Space, Scheme, Bounds_>::stop() noexcept {
  tracker_->stop();
}

template <typename Arm, typename Space, typename Scheme, typename Bounds_>
void CompiledTracker<Arm, Space, Scheme, Bounds_>::resume() noexcept {
  tracker_->resume();
}

template <typename Arm, typename Space, typename Scheme, typename Bounds_>
auto CompiledTracker<Arm, Space, Scheme, Bounds_>::state() const noexcept -> const JointState& {
  return tracker_->state();
}

template <typename Arm, typename Space, typename Scheme, typename Bounds_>
auto CompiledTracker<Arm, Space, Scheme, Bounds_>::acceleration() const noexcept -> const JointVector& {
  return tracker_->acceleration();
}

template <typename Arm, typename Space, typename Scheme, typename Bounds_>
const Arm& CompiledTracker<Arm, Space, Scheme, Bounds_>::arm() const noexcept {
  return tracker_->arm();
}

template <typename Arm, typename Space, typename Scheme, typename Bounds_>
auto CompiledTracker<Arm, Space, Scheme, Bounds_>::tip() const noexcept -> typename Space::template Point<Scalar> {
  return tracker_->tip();
}

template <typename Arm, typename Space, typename Scheme, typename Bounds_>
void CompiledTracker<Arm, Space, Scheme, Bounds_>::require_viable(const MotionLimits& limits) const {
  limits.require_viable(tracker_->state(), tracker_->acceleration());
}

}  // namespace fpbm::test
