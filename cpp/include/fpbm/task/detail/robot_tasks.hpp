#pragma once

#include <array>
#include <cstddef>
#include <tuple>

#include "fpbm/model/robot.hpp"
#include "fpbm/task/detail/stack_kinematics.hpp"
#include "fpbm/task/detail/task_rows.hpp"
#include "fpbm/task/stack.hpp"

namespace fpbm {

/// Robot with a stack of tasks: the map from joint states to the points and rows of the tasks.
template <typename Robot_, typename Stack_>
class RobotTasks {
 public:
  using Scalar = typename Robot_::Scalar;
  static constexpr int kDof = Robot_::kDof;
  using State = Kinematics<typename Stack_::Space, kDof, Scalar>;

  /// Throws std::invalid_argument if a task does not suit the robot (Stack::bind()).
  RobotTasks(const Robot_& robot, const Stack_& stack) : robot_(robot), stack_(stack) { stack_.bind(robot_); }

  [[nodiscard]] int dof() const noexcept { return robot_.dof(); }
  [[nodiscard]] const Robot_& robot() const noexcept { return robot_; }
  [[nodiscard]] const Stack_& stack() const noexcept { return stack_; }
  /// See Stack::enable().
  bool enable(int k, bool on) noexcept { return stack_.enable(k, on); }
  /// See Stack::reorder().
  bool reorder(const std::array<int, Stack_::kLevels>& order) noexcept { return stack_.reorder(order); }
  [[nodiscard]] const auto& limits() const noexcept { return robot_.limits(); }

  /// Points and selections of the tasks at q.
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

  /// Points and rows of the tasks at (q, qd).
  void kinematics(const Vector<kDof, Scalar>& q, const Vector<kDof, Scalar>& qd, State& out) const noexcept {
    typename Robot_::State state;
    robot_.update(q, qd, state);
    evaluate(state, out);
  }

  /// Points and rows of the tasks at q, for velocity level, which needs no J̇.
  void kinematics(const Vector<kDof, Scalar>& q, State& out) const noexcept {
    typename Robot_::State state;
    robot_.update(q, state);
    evaluate(state, out);
  }

 private:
  void begin(State& out) const noexcept {
    out.length = robot_.length();
    out.tick = Scalar(0);  // Until continue_tick().
    out.enabled = stack_.enabled();
    int k = 0;
    std::apply([&](auto&... level) { (level.resize(stack_.rows(k++), robot_.dof()), ...); }, out.levels);
  }

  void evaluate(const typename Robot_::State& state, State& out) const noexcept {
    begin(out);
    int row = 0;  // First row of the task in its level.
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

}  // namespace fpbm
