#include "stack_references.hpp"

#include <algorithm>
#include <type_traits>

#include "stack_path.hpp"

namespace fpbm::bindings {
namespace {

void put_sources(const StackReferences::Sources& sources, double seconds,
                 Reference<StackReferences::Space>& to) noexcept {
  for (const auto& [task, source] : sources) {
    std::visit([&, own = task](const auto* each) noexcept { own->put(target_at(each->ahead(seconds)), to); }, source);
  }
}

}  // namespace

StackReferences::StackReferences(const StackPlan& plan, const AnyStack::Point& tip)
    : plan_(plan), held_(Reference<Space>::hold(tip)) {
  for (std::size_t i = 0; i < plan_.tasks.size(); ++i) {
    if (plan_.targets[i]) plan_.tasks[i].put(*plan_.targets[i], held_);
  }
}

void StackReferences::set(const Targets& targets, Sources sources) {
  held_ = Reference<Space>::hold(held_.x);
  for (const auto& [task, target] : targets) task->put(target, held_);
  sources_ = std::move(sources);
}

Reference<StackReferences::Space> StackReferences::ahead(double seconds) const noexcept {
  Reference<Space> references = fpbm::ahead(held_, seconds);
  put_sources(sources_, seconds, references);
  return references;
}

const Reference<StackReferences::Space>& StackReferences::take(double seconds) noexcept {
  put_sources(sources_, seconds, held_);
  return held_;
}

void StackReferences::advance(double dt, bool stopping) noexcept {
  take(dt);
  for (const auto& [task, source] : sources_) {
    std::visit([&](auto* each) { advance_source(*each, dt, stopping); }, source);
  }
}

StackTarget StackReferences::target_of(const StackTask& task) const noexcept {
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

void StackReferences::reorder(const std::array<int, AnyStack::kLevels>& order, const AnyStack::Point& tip) noexcept {
  constexpr int kPlaces = AnyStack::kTasks / AnyStack::kLevels;
  Reference<Space> held = Reference<Space>::hold(tip);
  for (StackTask& task : plan_.tasks) {
    const StackTarget target = target_of(task);
    const auto level = std::find(order.begin(), order.end(), task.index / kPlaces) - order.begin();
    task.index = static_cast<int>(level) * kPlaces + task.index % kPlaces;
    task.put(target, held);
  }
  held_ = held;
}

}  // namespace fpbm::bindings
