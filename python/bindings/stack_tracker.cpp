#include <optional>
#include <type_traits>

#include "fpbm/realtime/stack_tracker.hpp"
#include "stack_path.hpp"
#include "tracker_at.hpp"

namespace fpbm::bindings {
namespace {

/// The law of the first level: with dynamics, or else the law of `Plain`. One type, so that the tracker of a stack is
/// compiled once for each level.
template <typename Plain, typename Law>
struct FirstLaw : Plain {
  std::optional<WithDynamics<Law>> with_dynamics;

  FirstLaw(const Plain& plain, const std::optional<WithDynamics<Law>>& with) : Plain(plain), with_dynamics(with) {}

  [[nodiscard]] bool moves_at_rest() const noexcept {
    return with_dynamics ? fpbm::moves_at_rest(with_dynamics->scheme)
                         : this->null_space.template active<Level::kVelocity>();
  }
  template <int M>
  [[nodiscard]] Status resolve_rows(const TaskEquation<M, kDynamic>& task, const State<kDynamic>& state,
                                    JointVector& u) const noexcept {
    return with_dynamics ? bindings::resolve_rows(with_dynamics->scheme, task, state, u)
                         : Plain::resolve_rows(task, state, u);
  }

  friend void set_damping(FirstLaw& law, const DefaultDamping<>& damping) {
    set_damping(static_cast<Plain&>(law), damping);
    if (law.with_dynamics) set_damping(*law.with_dynamics, damping);
  }
};

/// Calls f with the scheme as a type of the library, for joints with the given limits.
template <typename F>
auto with_law(const Scheme& scheme, const JointLimits<kDynamic>& limits, F&& f) {
  if (scheme.manipulability_gain != 0.0) {
    validation::reject("manipulability_gain", " needs a single task: must not be given with a stack");
  }
  const AnyWeights W = any_weights(scheme, limits.lower.size());
  const auto at = [&](auto level) {
    constexpr Level kLevel = decltype(level)::value;
    const auto plain = scheme.law<kLevel>(W, limits);
    std::optional<decltype(scheme.law_with_dynamics<kLevel>(limits))> with;
    if (scheme.uses_dynamics) with = scheme.law_with_dynamics<kLevel>(limits);
    using Law = FirstLaw<std::decay_t<decltype(plain)>, decltype(with->scheme)>;
    return f(ByLevels<Law, AnyStack>(Law(plain, with)));
  };
  return scheme.level == Level::kVelocity ? at(std::integral_constant<Level, Level::kVelocity>{})
                                          : at(std::integral_constant<Level, Level::kAcceleration>{});
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
