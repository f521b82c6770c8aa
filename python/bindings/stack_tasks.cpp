#include "stack_tasks.hpp"

#include <algorithm>
#include <type_traits>

#include "stack_path.hpp"
#include "stack_references.hpp"

namespace fpbm::bindings {
namespace {

void put_sources(const StackReferences::Sources& sources, double seconds,
                 Reference<StackReferences::Space>& to) noexcept {
  for (const auto& [task, source] : sources) {
    std::visit([&, own = task](const auto* each) noexcept { own->put(target_at(each->ahead(seconds)), to); }, source);
  }
}

}  // namespace

void StackTask::put(const StackTarget& target, Reference<Space>& to) const noexcept {
  at_place([&](auto space, auto i, int row) noexcept {
    if constexpr (std::is_same_v<decltype(space), FrameSpace>) {
      std::get<decltype(i)::value>(to.x).at = target.at;
    } else {
      for (int j = 0; j < size; ++j) std::get<decltype(i)::value>(to.x)(j) = target.q(j);
    }
    for (int j = 0; j < size; ++j) {
      to.xd(row + shift() + j) = target.xd(j);
      to.xdd(row + shift() + j) = target.xdd(j);
    }
  });
}

Transform<> StackTask::frame_of(const AnyStack::Point& point) const noexcept {
  Transform<> at;
  at_place([&](auto space, auto i, int) noexcept {
    if constexpr (std::is_same_v<decltype(space), FrameSpace>) at = std::get<decltype(i)::value>(point).at;
  });
  return at;
}

JointVector StackTask::posture_of(const AnyStack::Point& point) const noexcept {
  JointVector q(size);
  at_place([&](auto space, auto i, int) noexcept {
    if constexpr (!std::is_same_v<decltype(space), FrameSpace>) {
      for (int j = 0; j < size; ++j) q(j) = std::get<decltype(i)::value>(point)(j);
    }
  });
  return q;
}

JointVector StackTask::error_of(const Vector<Space::kRows>& error) const noexcept {
  JointVector own(size);
  at_place([&](auto, auto, int row) noexcept {
    for (int j = 0; j < size; ++j) own(j) = error(row + shift() + j);
  });
  return own;
}

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

void StackReferences::advance(double dt, Level level, bool stopping, double fraction) noexcept {
  for (const auto& [task, source] : sources_) {
    std::visit([&](auto* each) { advance_source(*each, dt, level, stopping, fraction); }, source);
  }
  take(0.0);
}

double StackReferences::most_fraction(double dt) const noexcept {
  double most = 0.0;
  for (const auto& [task, source] : sources_) {
    most = std::max(most, std::visit([&](auto* each) { return most_path_fraction(*each, dt); }, source));
  }
  return most;
}

StackPlan StackReferences::plan_now() const {
  StackPlan now = plan_;
  for (std::size_t i = 0; i < now.tasks.size(); ++i) now.targets[i] = target_of(now.tasks[i]);
  return now;
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
