#pragma once

#include <cmath>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "fpbm/limits/detail/box_in_time.hpp"
#include "fpbm/limits/detail/braking.hpp"
#include "fpbm/limits/detail/inverse_task_metric.hpp"
#include "fpbm/limits/detail/motion_in_box.hpp"
#include "fpbm/limits/detail/reserved_limits.hpp"
#include "fpbm/limits/detail/row_projection.hpp"
#include "fpbm/limits/detail/toward_goal.hpp"
#include "fpbm/limits/limits.hpp"
#include "fpbm/linalg/detail/product.hpp"
#include "fpbm/linalg/detail/sums.hpp"

namespace fpbm {

/// Computes a motion within the joint limits from the motion of any scheme (docs/limits.md).
///
/// A motion within the box of Limits does not change. Otherwise the motion is saturated in the null space: other joints
/// compensate for joints on their bounds. If no joints can compensate, the task is scaled down along its direction. If
/// the task scale is nearly zero, for example at the workspace boundary, the arm would stop permanently. Therefore, the
/// smaller the scale, the more the motion is blended with a motion that still reduces the tip error
/// (blend_with_least_squares()).
///
/// With bounds on jerk, the limiter works in two passes (docs/limits.md, Bounds on jerk). The first pass ignores the
/// last tick, and determines the goal. The second pass starts from the acceleration of the last tick, and moves toward
/// the goal along the line of the task as far as the jerk bounds allow.
template <Level kLevel, int N, typename Scalar = double>
class Limiter {
 public:
  using JointVector = Vector<N, Scalar>;
  using JointState = State<N, Scalar>;
  /// Result of motion(): SaturatedMotion, or SaturatedLevels for TaskLevels.
  template <typename Tasks>
  using Result = decltype(with_scale(std::declval<const Tasks&>(), std::declval<const JointVector&>(), Scalar(1)));

  /// reserve: fraction of each bound on acceleration that the lower levels leave to the first level. Of each bound on
  /// velocity, the lower levels leave reserve/2. compensates: whether other joints compensate for a joint that returns
  /// from beyond its range. Throws std::invalid_argument unless 0 ≤ reserve ≤ 1.
  explicit Limiter(const Limits<kLevel, N, Scalar>& limits, Scalar reserve = Scalar(0), bool compensates = false)
      : limits_(limits),
        lower_limits_(reserved_limits(limits, reserve)),
        reserves_(reserve > Scalar(0)),
        compensates_(compensates),
        unit_(limits.bounds().acceleration) {
    for (Eigen::Index i = 0; i < unit_.size(); ++i) unit_(i) = std::isfinite(unit_(i)) ? unit_(i) : Scalar(1);
  }

  [[nodiscard]] const Limits<kLevel, N, Scalar>& limits() const noexcept { return limits_; }

  /// Whether the limits, minus the reserve, admit a tick from one state to another. An admitted tick needs no limiter.
  [[nodiscard]] bool admits(const JointState& from, const JointState& to, const JointVector& last) const noexcept {
    return lower_limits_.admits(from, to, last);
  }

  /// Motion within the limits for a desired qdd [rad/s²], or qd [rad/s] at velocity level, where state.qd is the last
  /// command. `last`: acceleration of the last tick [rad/s²], used by bounds on jerk.
  ///
  /// tasks: Jacobian of one task level, or TaskLevels, which are saturated level by level (StackSaturation). rows:
  /// further bounds on the motion (RowProjection), kept as far as the limits admit.
  template <typename Tasks, int P = 0>
  [[nodiscard]] Result<Tasks> motion(const Tasks& tasks, const JointState& state, const JointVector& desired,
                                     const JointVector& last, const Rows<N, P, Scalar>& rows = {}) const noexcept {
    if constexpr (P > 0) {
      const bool first_admitted = !kHasLower<Tasks> || rows.admit(first_motion(tasks, desired));
      if (!first_admitted || !rows.admit(desired)) return limit_with_rows(rows, tasks, state, desired, last);
    }
    return bounded(tasks, state, desired, last, rows);
  }

  /// motion() if the last acceleration has no effect: without bounds on jerk, or at rest.
  template <typename Tasks>
  [[nodiscard]] Result<Tasks> motion(const Tasks& tasks, const JointState& state,
                                     const JointVector& desired) const noexcept {
    return motion(tasks, state, desired, JointVector::Zero(state.q.size()));
  }

  /// Motion that resolves the first level as `desired` does, and brakes in the null space of the first level.
  template <typename Tasks, int P = 0>
  [[nodiscard]] Result<Tasks> stop_on_first_level(const Tasks& tasks, const JointState& state,
                                                  const JointVector& desired, const JointVector& last,
                                                  const Rows<N, P, Scalar>& rows = {}) const noexcept {
    const JointVector rest = brake_in_proportion(limits_, state, limits_.box(state, last));
    const JointVector goal = desired + null_space_motion(only_first(tasks), JointVector(rest - desired));
    return motion(only_first(tasks), state, goal, last, rows);
  }

  /// Braking motion, or a motion near the braking motion that the rows admit. The task scale is 0.
  template <int P = 0>
  [[nodiscard]] SaturatedMotion<N, Scalar> brake(const JointState& state, const JointVector& last,
                                                 const Rows<N, P, Scalar>& rows = {}) const noexcept {
    return {rows.near(fpbm::brake(limits_, state, last), limits_.box(state, last)), Scalar(0), 0, 0};
  }

 private:
  /// motion() for a desired motion u₀ that the rows do not admit: limits the nearest motion u that the rows admit
  /// (inverse_task_metric()). The first level follows its own motion, changed as if there were no lower levels. The
  /// relative change of level k is c = min(‖J_k(u − u₀)‖/‖J_k u₀‖, 1). If c > kNegligibleChange, the task scale of the
  /// level is multiplied by 1 − c.
  template <typename Tasks, int P>
  [[nodiscard]] Result<Tasks> limit_with_rows(const Rows<N, P, Scalar>& rows, const Tasks& tasks,
                                              const JointState& state, const JointVector& desired,
                                              const JointVector& last) const noexcept {
    const auto& J = first_level(tasks);
    constexpr int M = std::decay_t<decltype(J)>::RowsAtCompileTime;
    std::uint64_t active = 0;
    const auto admitted = [&](const JointVector& u) noexcept {
      RowProjection<M, N, P, Scalar> projection(J, inverse_task_metric(J, rows, u), rows);
      const JointVector nearest = projection(u);
      active |= projection.active();
      return nearest;
    };
    const JointVector& own = first_motion(tasks, desired);
    const JointVector first = admitted(own);
    const auto removed = [](const JointVector& from, const JointVector& to) noexcept {
      return [&from, change = JointVector(to - from)](const auto& level) noexcept {
        const Scalar lost = norm(product(level, change));
        const Scalar task = norm(product(level, from));
        if (!(lost > kNegligibleChange * task)) return Scalar(1);
        return lost < task ? Scalar(1) - lost / task : Scalar(0);
      };
    };
    const auto limited = [&](const Tasks& changed, const JointVector& all) noexcept {
      Result<Tasks> found = bounded(changed, state, all, last, rows);
      found.rows |= active;
      multiply_scales(found, tasks, removed(own, first), removed(desired, all));
      return found;
    };
    if constexpr (kHasLower<Tasks>) {
      JointVector all = first;
      if (&own != &desired) all += null_space_motion(only_first(tasks), JointVector(admitted(desired) - first));
      Tasks changed = tasks;
      changed.set_first_motion(first);
      return limited(changed, all);
    } else {
      return limited(tasks, first);
    }
  }

  /// motion() for a desired motion that the rows admit, at least approximately.
  template <typename Tasks, int P>
  [[nodiscard]] Result<Tasks> bounded(const Tasks& tasks, const JointState& state, const JointVector& desired,
                                      const JointVector& last, const Rows<N, P, Scalar>& rows) const noexcept {
    const Box<N, Scalar> box = limits_.box(state, last);
    if constexpr (kHasLower<Tasks>) {
      if (reserves_) return with_reserve(tasks, state, desired, last, rows, box);
    }
    if (box.contains(desired)) return with_scale(tasks, desired, Scalar(1));
    auto saturation = saturation_of(tasks, unit_, rows);
    JointVector first;
    const auto resolve = [&](const Box<N, Scalar>& within) noexcept {
      const MotionInBox<kLevel, N, P, Scalar> in_box{limits_, state, within, rows, compensates_};
      return in_box.resolve(saturation, tasks, desired, first);
    };
    if (!limits_.bounds_jerk()) return resolve(box);
    const Result<Tasks> found = resolve(box_in_time(limits_, state, last, box));
    return second_pass<Tasks>(limits_, saturation, state, last, box, rows, first, found);
  }

  /// bounded() with a reserve. If the own motion of the first level exceeds the limits minus the reserve, the first
  /// level is resolved within the whole limits, with a braking motion in its null space. The lower levels are resolved
  /// within the limits minus the reserve, widened to include the motion of the first level.
  template <typename Tasks, int P>
  [[nodiscard]] Result<Tasks> with_reserve(const Tasks& tasks, const JointState& state, const JointVector& desired,
                                           const JointVector& last, const Rows<N, P, Scalar>& rows,
                                           const Box<N, Scalar>& box) const noexcept {
    const bool jerk = limits_.bounds_jerk();
    const Box<N, Scalar> whole = jerk ? box_in_time(limits_, state, last, box) : box;
    Box<N, Scalar> lower = jerk ? lower_limits_.box_in_time(state) : lower_limits_.box(state, last);
    lower = {whole.nearest(lower.lower), whole.nearest(lower.upper)};
    auto saturation = saturation_of(tasks, unit_, rows);
    const JointVector& own = first_motion(tasks, desired);
    Result<Tasks> found = with_scale(tasks, own, Scalar(1));
    if (!lower.contains(own)) {
      const MotionInBox<kLevel, N, P, Scalar> in_whole{limits_, state, whole, rows, compensates_};
      const JointVector braking = null_space_motion(only_first(tasks), JointVector(in_whole.rest() - own));
      found = in_whole.resolve_first(saturation, tasks, own + braking);
    }
    const JointVector first = found.u;
    lower = {lower.lower.cwiseMin(first), lower.upper.cwiseMax(first)};
    resolve_lower(saturation, lower, desired, found);
    return jerk ? second_pass<Tasks>(limits_, saturation, state, last, box, rows, first, found) : found;
  }

  /// Largest relative change c of a level that does not reduce the task scale: a definition. The cost μ of null-space
  /// motion (inverse_task_metric()) causes a small c (LimiterRows.scale_the_task_by_its_relative_change).
  static constexpr Scalar kNegligibleChange = Scalar(0.01);

  Limits<kLevel, N, Scalar> limits_;
  Limits<kLevel, N, Scalar> lower_limits_;  ///< Limits of the levels below the first level.
  bool reserves_;
  bool compensates_;
  JointVector unit_;  ///< Unit of each joint's null-space motion.
};

}  // namespace fpbm
