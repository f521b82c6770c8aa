#pragma once

#include <type_traits>
#include <utility>

#include "fpbm/geometry/detail/product_space.hpp"

namespace fpbm {
namespace task_check {

template <typename Task, typename = void>
inline constexpr bool kHasScalar = false;
template <typename Task>
inline constexpr bool kHasScalar<Task, std::void_t<typename Task::Scalar>> = true;

template <typename Task, typename = void>
inline constexpr bool kHasSpace = false;
template <typename Task>
inline constexpr bool kHasSpace<Task, std::void_t<typename Task::Space>> = true;

template <typename Task, typename = void>
inline constexpr bool kHasRows = false;
template <typename Task>
inline constexpr bool kHasRows<Task, std::void_t<decltype(int{Task::kRows})>> = true;

template <typename Task, typename = void>
inline constexpr bool kHasWhole = false;
template <typename Task>
inline constexpr bool kHasWhole<Task, std::void_t<decltype(bool{Task::kWhole})>> = true;

template <typename Task, typename = void>
inline constexpr bool kHasGains = false;
template <typename Task>
inline constexpr bool kHasGains<Task, std::void_t<decltype(std::declval<const Task&>().gains.k1)>> = true;

template <typename Task, typename Robot, typename = void>
inline constexpr bool kHasBind = false;
template <typename Task, typename Robot>
inline constexpr bool
    kHasBind<Task, Robot, std::void_t<decltype(std::declval<Task&>().bind(std::declval<const Robot&>()))>> = true;

}  // namespace task_check

/// States in one sentence which member a task type lacks. docs/tasks.md (Custom task types) lists the members.
template <typename Task>
struct TaskCheck {
  static_assert(task_check::kHasScalar<Task>, "a task needs `using Scalar = double` or another scalar type");
  static_assert(task_check::kHasSpace<Task>, "a task needs `using Space`, the space of its points and errors");
  static_assert(task_check::kHasRows<Task>, "a task needs `static constexpr int kRows`, its number of rows");
  static_assert(task_check::kHasWhole<Task>, "a task needs `static constexpr bool kWhole`: whether S is diagonal");
  static_assert(task_check::kHasGains<Task>, "a task needs `fpbm::TaskGains<> gains`");
};

}  // namespace fpbm
