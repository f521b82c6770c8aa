#pragma once

#include "fpbm/core/detail/has_member.hpp"

namespace fpbm {
namespace task_member {

template <typename Task>
using ScalarOf = typename Task::Scalar;
template <typename Task>
using SpaceOf = typename Task::Space;
template <typename Task>
using Rows = decltype(int{Task::kRows});
template <typename Task>
using Whole = decltype(bool{Task::kWhole});
template <typename Task>
using Gains = decltype(std::declval<const Task&>().gains.k1);
template <typename Task, typename Robot>
using Bind = decltype(std::declval<Task&>().bind(std::declval<const Robot&>()));

}  // namespace task_member

/// The members of every task (docs/tasks.md, Custom task types). If a member is missing, the compiler prints a message.
/// Always true.
template <typename Task>
[[nodiscard]] constexpr bool require_task_members() noexcept {
  static_assert(kHas<Task, task_member::ScalarOf>, "a task needs `using Scalar = double` or another scalar type");
  static_assert(kHas<Task, task_member::SpaceOf>, "a task needs `using Space`, the space of its points and errors");
  static_assert(kHas<Task, task_member::Rows>, "a task needs `static constexpr int kRows`, its number of rows");
  static_assert(kHas<Task, task_member::Whole>, "a task needs `static constexpr bool kWhole`: whether S is diagonal");
  static_assert(kHas<Task, task_member::Gains>, "a task needs `fpbm::TaskGains<> gains`");
  return true;
}

}  // namespace fpbm
