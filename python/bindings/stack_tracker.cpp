#include "stack_tracker.hpp"

#include <stdexcept>
#include <type_traits>

#include "fpbm/realtime/stack_tracker.hpp"

namespace fpbm::bindings {
namespace {

/// StackTracker under a scheme of the library.
template <typename Scheme_>
class StackTrackerOf final : public StackTracker {
  static constexpr Level kLevel = Scheme_::kLevel;

 public:
  StackTrackerOf(const Scheme_& scheme, const StackStart& from)
      : tracker_(stack_tracker(Robot<kDynamic>(from.tree), from.stack, scheme, from.start, from.options,
                               Limits<kLevel, kDynamic>(from.limits, from.options.dt), from.qdd0, from.bounds)) {}

  Result advance(const TickReferences<Space>& references) noexcept override { return tracker_.advance(references); }
  [[nodiscard]] Result resolve_measured(const State<kDynamic>& measured, const Reference<Space>& reference) override {
    if constexpr (kLevel == Level::kAcceleration) {
      return tracker_.resolve_measured(measured.q, measured.qd, reference);
    } else {
      throw std::invalid_argument("resolve_measured: the scheme is at velocity level: must be at acceleration level");
    }
  }

  bool enable(int level, bool on) noexcept override { return tracker_.enable(level, on); }
  bool reorder(const std::array<int, AnyStack::kLevels>& order) noexcept override { return tracker_.reorder(order); }
  void stop() noexcept override { tracker_.stop(); }
  void resume() noexcept override { tracker_.resume(); }

  [[nodiscard]] const State<kDynamic>& state() const noexcept override { return tracker_.state(); }
  [[nodiscard]] const JointVector& acceleration() const noexcept override { return tracker_.acceleration(); }
  [[nodiscard]] Point tip() const noexcept override { return tracker_.tip(); }
  [[nodiscard]] double sigma() const noexcept override { return tracker_.sigma(); }
  [[nodiscard]] Clearance<kDynamic>& clearance() noexcept override { return tracker_.bounds().clearance(); }

 private:
  Tracker<RobotTasks<Robot<kDynamic>, AnyStack>, Space, ByLevels<Scheme_, AnyStack>, AnyBounds> tracker_;
};

/// Calls f with the scheme as a type of the library, for joints with the given limits.
template <typename F>
auto with_law(const Scheme& scheme, const JointLimits<kDynamic>& limits, F&& f) {
  if (!scheme.is_plain()) {
    validation::reject("manipulability_gain", " needs a single task: must not be given with a stack");
  }
  const AnyWeights W = any_weights(scheme, limits.lower.size());
  return scheme.level == Level::kVelocity ? f(scheme.law<Level::kVelocity>(W, limits))
                                          : f(scheme.law<Level::kAcceleration>(W, limits));
}

}  // namespace

std::unique_ptr<StackTracker> make_stack_tracker(const Scheme& scheme, const StackStart& from) {
  return with_law(scheme, from.limits, [&](const auto& law) -> std::unique_ptr<StackTracker> {
    return std::make_unique<StackTrackerOf<std::decay_t<decltype(law)>>>(law, from);
  });
}

RolloutResult<kDynamic> rollout_of_stack(const StackPlan& plan, const StackPath& path, const Scheme& scheme,
                                         const State<kDynamic>& start, const TimeGrid<double>& grid,
                                         const StackRecorder& record) {
  const Robot<kDynamic> robot(plan.tree);
  return with_law(scheme, robot.limits(), [&](const auto& law) {
    const AnyStack& stack = plan.at(scheme.level);
    require_stack_gains(law, stack, TickOfGains<double>{grid.dt(), 0.0});
    const RobotTasks<Robot<kDynamic>, AnyStack> tasks(robot, stack);
    return rollout(tasks, path, ByLevels<std::decay_t<decltype(law)>, AnyStack>(law), start, grid, record);
  });
}

}  // namespace fpbm::bindings
