#pragma once

#include <array>
#include <functional>
#include <memory>

#include "bounds.hpp"
#include "fpbm/any/any_stack.hpp"
#include "fpbm/realtime/detail/stack_tick.hpp"
#include "fpbm/realtime/detail/tick_references.hpp"
#include "fpbm/simulate/rollout.hpp"
#include "scheme.hpp"
#include "stack_path.hpp"

namespace fpbm::bindings {

/// fpbm::stack_tracker() for any robot, tasks, scheme and bounds.
class StackTracker {
 public:
  using Space = AnyStack::Space;
  using Point = AnyStack::Point;
  using Result = Tick<Space, kDynamic>;

  StackTracker() = default;
  StackTracker(const StackTracker&) = delete;
  StackTracker& operator=(const StackTracker&) = delete;
  virtual ~StackTracker() = default;

  virtual Result advance(const TickReferences<Space>& references) noexcept = 0;
  /// Throws std::invalid_argument if the scheme is of velocity level.
  [[nodiscard]] virtual Result resolve_measured(const State<kDynamic>& measured, const Reference<Space>& reference) = 0;

  virtual bool enable(int level, bool on) noexcept = 0;
  virtual bool reorder(const std::array<int, AnyStack::kLevels>& order) noexcept = 0;
  virtual void stop() noexcept = 0;
  virtual void resume() noexcept = 0;

  [[nodiscard]] virtual const State<kDynamic>& state() const noexcept = 0;
  [[nodiscard]] virtual const JointVector& acceleration() const noexcept = 0;
  [[nodiscard]] virtual Point tip() const noexcept = 0;
  [[nodiscard]] virtual double sigma() const noexcept = 0;
  [[nodiscard]] virtual Clearance<kDynamic>& clearance() noexcept = 0;
};

/// The arguments of a tracker of a stack, apart from its scheme.
struct StackStart {
  const Tree<>& tree;
  const AnyStack& stack;
  const State<kDynamic>& start;
  const TrackerOptions<>& options;
  const JointLimits<kDynamic>& limits;
  const JointVector& qdd0;
  const AnyBounds& bounds;
};

/// The tracker. Throws std::invalid_argument as fpbm::stack_tracker() does, and if an objective of the scheme needs
/// a single task.
std::unique_ptr<StackTracker> make_stack_tracker(const Scheme& scheme, const StackStart& from);

/// Recorder of a motion of a stack.
using StackRecorder = std::function<bool(const Sample<AnyStack::Space, kDynamic>&)>;

/// fpbm::rollout() of a stack. Throws std::invalid_argument as make_stack_tracker() does.
RolloutResult<kDynamic> rollout_of_stack(const StackPlan& plan, const StackPath& path, const Scheme& scheme,
                                         const State<kDynamic>& start, const TimeGrid<double>& grid,
                                         const StackRecorder& record);

}  // namespace fpbm::bindings
