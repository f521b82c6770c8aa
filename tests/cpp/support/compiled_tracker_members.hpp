#pragma once

#include <cstdlib>
#include <type_traits>

#include "support/compiled_tracker.hpp"

namespace fpbm::test {

template <typename Arm, typename Space, typename Scheme, typename Guard>
CompiledTracker<Arm, Space, Scheme, Guard>::CompiledTracker(const Arm& arm, Space space, const Scheme& scheme,
                                                            const JointState& start, const Options& options,
                                                            const JointLimits& limits)
    : tracker_(std::make_unique<Tracker<Arm, Space, Scheme, Guard>>(arm, space, scheme, start, options, limits)) {}

template <typename Arm, typename Space, typename Scheme, typename Guard>
CompiledTracker<Arm, Space, Scheme, Guard>::CompiledTracker(const Arm& arm, Space space, const Scheme& scheme,
                                                            const JointState& start, const Options& options,
                                                            const JointLimits& limits, const JointVector& acceleration)
    : tracker_(std::make_unique<Tracker<Arm, Space, Scheme, Guard>>(arm, space, scheme, start, options, limits,
                                                                    acceleration)) {}

template <typename Arm, typename Space, typename Scheme, typename Guard>
CompiledTracker<Arm, Space, Scheme, Guard>::CompiledTracker(const Arm& arm, Space space, const Scheme& scheme,
                                                            const JointState& start, const Options& options)
    : tracker_(std::make_unique<Tracker<Arm, Space, Scheme, Guard>>(arm, space, scheme, start, options)) {}

template <typename Arm, typename Space, typename Scheme, typename Guard>
CompiledTracker<Arm, Space, Scheme, Guard>::CompiledTracker(const Arm& arm, Space space, const Scheme& scheme,
                                                            const JointVector& q0, const Options& options)
    : tracker_(std::make_unique<Tracker<Arm, Space, Scheme, Guard>>(arm, space, scheme, q0, options)) {}

template <typename Arm, typename Space, typename Scheme, typename Guard>
CompiledTracker<Arm, Space, Scheme, Guard>::CompiledTracker(CompiledTracker&&) noexcept = default;

template <typename Arm, typename Space, typename Scheme, typename Guard>
CompiledTracker<Arm, Space, Scheme, Guard>::~CompiledTracker() = default;

template <typename Arm, typename Space, typename Scheme, typename Guard>
auto CompiledTracker<Arm, Space, Scheme, Guard>::tick(const Target& reference) noexcept -> Result {
  return tracker_->tick(reference);
}

template <typename Arm, typename Space, typename Scheme, typename Guard>
auto CompiledTracker<Arm, Space, Scheme, Guard>::tick([[maybe_unused]] PathFollower<AnyPath<Space>>& follower) noexcept
    -> Result {
  if constexpr (std::is_same_v<Scalar, double>) {
    return tracker_->tick(follower);
  } else {
    std::abort();
  }
}

template <typename Arm, typename Space, typename Scheme, typename Guard>
template <typename S>
auto CompiledTracker<Arm, Space, Scheme, Guard>::tick(TargetFilter<Space, S>& filter) noexcept -> Result {
  return tracker_->tick(filter);
}

template <typename Arm, typename Space, typename Scheme, typename Guard>
auto CompiledTracker<Arm, Space, Scheme, Guard>::resolve_measured([[maybe_unused]] const JointVector& q,
                                                                  [[maybe_unused]] const JointVector& qd,
                                                                  [[maybe_unused]] const Target& reference) noexcept
    -> Result {
  if constexpr (kLevel == Level::kAcceleration) {
    return tracker_->resolve_measured(q, qd, reference);
  } else {
    std::abort();
  }
}

template <typename Arm, typename Space, typename Scheme, typename Guard>
void CompiledTracker<Arm, Space, Scheme, Guard>::stop() noexcept {
  tracker_->stop();
}

template <typename Arm, typename Space, typename Scheme, typename Guard>
void CompiledTracker<Arm, Space, Scheme, Guard>::resume() noexcept {
  tracker_->resume();
}

template <typename Arm, typename Space, typename Scheme, typename Guard>
auto CompiledTracker<Arm, Space, Scheme, Guard>::state() const noexcept -> const JointState& {
  return tracker_->state();
}

template <typename Arm, typename Space, typename Scheme, typename Guard>
auto CompiledTracker<Arm, Space, Scheme, Guard>::acceleration() const noexcept -> const JointVector& {
  return tracker_->acceleration();
}

template <typename Arm, typename Space, typename Scheme, typename Guard>
const Arm& CompiledTracker<Arm, Space, Scheme, Guard>::arm() const noexcept {
  return tracker_->arm();
}

template <typename Arm, typename Space, typename Scheme, typename Guard>
auto CompiledTracker<Arm, Space, Scheme, Guard>::tip() const noexcept -> typename Space::template Point<Scalar> {
  return tracker_->tip();
}

template <typename Arm, typename Space, typename Scheme, typename Guard>
void CompiledTracker<Arm, Space, Scheme, Guard>::require_viable(const JointLimits& limits) const {
  limits.require_viable(tracker_->state(), tracker_->acceleration());
}

}  // namespace fpbm::test
