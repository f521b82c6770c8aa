#pragma once

#include <optional>
#include <string>
#include <vector>

#include "fpbm/any/any_stack.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/path/reference.hpp"
#include "fpbm/task/detail/robot_tasks.hpp"
#include "model.hpp"

namespace fpbm::bindings {

/// The coordinates of a frame in the order of FrameCoordinates, or a posture.
enum class TaskKind { kPosition, kOrientation, kPose, kAxis, kCenterOfMass, kPosture };

/// The compiled part of a task. Attributes of the object in Python do not change the kind.
struct Task {
  TaskKind kind;
};

/// A reference of one task.
struct StackTarget {
  Transform<> at;
  Vector<kDynamic> q;
  Vector<kDynamic> xd;
  Vector<kDynamic> xdd;
};

/// A task of a stack in Python.
struct StackTask {
  using Space = AnyStack::Space;

  std::string name;
  TaskKind kind;
  int index;  ///< Index among AnyStack's tasks.
  int size;   ///< Rows of a displacement of the task's point.
  std::vector<int> joints;

  /// First row within the rows of the task's place in an AnyStack: the rows of angles follow three rows of lengths.
  [[nodiscard]] int shift() const noexcept { return kind == TaskKind::kOrientation || kind == TaskKind::kAxis ? 3 : 0; }
  [[nodiscard]] bool follows_paths() const noexcept { return kind == TaskKind::kPosition || kind == TaskKind::kPose; }

  /// Calls f(space, i, row) for the place of the task in an AnyStack, as AnyStack::Space::each() does. f must not
  /// throw.
  template <typename F>
  void at_place(F&& f) const noexcept {
    AnyStack::Space::each([&](auto space, auto i, int row) noexcept {
      if (static_cast<int>(decltype(i)::value) == index) f(space, i, row);
    });
  }

  /// Sets the reference of the task in the reference of the stack.
  void put(const StackTarget& target, Reference<Space>& to) const noexcept;
  /// The frame of the task at a point of the stack; for an axis task, z is the axis.
  [[nodiscard]] Transform<> frame_of(const AnyStack::Point& point) const noexcept;
  /// Positions of the joints of a posture.
  [[nodiscard]] JointVector posture_of(const AnyStack::Point& point) const noexcept;
  /// The entries of the task in the error of the stack.
  [[nodiscard]] JointVector error_of(const Vector<Space::kRows>& error) const noexcept;
};

/// A robot with the tasks of a stack.
using StackArm = RobotTasks<Robot<kDynamic>, AnyStack>;

/// An fpbm_cpp.Stack for a robot.
struct StackPlan {
  Tree<> tree;
  std::vector<StackTask> tasks;
  std::vector<std::optional<StackTarget>> targets;  ///< Target of each task, if the task has one.
  int levels = 0;
  AnyStack velocity;      ///< The tasks with their gains at velocity level,
  AnyStack acceleration;  ///< and at acceleration level.

  /// Throws std::invalid_argument if a task does not fit the robot.
  [[nodiscard]] StackArm arm_at(Level level) const {
    return {Robot<kDynamic>(tree), level == Level::kVelocity ? velocity : acceleration};
  }
  /// Throws std::invalid_argument if no task has that name.
  [[nodiscard]] const StackTask& task(const std::string& name) const {
    std::string known;
    for (const StackTask& each : tasks) {
      if (each.name == name) return each;
      known += (known.empty() ? "'" : ", '") + each.name + "'";
    }
    validation::reject("task", " = '" + name + "': must be a task of the stack: " + known);
  }
  /// The task that follows a path: the task of the name, or the only position or pose. Throws std::invalid_argument if
  /// no task fits.
  [[nodiscard]] const StackTask& follower(const std::optional<std::string>& name) const {
    if (name) {
      const StackTask& named = task(*name);
      if (named.follows_paths()) return named;
      validation::reject("task", " = '" + *name + "': must be a position or a pose to follow a path");
    }
    const StackTask* found = nullptr;
    for (const StackTask& each : tasks) {
      if (!each.follows_paths()) continue;
      if (found != nullptr) validation::reject("task", ": several tasks follow paths: must be the name of one");
      found = &each;
    }
    if (found == nullptr) {
      validation::reject("task", ": the stack has no task that can follow a path: add a position or a pose");
    }
    return *found;
  }
  /// Entries of all errors, one task after another.
  [[nodiscard]] int error_size() const noexcept {
    int size = 0;
    for (const StackTask& each : tasks) size += each.size;
    return size;
  }
};

}  // namespace fpbm::bindings
