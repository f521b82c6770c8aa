#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <tuple>
#include <type_traits>

#include "fpbm/linalg/sums.hpp"
#include "fpbm/realtime/no_lower_levels.hpp"
#include "fpbm/realtime/shape_watch.hpp"
#include "fpbm/realtime/task_distance.hpp"
#include "fpbm/task/reference.hpp"
#include "fpbm/task/stack.hpp"

namespace fpbm {

/// Brings the lower levels of a stack to rest if their targets cannot be reached.
///
/// The largest error of each task in a window of stall_time counts. If no target has moved by 0.002 (TaskDistance), and
/// no task has a largest error below those of all earlier windows by 1/16, each task of a lower level with an error
/// above 0.0001 is held at its current point. All tasks are released if a target of any level or a shape near the arm
/// moves, and in a tick that does not follow the references. Tasks that are not held could oscillate in the null space
/// of the higher levels while limits slow them.
template <typename Space, typename Scalar = double>
class LowerLevels {
 public:
  using Point = typename Space::template Point<Scalar>;

  LowerLevels(Scalar stall_time, Scalar dt) noexcept : stall_time_(stall_time), dt_(dt) { begin_window(); }

  /// Call at the start of a tick, with the kinematics of the state. The points that are held replace those of their
  /// tasks in the references, from which the correction begins anew.
  template <typename References, typename Kinematics, typename Correction>
  void hold(References& references, const Kinematics& kinematics, Correction& correction) noexcept {
    update(references.stages[0].x, kinematics);
    if (!any_held_) return;
    for (auto& stage : references.stages) replace(stage);
    correction.begin(Space::template difference<Scalar>(references.stages[0].x, kinematics.tip), kinematics.length);
  }

  /// Call at the end of a tick. follows: the arm follows the references. qd: joint velocities [rad/s]. room: a measure
  /// of the distances of shapes near the arm [m]. length: the robot's characteristic length [m].
  template <typename JointVector>
  void end_tick(bool follows, const JointVector& qd, Scalar room, Scalar length) noexcept {
    const bool at_rest = largest_magnitude(qd) <= kRest;
    if (!follows || (any_held_ && shapes_.moved(at_rest, room, kMoved * length))) release();
  }

  /// All tasks follow their references.
  void release() noexcept {
    held_.fill(false);
    any_held_ = false;
    shapes_.reset();
    begin_window();
  }

 private:
  void replace(Reference<Space, Scalar>& reference) const noexcept {
    Space::each([&](auto space, auto i, int row) noexcept {
      constexpr std::size_t kIndex = decltype(i)::value;
      if (!held_[kIndex]) return;
      std::get<kIndex>(reference.x) = std::get<kIndex>(point_);
      for (int j = row; j < row + decltype(space)::kRows; ++j) reference.xd(j) = reference.xdd(j) = Scalar(0);
    });
  }

  template <typename Kinematics>
  void update(const Point& target, const Kinematics& kinematics) noexcept {
    const Point& x = kinematics.tip;
    const Scalar length = kinematics.length;
    bool moved = false;
    Space::each([&](auto space, auto i, int) noexcept {
      using Part = decltype(space);
      constexpr std::size_t kIndex = decltype(i)::value;
      using Distance = TaskDistance<Part, Scalar>;
      const auto& goal = std::get<kIndex>(target);
      moved = moved || Distance::between(goal, std::get<kIndex>(target_), length) > kMoved;
      const auto& aim = held_[kIndex] ? std::get<kIndex>(point_) : goal;
      const Scalar error = Distance::between(aim, std::get<kIndex>(x), length);
      done_[kIndex] = !(error > kSmall) || !kinematics.is_enabled(kIndex);
      if (!done_[kIndex]) peak_[kIndex] = std::max(peak_[kIndex], error);
    });
    if (moved) {
      target_ = target;
      return release();
    }
    time_ += dt_;
    if (time_ > stall_time_) end_window(x);
  }

  void end_window(const Point& x) noexcept {
    bool progress = false;
    bool all_done = true;
    for (std::size_t i = 0; i < kTasks; ++i) {
      // The first window of a task makes progress: its least error so far is infinite.
      progress = progress || peak_[i] < (Scalar(1) - kApproach) * least_[i];
      all_done = all_done && done_[i];
    }
    for (std::size_t i = 0; i < kTasks; ++i) least_[i] = std::min(least_[i], peak_[i]);
    peak_.fill(Scalar(0));
    time_ = Scalar(0);
    if (progress || all_done) return;
    Space::each([&](auto, auto i, int) noexcept {
      constexpr std::size_t kIndex = decltype(i)::value;
      if (kIndex < Space::kFirst || done_[kIndex]) return;
      held_[kIndex] = true;
      std::get<kIndex>(point_) = std::get<kIndex>(x);
    });
    any_held_ = true;
    begin_window();
  }

  void begin_window() noexcept {
    least_.fill(kNone);
    peak_.fill(Scalar(0));
    time_ = Scalar(0);
  }

  static constexpr std::size_t kTasks = std::tuple_size_v<Point>;
  static constexpr Scalar kNone = std::numeric_limits<Scalar>::infinity();
  /// Least displacement that counts as a motion of a target or of shapes, as in TaskDistance.
  static constexpr Scalar kMoved = Scalar(2e-3);
  static constexpr Scalar kRest = Scalar(1e-3);   ///< Largest velocity of a joint of an arm at rest [rad/s].
  static constexpr Scalar kSmall = Scalar(1e-4);  ///< As in StallDetector.
  /// As for an arm that crawls (StallDetector): an error that decays by 1/16 in each window of 2 s reaches 1 % in 143
  /// s.
  static constexpr Scalar kApproach = Scalar(1) / Scalar(16);

  Scalar stall_time_;
  Scalar dt_;
  Scalar time_{0};  ///< Of the window [s].
  bool any_held_ = false;
  std::array<bool, kTasks> held_{};
  std::array<bool, kTasks> done_{};
  std::array<Scalar, kTasks> peak_{};   ///< Largest errors in the window,
  std::array<Scalar, kTasks> least_{};  ///< and the least of earlier windows.
  ShapeWatch<Scalar> shapes_;
  Point target_ = Space::template origin<Scalar>();
  Point point_ = Space::template origin<Scalar>();  ///< Of the tasks that are held.
};

template <typename... Levels, typename Scalar>
struct LowerLevelsOf<StackSpace<Levels...>, Scalar> {
  using type = std::conditional_t<(sizeof...(Levels) == 1), NoLowerLevels, LowerLevels<StackSpace<Levels...>, Scalar>>;
};

}  // namespace fpbm
