#pragma once

#include <type_traits>
#include <utility>

namespace fpbm {

/// Coordinate of its Space that row i of a task selects: the only entry of row i of S that is not 0. -1 if the row
/// mixes coordinates. Tasks with such rows may have a function coordinate(i), which saves the product of S and J.
template <typename Task, typename = void>
struct CoordinateOf {
  [[nodiscard]] static constexpr int row([[maybe_unused]] const Task& task, int i) noexcept {
    return Task::kWhole ? i : -1;
  }
};
template <typename Task>
struct CoordinateOf<Task, std::void_t<decltype(std::declval<const Task&>().coordinate(0))>> {
  [[nodiscard]] static constexpr int row(const Task& task, int i) noexcept { return task.coordinate(i); }
};

}  // namespace fpbm
