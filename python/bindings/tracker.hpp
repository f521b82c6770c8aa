#pragma once

#include <memory>

#include "bounds.hpp"
#include "fpbm/any/detail/any_path.hpp"
#include "fpbm/path/path_follower.hpp"
#include "fpbm/realtime/detail/tick_references.hpp"
#include "fpbm/realtime/tick.hpp"
#include "fpbm/target/target_filter.hpp"
#include "scheme.hpp"

namespace fpbm::bindings {

template <typename Space>
using AnyFollower = PathFollower<AnyPath<Space>>;

/// fpbm::Tracker of a task in Space, for any arm, scheme and bounds.
template <typename Space>
class AnyTracker {
 public:
  static constexpr int N = kDynamic;
  using Point = typename Space::template Point<double>;
  using Result = Tick<Space, kDynamic>;

  AnyTracker() = default;
  AnyTracker(const AnyTracker&) = delete;
  AnyTracker& operator=(const AnyTracker&) = delete;
  virtual ~AnyTracker() = default;

  virtual Result tick(const Reference<Space>& reference) noexcept = 0;
  virtual Result tick(AnyFollower<Space>& follower) noexcept = 0;
  virtual Result tick(TargetFilter<Space>& filter) noexcept = 0;
  /// Throws std::invalid_argument if the scheme is of velocity level.
  [[nodiscard]] virtual Result resolve_measured(const State<kDynamic>& measured, const Reference<Space>& reference) = 0;

  virtual void stop() noexcept = 0;
  virtual void resume() noexcept = 0;

  [[nodiscard]] virtual const AnyArmFor<Space>& arm() const noexcept = 0;
  [[nodiscard]] virtual const State<kDynamic>& state() const noexcept = 0;
  [[nodiscard]] virtual const JointVector& acceleration() const noexcept = 0;
  [[nodiscard]] virtual const JointVector& acceleration_change() const noexcept = 0;
  [[nodiscard]] virtual Point tip() const noexcept = 0;
  [[nodiscard]] virtual double sigma() const noexcept = 0;
  [[nodiscard]] virtual Clearance<kDynamic>& clearance() noexcept = 0;

  // A tick whose step is made in lanes (LaneTracker).
  virtual bool begin(const Vector<Space::kRows>& error, double length) noexcept = 0;
  [[nodiscard]] virtual Reference<Space> corrected(const Reference<Space>& reference) const noexcept = 0;
  virtual Status finish(const Reference<Space>& now, const TickReferences<Space>& references,
                        const JointVector& u) noexcept = 0;
  virtual Status advance(const TickReferences<Space>& references) noexcept = 0;
};

/// The arguments of a tracker, apart from its scheme.
template <typename Space>
struct TrackerStart {
  const AnyArmFor<Space>& arm;
  const State<kDynamic>& start;
  const TrackerOptions<>& options;
  const JointLimits<kDynamic>& limits;
  const JointVector& qdd0;
  const AnyBounds& bounds;
};

/// The tracker. Throws std::invalid_argument if scheme, start, options, limits or bounds do not fit, as
/// fpbm::Tracker does. Compiled once, in tracker.cpp.
template <typename Space>
std::unique_ptr<AnyTracker<Space>> make_tracker(const Scheme& scheme, const TrackerStart<Space>& from);

}  // namespace fpbm::bindings
