#pragma once

#include <array>
#include <tuple>
#include <type_traits>
#include <utility>

#include "fpbm/core/detail/validation.hpp"
#include "fpbm/geometry/detail/product_space.hpp"
#include "fpbm/task/detail/task_check.hpp"

namespace fpbm {

/// Tasks on one level, with equal priority.
template <typename... Tasks>
struct TaskLevel {
  static_assert((require_task_members<Tasks>() && ...));
  static constexpr int kRows = ((Tasks::kRows == Eigen::Dynamic) || ...) ? Eigen::Dynamic : (Tasks::kRows + ...);
  std::tuple<Tasks...> tasks;

  explicit TaskLevel(const Tasks&... tasks_) : tasks(tasks_...) {}
};

namespace stack_detail {

template <typename Task>
struct AsLevel {
  using type = TaskLevel<Task>;
};
template <typename... Tasks>
struct AsLevel<TaskLevel<Tasks...>> {
  using type = TaskLevel<Tasks...>;
};

template <typename Tuple>
inline constexpr int kSize = static_cast<int>(std::tuple_size_v<Tuple>);

template <typename Task>
[[nodiscard]] std::tuple<Task> tasks_of(const Task& task) {
  return std::tuple<Task>(task);
}
template <typename... Tasks>
[[nodiscard]] const std::tuple<Tasks...>& tasks_of(const TaskLevel<Tasks...>& level) noexcept {
  return level.tasks;
}

template <typename... Levels>
using TasksOf = decltype(std::tuple_cat(std::declval<Levels>().tasks...));

template <int First, typename Tuple>
struct SpaceOf;
template <int First, typename... Tasks>
struct SpaceOf<First, std::tuple<Tasks...>> {
  using type = ProductSpace<First, typename Tasks::Space...>;
};

}  // namespace stack_detail

/// Task space of a stack: points of all tasks, in the order of the levels.
template <typename First, typename... Lower>
struct StackSpace
    : stack_detail::SpaceOf<stack_detail::kSize<decltype(First::tasks)>, stack_detail::TasksOf<First, Lower...>>::type {
};

template <typename... Levels>
inline constexpr int kLevelsOf<StackSpace<Levels...>> = static_cast<int>(sizeof...(Levels));

/// Tasks on levels in strict priority. In Stack(TaskLevel(a, b), c), a and b have equal priority, and c has a lower
/// priority. A level with one task needs no TaskLevel.
///
/// Lower levels may be disabled from tick to tick, and levels of one type may be reordered. The numbers of levels and
/// tasks are known at compile time.
template <typename... Levels>
class Stack {
 public:
  static constexpr int kLevels = static_cast<int>(sizeof...(Levels));
  using Tasks = stack_detail::TasksOf<Levels...>;
  static constexpr int kTasks = stack_detail::kSize<Tasks>;
  using Scalar = typename std::tuple_element_t<0, Tasks>::Scalar;
  using Space = StackSpace<Levels...>;
  using Point = typename Space::template Point<Scalar>;

  template <typename... Given, typename = std::enable_if_t<(!std::is_same_v<Given, Stack> && ...)>>
  explicit Stack(const Given&... levels) : tasks_(std::tuple_cat(stack_detail::tasks_of(levels)...)) {}

  [[nodiscard]] const Tasks& tasks() const noexcept { return tasks_; }

  /// Number of rows of each level, or Eigen::Dynamic.
  static constexpr std::array<int, kLevels> kRows{Levels::kRows...};

  /// Level of task i.
  [[nodiscard]] static constexpr int level(int i) noexcept {
    constexpr std::array<int, kLevels> kCounts{stack_detail::kSize<decltype(Levels::tasks)>...};
    int k = 0;
    while (i >= kCounts[static_cast<std::size_t>(k)]) i -= kCounts[static_cast<std::size_t>(k++)];
    return k;
  }
  /// Number of rows of level k.
  [[nodiscard]] int rows(int k) const noexcept {
    int rows = 0;
    each([&](const auto& task, auto i) noexcept { rows += level(decltype(i)::value) == k ? rows_of(task) : 0; });
    return rows;
  }

  /// Number of tasks that have rows.
  [[nodiscard]] int count() const noexcept {
    return std::apply([](const auto&... task) { return ((rows_of(task) > 0 ? 1 : 0) + ...); }, tasks());
  }

  /// Enables or disables level k, counted from 0. The first level is always enabled. Returns false if k is not a lower
  /// level.
  bool enable(int k, bool on) noexcept {
    if (k < 1 || k >= kLevels) return false;
    enabled_[static_cast<std::size_t>(k)] = on;
    return true;
  }
  [[nodiscard]] const std::array<bool, kLevels>& enabled() const noexcept { return enabled_; }

  /// Reorders levels of one type, for example of an AnyStack: the previous level order[k] becomes level k. Returns
  /// false, without effect, unless `order` has each level once, and its first level is enabled and has a task.
  bool reorder(const std::array<int, kLevels>& order) noexcept {
    static_assert((std::is_same_v<Levels, std::tuple_element_t<0, std::tuple<Levels...>>> && ...),
                  "only levels of one type can be reordered");
    std::array<bool, kLevels> seen{};
    for (const int k : order) {
      if (k < 0 || k >= kLevels || std::exchange(seen[static_cast<std::size_t>(k)], true)) return false;
    }
    if (rows(order[0]) == 0 || !enabled_[static_cast<std::size_t>(order[0])]) return false;
    const Stack before = *this;
    constexpr int kEach = kTasks / kLevels;
    each_mutable([&](auto& task, auto to) noexcept {
      constexpr int kTo = decltype(to)::value;
      before.each([&](const auto& from, auto i) noexcept {
        if constexpr (decltype(i)::value % kEach == kTo % kEach) {
          if (level(decltype(i)::value) == order[static_cast<std::size_t>(level(kTo))]) task = from;
        }
      });
    });
    for (std::size_t k = 0; k < order.size(); ++k) {
      enabled_[k] = before.enabled_[static_cast<std::size_t>(order[k])];
    }
    return true;
  }

  /// Binds the tasks to a robot. Throws std::invalid_argument if a task does not suit the robot, a level has more rows
  /// than the robot has joints, or the first level has no rows.
  template <typename Robot>
  void bind(const Robot& robot) {
    if (rows(0) == 0) validation::reject("stack", ": the first level has no task: must have one");
    for (int k = 0; k < kLevels; ++k) {
      if (rows(k) > robot.dof()) {
        validation::fail(validation::element("rows of level", k), rows(k), "at most ", robot.dof(),
                         ", the number of joints: move a task to another level");
      }
    }
    std::apply(
        [&](auto&... task) {
          static_assert((kHas<std::decay_t<decltype(task)>, task_member::Bind, Robot> && ...),
                        "a task needs `template <typename Robot> void bind(const Robot& robot)`");
          (task.bind(robot), ...);
        },
        tasks_);
  }

  /// Calls f(task, i) for each task, where i is its index as a std::integral_constant.
  template <typename F>
  void each(F&& f) const noexcept {
    each(f, std::make_index_sequence<kTasks>{});
  }

 private:
  template <typename F, std::size_t... i>
  void each_mutable(F& f, std::index_sequence<i...>) noexcept {
    (f(std::get<i>(tasks_), std::integral_constant<int, static_cast<int>(i)>{}), ...);
  }
  template <typename F>
  void each_mutable(F&& f) noexcept {
    each_mutable(f, std::make_index_sequence<kTasks>{});
  }
  template <typename F, std::size_t... i>
  void each(F& f, std::index_sequence<i...>) const noexcept {
    (f(std::get<i>(tasks_), std::integral_constant<int, static_cast<int>(i)>{}), ...);
  }

  [[nodiscard]] static constexpr std::array<bool, kLevels> all() noexcept { return {(Levels::kRows != 0)...}; }

  Tasks tasks_;
  std::array<bool, kLevels> enabled_ = all();
};

template <typename... Levels>
Stack(const Levels&...) -> Stack<typename stack_detail::AsLevel<Levels>::type...>;

}  // namespace fpbm
