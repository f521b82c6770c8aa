#pragma once

#include <memory>

#include "arm.hpp"
#include "fpbm/any/any_path.hpp"
#include "fpbm/realtime/tick.hpp"

namespace fpbm {

template <typename Path>
class PathFollower;

}  // namespace fpbm

/// Trackers and followers behind pointers, so that their code is compiled in tracker.cpp and nowhere else.
namespace fpbm::bindings {

struct Scheme;

/// fpbm::PathFollower of any path.
template <typename Space_>
class AnyFollower {
 public:
  using Space = Space_;

  AnyFollower(const AnyPath<Space>& path, const typename Space::template Point<double>& start, double ramp = 0.5);
  AnyFollower(AnyFollower&&) noexcept;
  AnyFollower& operator=(AnyFollower&&) noexcept;
  ~AnyFollower();

  void pause() noexcept;
  void resume() noexcept;
  [[nodiscard]] double time() const noexcept;
  [[nodiscard]] bool done() const noexcept;
  [[nodiscard]] Reference<Space> ahead(double seconds) const noexcept;

 private:
  template <typename>
  friend class AnyTracker;

  std::unique_ptr<PathFollower<AnyPath<Space>>> follower_;
};

/// fpbm::Tracker of any arm for a task in Space, under any scheme of either level.
template <typename Space_>
class AnyTracker {
 public:
  using Space = Space_;
  using Arm = AnyArmFor<Space>;
  using Result = Tick<Space, kDynamic>;
  static constexpr int N = kDynamic;

  /// Throws std::invalid_argument where scheme, state, options or limits do not fit, as fpbm::Tracker does.
  AnyTracker(const Arm& arm, const Scheme& scheme, const State<kDynamic>& start, const TrackerOptions<>& options,
             const JointLimits<kDynamic>& limits);
  AnyTracker(AnyTracker&&) noexcept;
  AnyTracker& operator=(AnyTracker&&) noexcept;
  ~AnyTracker();

  Result tick(const Reference<Space>& reference) noexcept;
  Result tick(AnyFollower<Space>& follower) noexcept;
  /// Throws std::invalid_argument at velocity level.
  Result resolve_measured(const JointVector& q, const JointVector& qd, const Reference<Space>& reference);
  void stop() noexcept;
  void resume() noexcept;
  [[nodiscard]] const Arm& arm() const noexcept;
  [[nodiscard]] const State<kDynamic>& state() const noexcept;
  [[nodiscard]] typename Space::template Point<double> tip() const noexcept;

 private:
  struct Trackers;

  std::unique_ptr<Trackers> trackers_;
};

extern template class AnyFollower<Position<2>>;
extern template class AnyFollower<PlanarPose>;
extern template class AnyFollower<Position<3>>;
extern template class AnyFollower<Pose>;
extern template class AnyTracker<Position<2>>;
extern template class AnyTracker<PlanarPose>;
extern template class AnyTracker<Position<3>>;
extern template class AnyTracker<Pose>;

}  // namespace fpbm::bindings
