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
/// If no target has moved by 0.002 (TaskDistance) and no task comes nearer to its target by 1/64 of its error, at most
/// 0.002, for stall_time, each task of a lower level with an error above 0.0001 is held at its current point. A target
/// that moves, of any level, releases all tasks. Without it, an arm that is limited may oscillate in the null space of
/// the higher levels.
template <typename Space, typename Scalar = double>
class LowerLevels {
 public:
  using Point = typename Space::template Point<Scalar>;

  LowerLevels(Scalar stall_time, Scalar dt) noexcept : stall_time_(stall_time), dt_(dt) {}

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

  /// Call at the start of a tick. x: points of the tasks. length: the robot's characteristic length [m].
  void update(const Point& target, const Point& x, Scalar length) noexcept {
    bool moved = false;
    bool progress = false;
    bool all_done = true;
    Space::each([&](auto space, auto i, int) noexcept {
      using Part = decltype(space);
      constexpr std::size_t kIndex = decltype(i)::value;
      using Distance = TaskDistance<Part, Scalar>;
      const auto& goal = std::get<kIndex>(target);
      moved = moved || Distance::between(goal, std::get<kIndex>(target_), length) > Distance::kProgress;
      const auto& aim = held_[kIndex] ? std::get<kIndex>(point_) : goal;
      const Scalar error = Distance::between(aim, std::get<kIndex>(x), length);
      done_[kIndex] = !(error > kSmall);
      if (done_[kIndex]) return;
      all_done = false;
      Scalar& least = least_[kIndex];
      if (error < least - std::min(Distance::kProgress, least * kApproach) || !(least < kNone)) {
        least = error;
        progress = true;
      }
    });
    if (moved) return release(target);
    waited_ = progress || all_done ? Scalar(0) : waited_ + dt_;
    if (waited_ > stall_time_) hold(x);
  }

  /// All tasks follow their targets.
  void release(const Point& target) noexcept {
    target_ = target;
    held_.fill(false);
    least_.fill(kNone);
    any_held_ = false;
    waited_ = Scalar(0);
  }

 private:
  void hold(const Point& x) noexcept {
    Space::each([&](auto, auto i, int) noexcept {
      constexpr std::size_t kIndex = decltype(i)::value;
      least_[kIndex] = kNone;
      if (kIndex < Space::kFirst || done_[kIndex]) return;
      held_[kIndex] = true;
      std::get<kIndex>(point_) = std::get<kIndex>(x);
    });
    any_held_ = true;
    waited_ = Scalar(0);
  }

  static constexpr std::size_t kTasks = std::tuple_size_v<Point>;
  static constexpr Scalar kNone = std::numeric_limits<Scalar>::infinity();
  // The thresholds of StallDetector for an arm that is damped.
  static constexpr Scalar kSmall = Scalar(1e-4);
  static constexpr Scalar kApproach = Scalar(1) / Scalar(64);

  Scalar stall_time_;
  Scalar dt_;
  Scalar waited_{0};  ///< Without progress [s].
  bool any_held_ = false;
  std::array<bool, kTasks> held_{};
  std::array<bool, kTasks> done_{};
  std::array<Scalar, kTasks> least_ = filled_with(kNone);  ///< Least errors.
  Point target_ = Space::template origin<Scalar>();
  Point point_ = Space::template origin<Scalar>();  ///< Of the tasks that are held.

  [[nodiscard]] static std::array<Scalar, kTasks> filled_with(Scalar value) noexcept {
    std::array<Scalar, kTasks> all{};
    all.fill(value);
    return all;
  }
};

/// A single task has no lower levels.
struct NoLowerLevels {
  template <typename Scalar>
  NoLowerLevels(Scalar, Scalar) noexcept {}
};

}  // namespace fpbm
