#include <type_traits>

#include "fpbm/realtime/stack_tracker.hpp"
#include "stack_path.hpp"
#include "tracker_at.hpp"

namespace fpbm::bindings {
namespace {

/// Calls f with the scheme as a type of the library, for joints with the given limits.
template <typename F>
auto with_law(const Scheme& scheme, const JointLimits<kDynamic>& limits, F&& f) {
  if (!scheme.is_plain()) {
    validation::reject("manipulability_gain", " needs a single task: must not be given with a stack");
  }
  const AnyWeights W = any_weights(scheme, limits.lower.size());
  const auto by_levels = [&f](const auto& law) { return f(ByLevels<std::decay_t<decltype(law)>, AnyStack>(law)); };
  return scheme.level == Level::kVelocity ? by_levels(scheme.law<Level::kVelocity>(W, limits))
                                          : by_levels(scheme.law<Level::kAcceleration>(W, limits));
}

}  // namespace

template <>
std::unique_ptr<AnyTracker<AnyStack::Space>> make_tracker<AnyStack::Space>(const StackArm& arm, const Scheme& scheme,
                                                                           const TrackerStart& from) {
  return with_law(scheme, from.limits, [&](const auto& law) -> std::unique_ptr<AnyTracker<AnyStack::Space>> {
    require_stack_gains(law.scheme, arm.stack(), TickOfGains<double>{from.options.dt, from.options.integral_gain});
    return std::make_unique<TrackerAt<std::decay_t<decltype(law)>, AnyStack::Space>>(arm, law, from);
  });
}

RolloutResult<kDynamic> rollout_of_stack(const StackPlan& plan, const StackPath& path, const Scheme& scheme,
                                         const State<kDynamic>& start, const TimeGrid<double>& grid,
                                         const StackRecorder& record) {
  const StackArm tasks = plan.arm_at(scheme.level);
  return with_law(scheme, tasks.limits(), [&](const auto& law) {
    require_stack_gains(law.scheme, tasks.stack(), TickOfGains<double>{grid.dt(), 0.0});
    return rollout(tasks, path, law, start, grid, record);
  });
}

}  // namespace fpbm::bindings
