#pragma once

#include <cstddef>
#include <tuple>

#include "fpbm/geometry/detail/product_space.hpp"
#include "fpbm/realtime/detail/task_distance.hpp"
#include "fpbm/realtime/detail/tick_references.hpp"

namespace fpbm {

/// Holds the references of the first level of a stack while a stop keeps this level (TrackerOptions::keep_first_level).
template <typename Space, typename Scalar = double>
class HeldLevel {
 public:
  using Point = typename Space::template Point<Scalar>;

  /// Replaces the targets of the first level by the targets in the first tick of the stop, with zero velocity and
  /// acceleration. If the distance of a task from its target exceeds kNear in the first tick, the point of the task in
  /// this tick replaces the target: a stop does not move a task to a far target. tip: the current points. length: the
  /// robot's characteristic length [m].
  void hold(TickReferences<Space, Scalar>& references, const Point& tip, Scalar length) noexcept {
    if (!holds_) begin(references.stages[0].x, tip, length);
    for (Reference<Space, Scalar>& stage : references.stages) {
      each_first([&](auto space, auto i, int row) noexcept {
        std::get<decltype(i)::value>(stage.x) = std::get<decltype(i)::value>(target_);
        for (int j = row; j < row + decltype(space)::kRows; ++j) stage.xd(j) = stage.xdd(j) = Scalar(0);
      });
    }
  }
  /// Ends the stop. The next call of hold() begins another stop.
  void release() noexcept { holds_ = false; }

 private:
  void begin(const Point& target, const Point& tip, Scalar length) noexcept {
    holds_ = true;
    target_ = target;
    each_first([&](auto space, auto i, int) noexcept {
      constexpr std::size_t kIndex = decltype(i)::value;
      using Distance = TaskDistance<decltype(space), Scalar>;
      const Scalar distance = Distance::between(std::get<kIndex>(target), std::get<kIndex>(tip), length);
      if (!(distance <= kNear)) std::get<kIndex>(target_) = std::get<kIndex>(tip);
    });
  }

  /// Calls f(space, i, row) for each task of the first level, as Space::each().
  template <typename F>
  static void each_first(const F& f) noexcept {
    Space::each([&](auto space, auto i, int row) noexcept {
      if constexpr (decltype(i)::value < static_cast<std::size_t>(Space::kFirst)) f(space, i, row);
    });
  }

  /// TaskDistance above which a task counts as not at its target: 1 mm for a robot of 1 m, a thousand times the error
  /// of a grasp (`bench_grasp`).
  static constexpr Scalar kNear = Scalar(1e-3);

  bool holds_ = false;
  Point target_ = Space::template origin<Scalar>();
};

/// Replaces HeldLevel in a tracker of a single level.
struct NoHeldLevel {
  template <typename References, typename Point, typename Scalar>
  static void hold(const References&, const Point&, const Scalar&) noexcept {}
  static void release() noexcept {}
};

}  // namespace fpbm
