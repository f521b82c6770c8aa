#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <tuple>

#include "fpbm/linalg/detail/sums.hpp"
#include "fpbm/path/reference.hpp"
#include "fpbm/realtime/detail/no_lower_levels.hpp"
#include "fpbm/realtime/detail/shape_watch.hpp"
#include "fpbm/realtime/detail/stack_tick.hpp"
#include "fpbm/realtime/detail/task_distance.hpp"
#include "fpbm/task/stack.hpp"

namespace fpbm {

/// Stops the tasks of lower levels that do not approach their targets. Otherwise, tasks of lower levels could oscillate
/// or drift in the null space of the higher levels while limits slow the tasks, and the robot would not stop.
///
/// A task makes progress in a window of stall_time if its largest error is below 15/16 of its largest errors in all
/// earlier windows. A task of a lower level stops if it makes no progress, its error exceeds 0.0001, no target has
/// moved by 0.002 (TaskDistance), and no task makes progress of more than 0.002. A stopped task brakes: its reference
/// is its current point at zero velocity, until the task and the joints are at rest or the next window ends. Then the
/// task holds this point. If the task leaves this point by more than 0.000025 while all other tasks are at their
/// targets, all joints brake.
///
/// All tasks follow their references again if a target of any level or a shape near the arm moves, and after a tick
/// that does not follow the references.
template <typename Space, typename Scalar = double>
class LowerLevels {
 public:
  using Point = typename Space::template Point<Scalar>;

  LowerLevels(Scalar stall_time, Scalar dt) noexcept : stall_time_(stall_time), dt_(dt) { release(); }

  /// Call at the start of a tick. kinematics: in the state at the start. error: errors of the tasks at the start.
  /// Replaces the references of stopped tasks, and resets their integrals. Returns whether any task has stopped, so
  /// that the correction must begin again with the errors of the new references.
  template <typename References, typename Kinematics, typename Correction>
  [[nodiscard]] bool hold(References& references, const Kinematics& kinematics,
                          const Vector<Space::kRows, Scalar>& error, Correction& correction) noexcept {
    watch(references.stages[0].x, kinematics, error);
    if (!any_stopped_) return false;
    Space::each([&](auto space, auto i, int row) noexcept {
      constexpr std::size_t kIndex = decltype(i)::value;
      using Part = decltype(space);
      if (!stopped_[kIndex]) return;
      hold_at_rest<kIndex, Part>(std::get<kIndex>(kinematics.tip), kinematics.length);
      correction.reset_integrals(row, Part::kRows);
      for (auto& stage : references.stages) {
        std::get<kIndex>(stage.x) = std::get<kIndex>(point_);
        for (int j = row; j < row + Part::kRows; ++j) stage.xd(j) = stage.xdd(j) = Scalar(0);
      }
    });
    return true;
  }

  /// Whether all joints should brake: a stopped task has left its point, or tasks have stopped and no task has
  /// approached its target for kQuiet windows. Otherwise, null-space motion could continue for minutes.
  [[nodiscard]] bool rests() const noexcept { return quiet_ >= kQuiet || displaced_; }

  /// Sets the scale of each level with a stopped task to 0.
  template <typename... Levels, int N>
  void report(Tick<StackSpace<Levels...>, N, Scalar>& tick) const noexcept {
    for (std::size_t i = 0; i < kTasks; ++i) {
      if (stopped_[i]) tick.scales[static_cast<std::size_t>(Stack<Levels...>::level(static_cast<int>(i)))] = Scalar(0);
    }
  }

  /// Call at the end of a tick. follows: whether the arm follows the references. qd: joint velocities [rad/s].
  /// distance_sum: Bounds::near_distance_sum() [m]. length: the robot's characteristic length [m].
  template <typename JointVector>
  void end_tick(bool follows, const JointVector& qd, Scalar distance_sum, Scalar length) noexcept {
    if (!follows) return release();
    if (!any_stopped_) return;
    at_rest_ = largest_magnitude(qd) <= kRest;
    if (shapes_.moved(at_rest_, distance_sum, kMoved * length)) release();
  }

  /// Resets the detection: all tasks follow their references.
  void release() noexcept {
    stopped_.fill(false);
    held_.fill(false);
    any_stopped_ = at_rest_ = reached_ = displaced_ = false;
    shapes_.reset();
    least_.fill(std::numeric_limits<Scalar>::infinity());
    peak_.fill(Scalar(0));
    time_ = Scalar(0);
    quiet_ = 0;
  }

 private:
  template <typename Kinematics>
  void watch(const Point& target, const Kinematics& kinematics, const Vector<Space::kRows, Scalar>& errors) noexcept {
    bool moved = false;
    Scalar displacements(0);
    Space::each([&](auto space, auto i, int row) noexcept {
      constexpr std::size_t kIndex = decltype(i)::value;
      using Part = decltype(space);
      using Distance = TaskDistance<Part, Scalar>;
      const Scalar displacement =
          Distance::between(std::get<kIndex>(target), std::get<kIndex>(target_), kinematics.length);
      moved = moved || displacement > kMoved;
      displacements += displacement;
      const Scalar error = Distance::norm(errors.template segment<Part::kRows>(row), kinematics.length);
      counts_[kIndex] = error > kSmall && kinematics.is_enabled(kIndex) && !stopped_[kIndex];
      if (counts_[kIndex]) peak_[kIndex] = std::max(peak_[kIndex], error);
    });
    if (moved) {
      target_ = target;
      return release();
    }
    if (displacements != displacements_) {
      held_.fill(false);
      reached_ = displaced_ = false;
      quiet_ = 0;
    }
    displacements_ = displacements;
    time_ += dt_;
    if (time_ > stall_time_) end_window();
  }

  /// Stops tasks at the end of a window, except of the first window: the errors of earlier windows are infinite.
  void end_window() noexcept {
    bool progress = false;
    bool settled = any_stopped_;
    reached_ = true;
    for (std::size_t i = 0; i < kTasks; ++i) {
      reached_ = reached_ && (stopped_[i] || peak_[i] == Scalar(0));
      const bool approaches = peak_[i] < (Scalar(1) - kApproach) * least_[i];
      progress = progress || (approaches && peak_[i] < least_[i] - kMoved);
      settled = settled && !(counts_[i] && approaches);
      counts_[i] = counts_[i] && !approaches;
      least_[i] = std::min(least_[i], peak_[i]);
    }
    peak_.fill(Scalar(0));
    time_ = Scalar(0);
    for (std::size_t i = Space::kFirst; i < kTasks; ++i) {
      const bool stops = counts_[i] && !stopped_[i] && !progress;
      settled = settled && !stops;
      held_[i] = stopped_[i];
      stopped_[i] = stopped_[i] || stops;
      any_stopped_ = any_stopped_ || stopped_[i];
    }
    quiet_ = settled ? quiet_ + 1 : 0;
  }

  /// Sets the point of a stopped task, unless the task holds its point.
  template <std::size_t kIndex, typename Part, typename PartPoint>
  void hold_at_rest(const PartPoint& tip, Scalar length) noexcept {
    const Scalar moved = TaskDistance<Part, Scalar>::between(tip, std::get<kIndex>(point_), length);
    if (held_[kIndex]) {
      displaced_ = displaced_ || (reached_ && moved > kSmall / Scalar(4));
      return;
    }
    held_[kIndex] = at_rest_ && moved <= kHold * dt_;
    std::get<kIndex>(point_) = tip;
  }

  static constexpr std::size_t kTasks = std::tuple_size_v<Point>;
  /// Smallest displacement of a target or of shapes, and smallest progress, that counts: as TaskDistance::kProgress.
  static constexpr Scalar kMoved = Scalar(2e-3);
  static constexpr Scalar kRest = Scalar(1e-3);  ///< Largest joint velocity [rad/s] at rest, as in the tests of stacks.
  static constexpr Scalar kSmall = Scalar(1e-4);  ///< As in StallDetector: 0.1 mm for an arm of 1 m.
  /// Largest task velocity [lengths/s, rad/s] of a stopped task that begins to hold its point. With 0.001, a motion of
  /// LowerLevels.stay_where_they_stopped_at_acceleration_level ends 1.4e-4 from its point, and with 0.0001, 2.5e-5.
  static constexpr Scalar kHold = Scalar(1e-4);
  /// Relative decrease of the error that counts as progress, as for a crawling arm (StallDetector). An error that
  /// decreases by 1/16 in each window of 2 s is 1 % of its start after 143 s.
  static constexpr Scalar kApproach = Scalar(1) / Scalar(16);
  /// Windows in which a rest posture moves the joints in the null space, 20 s by default. The value is a choice.
  static constexpr int kQuiet = 10;

  Scalar stall_time_;
  Scalar dt_;
  Scalar time_;  ///< Since the start of the window [s].
  bool any_stopped_;
  bool at_rest_;    ///< Whether the joints were at rest in the last tick with a stopped task.
  bool reached_;    ///< Whether all tasks that have not stopped were at their targets in the last window.
  bool displaced_;  ///< Whether a stopped task has left its point while the other tasks were at their targets.
  int quiet_;       ///< Windows since the last stop or approach of a task.
  Scalar displacements_ = Scalar(0);  ///< Sum of the displacements of the targets from target_.
  std::array<bool, kTasks> stopped_;
  std::array<bool, kTasks> held_;      ///< Stopped tasks that hold their points.
  std::array<bool, kTasks> counts_{};  ///< Tasks that are enabled, not stopped, and not at their targets.
  std::array<Scalar, kTasks> peak_;    ///< Largest error of each task in the window.
  std::array<Scalar, kTasks> least_;   ///< Smallest peak_ of earlier windows.
  ShapeWatch<Scalar> shapes_;
  Point target_ = Space::template origin<Scalar>();
  Point point_ = Space::template origin<Scalar>();  ///< Points of stopped tasks.
};

template <typename First, typename Second, typename... More, typename Scalar>
struct LowerLevelsOf<StackSpace<First, Second, More...>, Scalar> {
  using type = LowerLevels<StackSpace<First, Second, More...>, Scalar>;
};

}  // namespace fpbm
