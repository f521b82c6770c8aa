#pragma once

#include <array>
#include <tuple>
#include <type_traits>

#include "fpbm/linalg/product.hpp"
#include "fpbm/model/kinematics.hpp"
#include "fpbm/model/robot.hpp"
#include "fpbm/task/stack.hpp"

namespace fpbm {

/// Rows of a level: J and J̇, in metres.
template <int M, int N, typename Scalar>
struct LevelRows {
  Matrix<M, N, Scalar> J;
  Matrix<M, N, Scalar> Jd;
};

/// What a task adds to its rows: its gains, its selection S, in metres, and its velocity J qd in the rows of its space.
template <typename Task>
struct TaskState {
  using Scalar = typename Task::Scalar;
  Scalar k1;
  Scalar k2;
  Matrix<Task::kRows, Task::Space::kRows, Scalar> S;
  Vector<Task::Space::kRows, Scalar> xd;
};

namespace stack_detail {

template <int N, typename Stack>
struct RowsOf;
template <int N, typename... Levels>
struct RowsOf<N, Stack<Levels...>> {
  using Scalar = typename Stack<Levels...>::Scalar;
  using type = std::tuple<LevelRows<Levels::kRows, N, Scalar>...>;
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

  typename Stack_::Point tip;  ///< x of each task.
  Levels levels;
  typename stack_detail::StatesOf<typename Stack_::Tasks>::type tasks;
  /// Whether the level of task i is enabled.
  [[nodiscard]] bool is_enabled(std::size_t i) const noexcept {
    return enabled[static_cast<std::size_t>(Stack_::level(static_cast<int>(i)))];
  }

  std::array<bool, Stack_::kLevels> enabled;  ///< Whether a level is to be resolved. The first one always is.
  Scalar length = Scalar(1);                  ///< The robot's characteristic length [m].
};

template <typename... Levels, int N, typename Scalar>
struct Kinematics<StackSpace<Levels...>, N, Scalar> : StackKinematics<Stack<Levels...>, N> {};

template <typename First, typename... Lower>
inline constexpr int kFirstRows<StackSpace<First, Lower...>> = First::kRows;

template <typename... Levels, int N, typename Scalar>
[[nodiscard]] const auto& first_rows(const Kinematics<StackSpace<Levels...>, N, Scalar>& kinematics) noexcept {
  return std::get<0>(kinematics.levels).J;
}

/// A robot with a stack of tasks: the map from joint states to the points and rows of the tasks.
template <typename Robot_, typename Stack_>
class RobotTasks {
 public:
  using Scalar = typename Robot_::Scalar;
  static constexpr int kDof = Robot_::kDof;
  using State = Kinematics<typename Stack_::Space, kDof, Scalar>;

  /// Throws std::invalid_argument where a task does not suit the robot.
  RobotTasks(const Robot_& robot, const Stack_& stack) : robot_(robot), stack_(stack) { stack.require_robot(robot); }

  [[nodiscard]] int dof() const noexcept { return robot_.dof(); }
  [[nodiscard]] const Robot_& robot() const noexcept { return robot_; }
  [[nodiscard]] const Stack_& stack() const noexcept { return stack_; }
  [[nodiscard]] Stack_& stack() noexcept { return stack_; }
  [[nodiscard]] const auto& limits() const noexcept { return robot_.limits(); }

  /// At (q, qd).
  void kinematics(const Vector<kDof, Scalar>& q, const Vector<kDof, Scalar>& qd, State& out) const noexcept {
    typename Robot_::State state;
    robot_.update(q, qd, state);
    out.length = robot_.length();
    out.enabled = stack_.enabled();
    stack_.each([&](const auto& task, auto i) noexcept {
      using Task = std::decay_t<decltype(task)>;
      constexpr int kIndex = decltype(i)::value;
      constexpr int kSpace = Task::Space::kRows;
      auto& [k1, k2, S, xd] = std::get<kIndex>(out.tasks);
      k1 = task.gains.k1;
      k2 = task.gains.k2;
      Matrix<kSpace, kDof, Scalar> J;
      Matrix<kSpace, kDof, Scalar> Jd;
      task.evaluate(robot_, state, std::get<kIndex>(out.tip), J, Jd, S);
      for (int j = kSpace - Task::Space::kTurns; j < kSpace; ++j) {
        for (int row = 0; row < Task::kRows; ++row) S(row, j) *= out.length;
      }
      xd = product(J, qd);
      auto& level = std::get<static_cast<std::size_t>(Stack_::level(kIndex))>(out.levels);
      for (Eigen::Index j = 0; j < J.cols(); ++j) {
        for (int row = 0; row < Task::kRows; ++row) {
          level.J.coeffRef(Stack_::row(kIndex) + row, j) = selected<Task>(S, J, row, j);
          level.Jd.coeffRef(Stack_::row(kIndex) + row, j) = selected<Task>(S, Jd, row, j);
        }
      }
    });
  }

  /// At q, for velocity level.
  void kinematics(const Vector<kDof, Scalar>& q, State& out) const noexcept {
    kinematics(q, filled<Vector<kDof, Scalar>>(q.size()), out);
  }

 private:
  /// An entry of S A.
  template <typename Task, typename Selection, typename Rows>
  [[nodiscard]] static Scalar selected(const Selection& S, const Rows& A, int row, Eigen::Index j) noexcept {
    if constexpr (Task::kWhole) return S.coeff(row, row) * A.coeff(row, j);
    Scalar sum(0);
    for (int k = 0; k < Task::Space::kRows; ++k) sum += S.coeff(row, k) * A.coeff(k, j);
    return sum;
  }

  Robot_ robot_;
  Stack_ stack_;
};

}  // namespace fpbm
