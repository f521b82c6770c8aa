#pragma once

#include <variant>

#include "fpbm/any/any_path.hpp"
#include "fpbm/realtime/path_follower.hpp"
#include "fpbm/realtime/tracker.hpp"
#include "scheme.hpp"

namespace fpbm::bindings {

template <typename Space>
using Follower = PathFollower<AnyPath<Space>>;

/// A tracker of any arm for a task in Space, under any scheme of either level. Compiled once, in tracker.cpp.
template <typename Space_>
class AnyTracker {
 public:
  using Space = Space_;
  using Arm = AnyArmFor<Space>;
  using Target = Reference<Space>;
  using Result = Tick<Space, kDynamic>;
  static constexpr int N = kDynamic;

  /// Throws std::invalid_argument where scheme, state, options or limits do not fit, as fpbm::Tracker does.
  AnyTracker(const Arm& arm, const Scheme& scheme, const State<kDynamic>& start, const TrackerOptions<>& options,
             const JointLimits<kDynamic>& limits);

  Result tick(const Target& reference) noexcept;
  Result tick(Follower<Space>& follower) noexcept;
  /// Throws std::invalid_argument at velocity level.
  Result resolve_measured(const JointVector& q, const JointVector& qd, const Target& reference);
  void stop() noexcept;
  void resume() noexcept;
  [[nodiscard]] const Arm& arm() const noexcept;
  [[nodiscard]] const State<kDynamic>& state() const noexcept;
  [[nodiscard]] typename Space::template Point<double> tip() const noexcept;

 private:
  template <Level kLevel>
  using At = Tracker<Arm, Space, AnyScheme<kLevel, Space>>;

  template <Level kLevel>
  static At<kLevel> make(const Arm& arm, const Scheme& scheme, const State<kDynamic>& start,
                         const TrackerOptions<>& options, const JointLimits<kDynamic>& limits);

  std::variant<At<Level::kVelocity>, At<Level::kAcceleration>> tracker_;
};

extern template class AnyTracker<Position<2>>;
extern template class AnyTracker<PlanarPose>;
extern template class AnyTracker<Position<3>>;
extern template class AnyTracker<Pose>;

}  // namespace fpbm::bindings
