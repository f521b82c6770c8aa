#pragma once

#include <memory>
#include <utility>
#include <variant>
#include <vector>

#include "bounds.hpp"
#include "stack_path.hpp"
#include "stack_tracker.hpp"
#include "tracker.hpp"

namespace fpbm::bindings {

/// A tracker of a stack, and the last reference of each task.
class StackMotion {
 public:
  using Space = StackTracker::Space;
  using Result = StackTracker::Result;
  /// Source of the reference of a task in a tick: a path or a filter.
  using Source =
      std::variant<AnyFollower<Position<3>>*, AnyFollower<Pose>*, TargetFilter<Position<3>>*, TargetFilter<Pose>*>;
  using Sources = std::vector<std::pair<const StackTask*, Source>>;
  using Targets = std::vector<std::pair<const StackTask*, StackTarget>>;

  /// Throws std::invalid_argument as fpbm::Tracker does.
  StackMotion(const StackPlan& plan, const Scheme& scheme, const State<kDynamic>& start,
              const TrackerOptions<>& options, const JointLimits<kDynamic>& limits, const JointVector& qdd0,
              const AnyBounds& bounds);

  /// Sets the targets of the given tasks; all other tasks keep their last target, at rest.
  void aim(const Targets& targets) noexcept;
  /// One tick: a task with a source follows the source; all other tasks follow their targets. The clocks of the sources
  /// advance.
  [[nodiscard]] Result tick(const Sources& sources) noexcept;
  /// Throws std::invalid_argument if the scheme is of velocity level.
  [[nodiscard]] Result resolve_measured(const State<kDynamic>& measured, const Sources& sources);

  /// The new level k is the old level order[k], with its targets. Returns false, without an effect, if Stack::reorder()
  /// returns false.
  bool reorder(const std::array<int, AnyStack::kLevels>& order) noexcept;

  void stop() noexcept;
  void resume() noexcept;

  [[nodiscard]] const StackPlan& plan() const noexcept { return plan_; }
  [[nodiscard]] StackTracker& tracker() const noexcept { return *tracker_; }

 private:
  [[nodiscard]] StackTarget target_of(const StackTask& task) const noexcept;
  void put(const StackTask& task, const Source& source, double seconds, Reference<Space>& to) const noexcept;

  StackPlan plan_;
  double dt_;
  bool stopping_ = false;
  std::unique_ptr<StackTracker> tracker_;
  Reference<Space> held_;
};

}  // namespace fpbm::bindings
