#pragma once

#include <array>
#include <tuple>
#include <type_traits>

#include "fpbm/linalg/product.hpp"
#include "fpbm/linalg/sums.hpp"
#include "fpbm/model/kinematics.hpp"
#include "fpbm/model/robot.hpp"
#include "fpbm/task/posture_task.hpp"
#include "fpbm/task/stack.hpp"
#include "fpbm/task/task_rows.hpp"
#include "fpbm/task/tick_feedback.hpp"

namespace fpbm {

/// What a task adds to its rows: its feedback, its selection S, in metres, and its velocity J qd in the rows of its
/// space.
template <typename Task>
struct TaskState {
  using Scalar = typename Task::Scalar;
  TickFeedback<Scalar> feedback;
  Matrix<Task::kRows, Task::Space::kRows, Scalar> S;
  Vector<Task::Space::kRows, Scalar> xd;  ///< If kWhole, only its first S.rows() entries.

  TaskState() noexcept {}  // NOLINT(modernize-use-equals-default): as LevelRows.
};

namespace stack_detail {

/// Rows of a lower level.
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

  std::array<bool, Stack_::kLevels> enabled;  ///< Whether a level is to be resolved. The first one always is.
  Scalar length = Scalar(1);                  ///< The robot's characteristic length [m].

  /// Of the middle of a tick with one acceleration (continue_tick): twice the change of the errors from its start,
  /// divided by its length h [m/s, rad/s].
  Vector<Stack_::Space::kRows, Scalar> error_rate;
  Scalar tick = Scalar(0);  ///< h [s]; 0 otherwise.

  /// In the middle of a tick that continues the tick before: the feedback and the rows become those of TickFeedback.
  /// change: of the errors since the tick's start.
  void continue_tick(Scalar h, const Vector<Stack_::Space::kRows, Scalar>& change,
                     const TickBefore<N, Scalar>& before) noexcept {
    tick = h;
    error_rate = entrywise(change, [&](Eigen::Index i) { return Scalar(2) / h * change.coeff(i); });
    int row = 0;  // Of the task on its level.
    Stack_::Space::each([&](auto, auto i, int) noexcept {
      constexpr int kIndex = decltype(i)::value;
      if (kIndex > 0 && Stack_::level(kIndex) != Stack_::level(kIndex - 1)) row = 0;
      auto& [feedback, S, xd] = std::get<kIndex>(tasks);
      feedback = {feedback.velocity_gain, feedback.position_gain, h};
      auto& level = std::get<static_cast<std::size_t>(Stack_::level(kIndex))>(levels);
      level.continue_tick(feedback, row, S.rows(), before);
      row += static_cast<int>(S.rows());
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

/// The errors of all tasks. Of a task with a selection S of rows, the part S⁺S (x ⊖ f(q)): the coordinates that are not
/// selected have no error. x: the targets.
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
        // The rows of S are orthonormal, times the length if the row is an angle.
        const Scalar unit = j < Part::kRows - Part::kTurns ? Scalar(1) : kinematics.length;
        Scalar sum(0);
        for (Eigen::Index r = 0; r < S.rows(); ++r) sum += S.coeff(r, j) * selected.coeff(r);
        error(row + j) = sum / (unit * unit);
      }
    }
  });
  return error;
}

/// A robot with a stack of tasks: the map from joint states to the points and rows of the tasks.
template <typename Robot_, typename Stack_>
class RobotTasks {
 public:
  using Scalar = typename Robot_::Scalar;
  static constexpr int kDof = Robot_::kDof;
  using State = Kinematics<typename Stack_::Space, kDof, Scalar>;

  /// Throws std::invalid_argument where a task does not suit the robot.
  RobotTasks(const Robot_& robot, const Stack_& stack) : robot_(robot), stack_(stack) { stack_.bind(robot_); }

  [[nodiscard]] int dof() const noexcept { return robot_.dof(); }
  [[nodiscard]] const Robot_& robot() const noexcept { return robot_; }
  [[nodiscard]] const Stack_& stack() const noexcept { return stack_; }
  /// As Stack::enable().
  bool enable(int k, bool on) noexcept { return stack_.enable(k, on); }
  /// As Stack::reorder().
  bool reorder(const std::array<int, Stack_::kLevels>& order) noexcept { return stack_.reorder(order); }
  [[nodiscard]] const auto& limits() const noexcept { return robot_.limits(); }

  /// The points of the tasks at q, and their selections.
  void points(const Vector<kDof, Scalar>& q, State& out) const noexcept {
    typename Robot_::State state;
    robot_.update(q, state);
    begin(out);
    stack_.each([&](const auto& task, auto i) noexcept {
      constexpr int kIndex = decltype(i)::value;
      auto& task_state = std::get<kIndex>(out.tasks);
      task.evaluate(robot_, state, std::get<kIndex>(out.tip), task_state.xd, task_state.S, NoRows{});
    });
  }

  /// At (q, qd).
  void kinematics(const Vector<kDof, Scalar>& q, const Vector<kDof, Scalar>& qd, State& out) const noexcept {
    typename Robot_::State state;
    robot_.update(q, qd, state);
    evaluate(state, out);
  }

  /// At q, for velocity level: does not touch J̇.
  void kinematics(const Vector<kDof, Scalar>& q, State& out) const noexcept {
    typename Robot_::State state;
    robot_.update(q, state);
    evaluate(state, out);
  }

 private:
  void begin(State& out) const noexcept {
    out.length = robot_.length();
    out.enabled = stack_.enabled();
    int k = 0;
    std::apply([&](auto&... level) { (level.resize(stack_.rows(k++), robot_.dof()), ...); }, out.levels);
  }

  void evaluate(const typename Robot_::State& state, State& out) const noexcept {
    begin(out);
    int row = 0;  // Of the task on its level.
    stack_.each([&](const auto& task, auto i) noexcept {
      constexpr int kIndex = decltype(i)::value;
      if (kIndex > 0 && Stack_::level(kIndex) != Stack_::level(kIndex - 1)) row = 0;
      auto& [feedback, S, xd] = std::get<kIndex>(out.tasks);
      feedback = {task.gains.k1, task.gains.k2};
      auto& level = std::get<static_cast<std::size_t>(Stack_::level(kIndex))>(out.levels);
      task.evaluate(robot_, state, std::get<kIndex>(out.tip), xd, S, rows_from(level, row));
      row += rows_of(task);
    });
  }

  Robot_ robot_;
  Stack_ stack_;
};

template <typename Robot, typename Stack_>
[[nodiscard]] bool has_several_tasks(const RobotTasks<Robot, Stack_>& arm) noexcept {
  return arm.stack().count() > 1;
}

}  // namespace fpbm
