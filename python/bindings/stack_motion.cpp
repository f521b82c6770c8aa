#include "stack_motion.hpp"

#include <algorithm>
#include <type_traits>

#include "fpbm/realtime/detail/reference_sources.hpp"

namespace fpbm::bindings {

StackMotion::StackMotion(const StackPlan& plan, const Scheme& scheme, const State<kDynamic>& start,
                         const TrackerOptions<>& options, const JointLimits<kDynamic>& limits, const JointVector& qdd0,
                         const AnyBounds& bounds)
    : plan_(plan),
      dt_(options.dt),
      tracker_(make_stack_tracker(scheme, {plan_.tree, plan_.at(scheme.level), start, options, limits, qdd0, bounds})),
      held_(Reference<Space>::hold(tracker_->tip())) {
  for (std::size_t i = 0; i < plan_.tasks.size(); ++i) {
    if (plan_.targets[i]) plan_.tasks[i].put(*plan_.targets[i], held_);
  }
}

void StackMotion::put(const StackTask& task, const Source& source, double seconds,
                      Reference<Space>& to) const noexcept {
  std::visit([&](const auto* each) noexcept { task.put(target_at(each->ahead(seconds)), to); }, source);
}

void StackMotion::aim(const Targets& targets) noexcept {
  held_ = Reference<Space>::hold(held_.x);
  for (const auto& [task, target] : targets) task->put(target, held_);
}

StackMotion::Result StackMotion::tick(const Sources& sources) noexcept {
  TickReferences<Space> stages = TickReferences<Space>::of([&](double t) noexcept { return ahead(held_, t); }, dt_);
  for (std::size_t i = 0; i < stages.stages.size(); ++i) {
    for (const auto& [task, source] : sources) put(*task, source, dt_ / 2 * static_cast<double>(i), stages.stages[i]);
  }
  const Result result = tracker_->advance(stages);
  for (const auto& [task, source] : sources) {
    put(*task, source, dt_, held_);
    std::visit([&](auto* each) { advance_source(*each, dt_, stopping_); }, source);
  }
  return result;
}

StackMotion::Result StackMotion::resolve_measured(const State<kDynamic>& measured, const Sources& sources) {
  for (const auto& [task, source] : sources) put(*task, source, 0.0, held_);
  return tracker_->resolve_measured(measured, held_);
}

StackTarget StackMotion::target_of(const StackTask& task) const noexcept {
  StackTarget target{{}, JointVector::Zero(task.size), JointVector::Zero(task.size), JointVector::Zero(task.size)};
  task.at_place([&](auto space, auto i, int row) noexcept {
    for (int j = 0; j < task.size; ++j) {
      target.xd(j) = held_.xd(row + task.shift() + j);
      target.xdd(j) = held_.xdd(row + task.shift() + j);
    }
    if constexpr (std::is_same_v<decltype(space), FrameSpace>) {
      target.at = std::get<decltype(i)::value>(held_.x).at;
    } else {
      for (int j = 0; j < task.size; ++j) target.q(j) = std::get<decltype(i)::value>(held_.x)(j);
    }
  });
  return target;
}

bool StackMotion::reorder(const std::array<int, AnyStack::kLevels>& order) noexcept {
  if (!tracker_->reorder(order)) return false;
  constexpr int kPlaces = AnyStack::kTasks / AnyStack::kLevels;
  Reference<Space> held = Reference<Space>::hold(tracker_->tip());
  for (StackTask& task : plan_.tasks) {
    const StackTarget target = target_of(task);
    const auto level = std::find(order.begin(), order.end(), task.index / kPlaces) - order.begin();
    task.index = static_cast<int>(level) * kPlaces + task.index % kPlaces;
    task.put(target, held);
  }
  held_ = held;
  return true;
}

void StackMotion::stop() noexcept {
  stopping_ = true;
  tracker_->stop();
}

void StackMotion::resume() noexcept {
  stopping_ = false;
  tracker_->resume();
}

}  // namespace fpbm::bindings
