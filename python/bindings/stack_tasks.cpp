#include "stack_tasks.hpp"

#include <type_traits>

namespace fpbm::bindings {

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

}  // namespace fpbm::bindings
