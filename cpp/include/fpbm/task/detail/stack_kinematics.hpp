#pragma once

#include <array>
#include <tuple>
#include <type_traits>

#include "fpbm/linalg/detail/product.hpp"
#include "fpbm/linalg/detail/sums.hpp"
#include "fpbm/model/kinematics.hpp"
#include "fpbm/task/detail/task_rows.hpp"
#include "fpbm/task/detail/tick_feedback.hpp"
#include "fpbm/task/posture_task.hpp"
#include "fpbm/task/stack.hpp"

namespace fpbm {

/// State of a task in addition to its rows: its feedback, its selection S in metres, and its velocity J qd in the rows
/// of its space.
template <typename Task>
struct TaskState {
  using Scalar = typename Task::Scalar;
  TickFeedback<Scalar> feedback;
  Matrix<Task::kRows, Task::Space::kRows, Scalar> S;
  Vector<Task::Space::kRows, Scalar> xd;  ///< If kWhole, only the first S.rows() entries are set.

  TaskState() noexcept {}  // NOLINT(modernize-use-equals-default): as LevelRows.
};

namespace stack_detail {

/// Type of the rows of a lower level.
template <int N, typename Scalar, typename Level>
struct LowerRowsOf {
  using type = LevelRows<Level::kRows, N, Scalar>;
};
template <int N, typename Scalar>
struct LowerRowsOf<N, Scalar, TaskLevel<PostureTask<N, Scalar>>> {
  using type = PostureRows<N, Scalar>;
};

template <int N, typename Stack>
struct RowsOf;
template <int N, typename First, typename... Lower>
struct RowsOf<N, Stack<First, Lower...>> {
  using Scalar = typename Stack<First, Lower...>::Scalar;
  using type = std::tuple<LevelRows<First::kRows, N, Scalar>, typename LowerRowsOf<N, Scalar, Lower>::type...>;
};

template <typename Tuple>
struct StatesOf;
template <typename... Tasks>
struct StatesOf<std::tuple<Tasks...>> {
  using type = std::tuple<TaskState<Tasks>...>;
};

}  // namespace stack_detail

/// Kinematics of a stack on a robot in one state: the points of all tasks and the rows of all levels.
template <typename Stack_, int N>
struct StackKinematics {
  using Scalar = typename Stack_::Scalar;
  using Levels = typename stack_detail::RowsOf<N, Stack_>::type;

  StackKinematics() noexcept {}  // NOLINT(modernize-use-equals-default): as LevelRows.

  typename Stack_::Point tip;  ///< x of each task, in the base frame.
  Levels levels;
  typename stack_detail::StatesOf<typename Stack_::Tasks>::type tasks;

  /// Whether the level of task i is enabled.
  [[nodiscard]] bool is_enabled(std::size_t i) const noexcept {
    return enabled[static_cast<std::size_t>(Stack_::level(static_cast<int>(i)))];
  }

  std::array<bool, Stack_::kLevels> enabled;  ///< Whether each level is resolved. The first level is always resolved.
  Scalar length = Scalar(1);                  ///< Characteristic length of the robot [m].

  /// Set by continue_tick(), in the middle of a tick: 2 (e' − e)/h, twice the change of the
  /// errors since the start of the tick, divided by the length h of the tick [m/s, rad/s].
  Vector<Stack_::Space::kRows, Scalar> error_rate;
  Scalar tick = Scalar(0);  ///< h [s], or 0 without continue_tick().

  /// Prepares the middle of a tick that continues the acceleration of the previous tick: sets the feedback and the rows
  /// according to TickFeedback. change: e' − e, the change of the errors since the start of the tick.
  void continue_tick(Scalar h, const Vector<Stack_::Space::kRows, Scalar>& change,
                     const TickBefore<N, Scalar>& before) noexcept {
    tick = h;
    error_rate = entrywise(change, [&](Eigen::Index i) { return Scalar(2) / h * change.coeff(i); });
    each_task(*this, [&](auto level, auto& task, int row) noexcept {
      task.feedback = {task.feedback.velocity_gain, task.feedback.position_gain, h};
      std::get<decltype(level)::value>(levels).continue_tick(task.feedback, row, task.S.rows(), before);
    });
  }

  /// Calls f(k, task, row) for each task: k, an integral constant, is the level of the task, and `row` the first row of
  /// the task in this level.
  template <typename F>
  void each_task(F&& f) const noexcept {
    each_task(*this, f);
  }

 private:
  template <typename Self, typename F>
  static void each_task(Self& self, F&& f) noexcept {
    int row = 0;
    Stack_::Space::each([&](auto, auto i, int) noexcept {
      constexpr int kIndex = decltype(i)::value;
      if (kIndex > 0 && Stack_::level(kIndex) != Stack_::level(kIndex - 1)) row = 0;
      auto& task = std::get<kIndex>(self.tasks);
      f(std::integral_constant<std::size_t, static_cast<std::size_t>(Stack_::level(kIndex))>{}, task, row);
      row += static_cast<int>(task.S.rows());
    });
  }
};

template <typename... Levels, int N, typename Scalar>
struct Kinematics<StackSpace<Levels...>, N, Scalar> : StackKinematics<Stack<Levels...>, N> {};

template <typename... Levels, int N, typename Scalar>
[[nodiscard]] const auto& first_rows(const Kinematics<StackSpace<Levels...>, N, Scalar>& kinematics) noexcept {
  return std::get<0>(kinematics.levels).J;
}

template <typename... Levels, int N, typename Scalar>
[[nodiscard]] bool has_lower_levels(const Kinematics<StackSpace<Levels...>, N, Scalar>& kinematics) noexcept {
  return std::apply([](const auto&, const auto&... lower) { return ((lower.rows() > 0) || ...); }, kinematics.levels);
}

/// Errors of all tasks for the targets x. For a task with a selection S of rows, the error is S⁺S (x ⊖ f(q)): the
/// coordinates that are not selected have no error.
template <typename... Levels, int N, typename Scalar>
[[nodiscard]] auto task_error(const Kinematics<StackSpace<Levels...>, N, Scalar>& kinematics,
                              const typename StackSpace<Levels...>::template Point<Scalar>& x) noexcept {
  using Space = StackSpace<Levels...>;
  Vector<Space::kRows, Scalar> error = Space::template difference<Scalar>(x, kinematics.tip);
  Space::each([&](auto space, auto i, int row) noexcept {
    using Part = decltype(space);
    if constexpr (!std::tuple_element_t<decltype(i)::value, typename Stack<Levels...>::Tasks>::kWhole) {
      const auto& S = std::get<decltype(i)::value>(kinematics.tasks).S;
      const Vector<Part::kRows, Scalar> whole = error.template segment<Part::kRows>(row);
      const auto selected = product(S, whole);
      for (int j = 0; j < Part::kRows; ++j) {
        // The rows of S are orthonormal, times the length if the row is angular.
        const Scalar unit = j < Part::kRows - Part::kTurns ? Scalar(1) : kinematics.length;
        Scalar sum(0);
        for (Eigen::Index r = 0; r < S.rows(); ++r) sum += S.coeff(r, j) * selected.coeff(r);
        error(row + j) = sum / (unit * unit);
      }
    }
  });
  return error;
}

}  // namespace fpbm
