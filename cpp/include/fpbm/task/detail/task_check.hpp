#pragma once

#include <Eigen/Core>

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

/// Number of rows of a task, which may be known at run time (Task::kRows = Eigen::Dynamic).
template <typename Task>
[[nodiscard]] constexpr int rows_of([[maybe_unused]] const Task& task) noexcept {
  if constexpr (Task::kRows == Eigen::Dynamic) {
    return task.rows();
  } else {
    return Task::kRows;
  }
}

/// Whether a task has positions of joints: whether it names the joint of each row.
template <typename Task, typename = void>
inline constexpr bool kIsPosture = false;
template <typename Task>
inline constexpr bool kIsPosture<Task, std::void_t<decltype(std::declval<const Task&>().joint(0))>> = true;

}  // namespace fpbm
