#pragma once

#include <array>
#include <utility>
#include <variant>
#include <vector>

#include "stack_tasks.hpp"
#include "stream.hpp"
#include "tracker.hpp"

namespace fpbm::bindings {

/// The references of a stack in a tick: a task with a source follows the source; each other task follows its last
/// target.
class StackReferences {
 public:
  using Space = AnyStack::Space;
  /// A path, a filter or a stream.
  using Source = std::variant<AnyFollower<Position<3>>*, AnyFollower<Pose>*, TargetFilter<Position<3>>*,
                              TargetFilter<Pose>*, PyStream*>;
  using Sources = std::vector<std::pair<const StackTask*, Source>>;
  using Targets = std::vector<std::pair<const StackTask*, StackTarget>>;

  /// The targets of the plan or, without a target, the points of `tip`.
  StackReferences(const StackPlan& plan, const AnyStack::Point& tip);
  StackReferences(const StackReferences&) = delete;  // Sources point to tasks of the plan.
  StackReferences& operator=(const StackReferences&) = delete;

  /// Sets the targets and the sources of the given tasks; all other tasks keep their last target, at rest.
  void set(const Targets& targets, Sources sources);
  /// The references after `seconds` [s] of the tick.
  [[nodiscard]] Reference<Space> ahead(double seconds) const noexcept;
  /// The references of the sources after `seconds` become the targets. Returns all targets.
  const Reference<Space>& take(double seconds) noexcept;
  /// After a tick of dt [s].
  friend void advance_source(StackReferences& references, double dt, Level level, bool stopping,
                             double fraction) noexcept {
    references.advance(dt, level, stopping, fraction);
  }
  friend Reference<Space> joined(Space, double seconds, const StackReferences& references) noexcept {
    return references.ahead(seconds);
  }
  friend double most_path_fraction(const StackReferences& references, double dt) noexcept {
    return references.most_fraction(dt);
  }
  friend void set_source_speed(StackReferences& references, double speed) noexcept {
    for (const auto& [task, source] : references.sources_) {
      std::visit([&](auto* each) { set_source_speed(*each, speed); }, source);
    }
  }
  friend void take_planned_state(const StackReferences& references, State<kDynamic>& planned) noexcept {
    for (const auto& [task, source] : references.sources_) {
      std::visit([&](auto* each) { take_planned_state(*each, planned); }, source);
    }
  }
  friend void look_ahead(StackReferences& references, bool stopping, AnyBounds& bounds, const JointVector& q) noexcept {
    for (const auto& [task, source] : references.sources_) {
      std::visit([&](auto* each) { look_ahead(*each, stopping, bounds, q); }, source);
    }
  }

  /// The new level k is the old level order[k], with its targets. tip: points of the tasks in the new order.
  void reorder(const std::array<int, AnyStack::kLevels>& order, const AnyStack::Point& tip) noexcept;

  [[nodiscard]] const StackPlan& plan() const noexcept { return plan_; }
  /// The plan with the present targets of all tasks.
  [[nodiscard]] StackPlan plan_now() const;

 private:
  void advance(double dt, Level level, bool stopping, double fraction) noexcept;
  [[nodiscard]] double most_fraction(double dt) const noexcept;
  [[nodiscard]] StackTarget target_of(const StackTask& task) const noexcept;

  StackPlan plan_;
  Reference<Space> held_;
  Sources sources_;
};

}  // namespace fpbm::bindings

namespace fpbm {

template <>
inline constexpr bool kMayKeep<bindings::StackReferences> = true;

}  // namespace fpbm
