#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <tuple>

#include "fpbm/core/product_space.hpp"
#include "fpbm/realtime/task_distance.hpp"
#include "fpbm/task/reference.hpp"

namespace fpbm {

/// Brings the lower levels of a stack to rest if their targets cannot be reached.
///
/// In each window of stall_time, the largest error of each task counts. If no target has moved by 0.002 (TaskDistance),
/// and no task's largest error is below that of every earlier window by 1/16, each task of a lower level with
/// an error above 0.0001 is held at its current point. A target that moves, of any level, releases all tasks. Without
/// it, an arm that is limited may oscillate in the null space of the higher levels.
template <typename Space, typename Scalar = double>
class LowerLevels {
 public:
  using Point = typename Space::template Point<Scalar>;

  LowerLevels(Scalar stall_time, Scalar dt) noexcept : stall_time_(stall_time), dt_(dt) { begin_window(); }

  /// A reference in which the points that are held replace those of their tasks.
  [[nodiscard]] Reference<Space, Scalar> operator()(Reference<Space, Scalar> reference) const noexcept {
    if (!any_held_) return reference;
    Space::each([&](auto space, auto i, int row) noexcept {
      constexpr std::size_t kIndex = decltype(i)::value;
      if (!held_[kIndex]) return;
      std::get<kIndex>(reference.x) = std::get<kIndex>(point_);
      for (int j = row; j < row + decltype(space)::kRows; ++j) reference.xd(j) = reference.xdd(j) = Scalar(0);
    });
    return reference;
  }

  /// Call at the start of a tick, with the points of the tasks in `kinematics`.
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
      moved = moved || Distance::between(goal, std::get<kIndex>(target_), length) > Distance::kProgress;
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

  /// All tasks follow their targets.
  void release() noexcept {
    held_.fill(false);
    any_held_ = false;
    begin_window();
  }

 private:
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
  Point target_ = Space::template origin<Scalar>();
  Point point_ = Space::template origin<Scalar>();  ///< Of the tasks that are held.
};

/// A single task has no lower levels.
struct NoLowerLevels {
  template <typename Scalar>
  NoLowerLevels(Scalar, Scalar) noexcept {}
};

}  // namespace fpbm
