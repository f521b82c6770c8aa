#pragma once

#include <memory>
#include <utility>
#include <variant>
#include <vector>

#include "stack_tasks.hpp"
#include "stack_tracker.hpp"
#include "tracker.hpp"

namespace fpbm::bindings {

/// A tracker of a stack, and the reference that each task had last.
class StackMotion {
 public:
  using Space = StackTracker::Space;
  using Result = StackTracker::Result;
  /// The reference of a task in a tick: a path or a filter, which have their own references.
  using Source =
      std::variant<AnyFollower<Position<3>>*, AnyFollower<Pose>*, TargetFilter<Position<3>>*, TargetFilter<Pose>*>;
  using Sources = std::vector<std::pair<const StackTask*, Source>>;
  using Targets = std::vector<std::pair<const StackTask*, StackTarget>>;

  /// Throws std::invalid_argument as fpbm::Tracker does.
  StackMotion(const StackPlan& plan, const Scheme& scheme, const State<kDynamic>& start,
              const TrackerOptions<>& options, const JointLimits<kDynamic>& limits, const JointVector& qdd0,
              const Clearance<kDynamic>& clearance);

  /// Gives tasks their targets; the others keep theirs, at rest.
  void aim(const Targets& targets) noexcept;
  /// One tick: tasks with a source follow it, the others have their targets. The clocks of the sources advance.
  [[nodiscard]] Result tick(const Sources& sources) noexcept;
  /// Throws std::invalid_argument if the scheme is of velocity level.
  [[nodiscard]] Result resolve_measured(const State<kDynamic>& measured, const Sources& sources);

  /// The new level k is the old level order[k], with its targets. False, without an effect, as Stack::reorder().
  bool reorder(const std::array<int, AnyStack::kLevels>& order) noexcept;

  void stop() noexcept;
  void resume() noexcept;

  [[nodiscard]] const StackPlan& plan() const noexcept { return plan_; }
  [[nodiscard]] StackTracker& tracker() const noexcept { return *tracker_; }
  /// Where the frame of a task is; of an axis, its z axis is that.
  [[nodiscard]] Transform<> frame_of(const StackTask& task) const noexcept;
  /// Positions of the joints of a posture.
  [[nodiscard]] JointVector posture_of(const StackTask& task) const noexcept;
  /// The entries of a task's error in a tick.
  [[nodiscard]] static JointVector error_of(const StackTask& task, const Result& tick) noexcept;

 private:
  [[nodiscard]] StackTarget target_of(const StackTask& task) const noexcept;
  void put(const StackTask& task, const StackTarget& target, Reference<Space>& to) const noexcept;
  void put(const StackTask& task, const Source& source, double seconds, Reference<Space>& to) const noexcept;

  StackPlan plan_;
  double dt_;
  bool stopping_ = false;
  std::unique_ptr<StackTracker> tracker_;
  Reference<Space> held_;
};

}  // namespace fpbm::bindings
