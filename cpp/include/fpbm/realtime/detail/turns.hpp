#pragma once

#include <tuple>
#include <type_traits>
#include <utility>

#include "fpbm/model/detail/continuous_joints.hpp"
#include "fpbm/task/stack.hpp"

namespace fpbm {

/// Whether an arm is a robot with a stack of tasks.
template <typename Arm, typename = void>
inline constexpr bool kHasStack = false;
template <typename Arm>
inline constexpr bool kHasStack<Arm, std::void_t<decltype(std::declval<const Arm&>().stack().tasks())>> = true;

/// Moves the references of continuous joints by whole turns, so that the first reference is the nearest to the present
/// position. All references move by the same turns. arm: robot with a stack of tasks. tip: present points of the tasks.
/// continuous: bits of the continuous joints.
template <typename Arm, typename Point, typename References>
void remove_turns([[maybe_unused]] const Arm& arm, [[maybe_unused]] const Point& tip,
                  [[maybe_unused]] JointBits continuous, [[maybe_unused]] References& references) noexcept {
  if constexpr (kHasStack<Arm>) {
    if (continuous == 0) return;
    arm.stack().each([&](const auto& task, auto i) noexcept {
      if constexpr (kIsPosture<std::decay_t<decltype(task)>>) {
        constexpr auto kIndex = static_cast<std::size_t>(decltype(i)::value);
        for (int row = 0; row < rows_of(task); ++row) {
          if ((continuous >> task.joint(row) & 1U) == 0) continue;
          const auto now = std::get<kIndex>(references[0].x).coeff(row);
          const auto turns = whole_turns(decltype(now)(std::get<kIndex>(tip).coeff(row) - now));
          if (turns == 0) continue;
          for (auto& reference : references) std::get<kIndex>(reference.x).coeffRef(row) += turns;
        }
      }
    });
  }
}

}  // namespace fpbm
