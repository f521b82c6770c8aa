#pragma once

#include <array>
#include <memory>
#include <type_traits>
#include <utility>

#include "bounds.hpp"
#include "fpbm/any/any_stack.hpp"
#include "fpbm/any/detail/any_path.hpp"
#include "fpbm/path/path_follower.hpp"
#include "fpbm/realtime/detail/reference_sources.hpp"
#include "fpbm/realtime/detail/stack_tick.hpp"
#include "fpbm/realtime/detail/tick_references.hpp"
#include "fpbm/realtime/tick.hpp"
#include "fpbm/target/target_filter.hpp"
#include "scheme.hpp"
#include "stack_tasks.hpp"

namespace fpbm::bindings {

template <typename Space>
using AnyFollower = PathFollower<AnyPath<Space>>;

/// The arm of a tracker of tasks in Space.
template <typename Space>
struct TrackedArm {
  using type = AnyArmFor<Space>;
};
template <>
struct TrackedArm<AnyStack::Space> {
  using type = StackArm;
};

/// fpbm::Tracker of a task in Space, or of a stack of tasks, for any arm, scheme and bounds.
template <typename Space_>
class AnyTracker {
 public:
  static constexpr int N = kDynamic;
  using Space = Space_;
  using Point = typename Space::template Point<double>;
  using Result = Tick<Space, kDynamic>;

  AnyTracker(double dt, Level level) : dt_(dt), level_(level) {}
  AnyTracker(const AnyTracker&) = delete;
  AnyTracker& operator=(const AnyTracker&) = delete;
  virtual ~AnyTracker() = default;

  /// One tick with a source of references: a Reference, a path, a filter, or StackReferences.
  template <typename Source>
  Result tick(Source&& source) noexcept {
    set_source_speed(source, speed_);
    look_ahead(source, stopping_, bounds(), state().q);
    if (level_ == Level::kAcceleration) {
      State<kDynamic> planned = state();
      take_planned_state(source, planned);
      approach(planned);
    }
    const auto references = references_of(Space{}, dt_, source);
    Result result;
    if constexpr (kOfPath<std::decay_t<decltype(references)>>) {
      result = advance(references);
    } else {
      result = advance({references, 0.0});
    }
    advance_source(source, dt_, level_, stopping_, result.path_fraction);
    return result;
  }
  virtual Result advance(const PathReferences<Space>& references) noexcept = 0;
  virtual void approach(const State<kDynamic>& planned) noexcept = 0;
  /// Throws std::invalid_argument if the scheme is of velocity level.
  [[nodiscard]] virtual Result resolve_measured(const State<kDynamic>& measured, const Reference<Space>& reference) = 0;

  /// Levels of a stack. For a single task, the result is false, without an effect.
  virtual bool enable(int level, bool on) noexcept = 0;
  virtual bool reorder(const std::array<int, AnyStack::kLevels>& order) noexcept = 0;
  /// Sets the speed of the sources of the following ticks. Returns false without an effect if the fraction is not in
  /// (0, 1].
  bool set_speed(double fraction) noexcept {
    const bool good = fraction > 0.0 && fraction <= 1.0;
    if (good) speed_ = fraction;
    return good;
  }
  virtual void stop() noexcept = 0;
  virtual void resume() noexcept = 0;

  [[nodiscard]] virtual const typename TrackedArm<Space>::type& arm() const noexcept = 0;
  [[nodiscard]] virtual const State<kDynamic>& state() const noexcept = 0;
  [[nodiscard]] virtual const JointVector& acceleration() const noexcept = 0;
  [[nodiscard]] virtual const JointVector& acceleration_change() const noexcept = 0;
  [[nodiscard]] virtual Point tip() const noexcept = 0;
  [[nodiscard]] virtual double sigma() const noexcept = 0;
  [[nodiscard]] virtual AnyBounds& bounds() noexcept = 0;

  // A tick whose step is made in lanes (LaneTracker).
  virtual bool begin(const Vector<Space::kRows>& error, double length) noexcept = 0;
  [[nodiscard]] virtual Reference<Space> corrected(const Reference<Space>& reference) const noexcept = 0;
  virtual Status finish(const Reference<Space>& now, const TickReferences<Space>& references,
                        const JointVector& u) noexcept = 0;

 protected:
  double dt_;
  Level level_;
  double speed_ = 0.0;  ///< Fraction of set_speed(); 0: each source has its own speed.
  bool stopping_ = false;
};

/// A tracker for code in lanes (TrackerBatch): an AnyTracker with a number of joints that is known at compile time. The
/// functions of the AnyTracker are compiled once for all kinds of processors.
template <typename Space, int N>
class LaneTracker {
  using Any = AnyTracker<Space>;

 public:
  /// continuous: bits of the continuous joints.
  LaneTracker(std::unique_ptr<Any> any, JointBits continuous) : continuous_(continuous), any_(std::move(any)) {}

  [[nodiscard]] JointBits continuous() const noexcept { return continuous_; }

  [[nodiscard]] typename Any::Point tip() const noexcept { return any_->tip(); }
  [[nodiscard]] State<N> state() const noexcept { return {any_->state().q, any_->state().qd}; }
  [[nodiscard]] Vector<N> acceleration() const noexcept { return any_->acceleration(); }
  [[nodiscard]] Vector<N> acceleration_change() const noexcept { return any_->acceleration_change(); }
  bool begin(const Vector<Space::kRows>& error, double length) noexcept { return any_->begin(error, length); }
  [[nodiscard]] Reference<Space> corrected(const Reference<Space>& reference) const noexcept {
    return any_->corrected(reference);
  }
  Status finish(const Reference<Space>& now, const TickReferences<Space>& references, const Vector<N>& u) noexcept {
    return any_->finish(now, references, u);
  }
  typename Any::Result advance(const TickReferences<Space>& references) noexcept {
    return any_->advance({references, 0.0});
  }

 private:
  JointBits continuous_;
  std::unique_ptr<Any> any_;
};

/// The arguments of a tracker, apart from its arm and scheme.
struct TrackerStart {
  const State<kDynamic>& start;
  const TrackerOptions<>& options;
  const JointLimits<kDynamic>& limits;
  const JointVector& qdd0;
  const AnyBounds& bounds;
};

/// The tracker. Throws std::invalid_argument if scheme, start, options, limits or bounds do not fit, as fpbm::Tracker
/// and fpbm::stack_tracker() do. Compiled once, in tracker.cpp and stack_tracker.cpp.
template <typename Space>
std::unique_ptr<AnyTracker<Space>> make_tracker(const typename TrackedArm<Space>::type& arm, const Scheme& scheme,
                                                const TrackerStart& from);

}  // namespace fpbm::bindings
