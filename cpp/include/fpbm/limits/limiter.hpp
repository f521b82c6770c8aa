#pragma once

#include <algorithm>
#include <type_traits>
#include <utility>

#include "fpbm/limits/box_in_time.hpp"
#include "fpbm/limits/braking.hpp"
#include "fpbm/limits/inverse_task_metric.hpp"
#include "fpbm/limits/least_squares_blend.hpp"
#include "fpbm/limits/limits.hpp"
#include "fpbm/limits/one_level.hpp"
#include "fpbm/limits/reserved_limits.hpp"
#include "fpbm/limits/row_projection.hpp"
#include "fpbm/limits/tick_motions.hpp"
#include "fpbm/limits/toward_goal.hpp"
#include "fpbm/linalg/product.hpp"
#include "fpbm/linalg/sums.hpp"

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

  /// reserve: fraction of each joint's bound on acceleration that the levels below the first level leave to the first
  /// level. The lower levels leave reserve/2 of the bound on velocity. 0: the first level has no reserve, and all
  /// levels share the limits. compensates: whether other joints compensate for a joint that returns from beyond its
  /// range. Throws std::invalid_argument if reserve is not in [0, 1].
  explicit Limiter(const Limits<kLevel, N, Scalar>& limits, Scalar reserve = Scalar(0), bool compensates = false)
      : limits_(limits),
        lower_limits_(reserved_limits(limits, reserve)),
        reserves_(reserve > Scalar(0)),
        compensates_(compensates),
        unit_(limits.bounds().acceleration) {
    for (Eigen::Index i = 0; i < unit_.size(); ++i) {
      if (!std::isfinite(unit_(i))) unit_(i) = Scalar(1);
    }
  }

  [[nodiscard]] const Limits<kLevel, N, Scalar>& limits() const noexcept { return limits_; }

  /// Whether the limits, minus the reserve, admit a tick from one state to another. An admitted tick needs no limiter.
  [[nodiscard]] bool admits(const JointState& from, const JointState& to, const JointVector& last) const noexcept {
    return lower_limits_.admits(from, to, last);
  }

  /// Motion within the limits for a desired qdd [rad/s²], or qd [rad/s] at velocity level, where state.qd is the last
  /// command. `last`: acceleration of the last tick [rad/s²], used by bounds on jerk.
  ///
  /// tasks: Jacobian of one task level, or TaskLevels, which are saturated level by level (SaturationByLevel). rows:
  /// further bounds on the motion (RowProjection), kept as far as the limits admit.
  template <typename Tasks, int P = 0>
  [[nodiscard]] Result<Tasks> motion(const Tasks& tasks, const JointState& state, const JointVector& desired,
                                     const JointVector& last, const Rows<N, P, Scalar>& rows = {}) const noexcept {
    if constexpr (P > 0) {
      if (!rows.admit(desired)) return limit_with_rows(rows, tasks, state, desired, last);
    }
    return bounded(tasks, state, desired, last, rows);
  }

  /// motion() if the last acceleration has no effect: without bounds on jerk, or at rest.
  template <typename Tasks>
  [[nodiscard]] Result<Tasks> motion(const Tasks& tasks, const JointState& state,
                                     const JointVector& desired) const noexcept {
    return motion(tasks, state, desired, JointVector::Zero(state.q.size()));
  }

  /// Motion that resolves the first level as `desired` does, and brakes the joints in the null space of the first
  /// level.
  template <typename Tasks, int P = 0>
  [[nodiscard]] Result<Tasks> stop_on_first_level(const Tasks& tasks, const JointState& state,
                                                  const JointVector& desired, const JointVector& last,
                                                  const Rows<N, P, Scalar>& rows = {}) const noexcept {
    const JointVector rest = brake_in_proportion(limits_, state, limits_.box(state, last));
    return motion(only_first(tasks), state, braking_in_null_space(tasks, desired, rest), last, rows);
  }

  /// Braking motion, or a motion near the braking motion that the rows admit. The task scale is 0.
  template <int P = 0>
  [[nodiscard]] SaturatedMotion<N, Scalar> brake(const JointState& state, const JointVector& last,
                                                 const Rows<N, P, Scalar>& rows = {}) const noexcept {
    return {rows.near(fpbm::brake(limits_, state, last), limits_.box(state, last)), Scalar(0), 0, 0};
  }

 private:
  /// motion() for a desired motion u₀ that the rows do not admit: limits the nearest motion u that the rows admit
  /// (inverse_task_metric()). The relative change of level k is c = min(‖J_k(u − u₀)‖/‖J_k u₀‖, 1). If
  /// c > kNegligibleChange, the task scale of the level is multiplied by 1 − c.
  template <typename Tasks, int P>
  [[nodiscard]] Result<Tasks> limit_with_rows(const Rows<N, P, Scalar>& rows, const Tasks& tasks,
                                              const JointState& state, const JointVector& desired,
                                              const JointVector& last) const noexcept {
    const auto& J = first_level(tasks);
    constexpr int M = std::decay_t<decltype(J)>::RowsAtCompileTime;
    RowProjection<M, N, P, Scalar> projection(J, inverse_task_metric(J, rows, desired), rows);
    const JointVector admitted = projection(desired);
    Result<Tasks> found = bounded(tasks, state, admitted, last, rows);
    found.rows |= projection.active();
    const JointVector change =
        entrywise(admitted, [&](Eigen::Index i) { return admitted.coeff(i) - desired.coeff(i); });
    multiply_scales(found, tasks, [&](const auto& level) noexcept {
      const Scalar removed = norm(product(level, change));
      const Scalar task = norm(product(level, desired));
      if (!(removed > kNegligibleChange * task)) return Scalar(1);
      return removed < task ? Scalar(1) - removed / task : Scalar(0);
    });
    return found;
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
    if (!limits_.bounds_jerk()) return within(saturation, tasks, state, box, rows, desired);
    const Result<Tasks> found = within(saturation, tasks, state, box_in_time(limits_, state, last, box), rows, desired);
    return toward_goal(saturation, box, rows, box.nearest(motions(limits_, state.qd, last)),
                       approach(limits_, state.qd, found.u), found);
  }

  /// u + N₁(r − u): resolves the first level as u does, and equals the braking motion r in the null space of the first
  /// level.
  template <typename Tasks>
  [[nodiscard]] static JointVector braking_in_null_space(const Tasks& tasks, const JointVector& u,
                                                         const JointVector& r) noexcept {
    return u + null_space_motion(only_first(tasks), JointVector(r - u));
  }

  /// bounded() with a reserve. The first level is resolved within the whole limits, with a braking motion in its null
  /// space. The lower levels are resolved within the limits minus the reserve, widened to include the motion of the
  /// first level.
  template <typename Tasks, int P>
  [[nodiscard]] Result<Tasks> with_reserve(const Tasks& tasks, const JointState& state, const JointVector& desired,
                                           const JointVector& last, const Rows<N, P, Scalar>& rows,
                                           const Box<N, Scalar>& box) const noexcept {
    const bool jerk = limits_.bounds_jerk();
    const Box<N, Scalar> whole = jerk ? box_in_time(limits_, state, last, box) : box;
    Box<N, Scalar> lower = jerk ? lower_limits_.box_in_time(state) : lower_limits_.box(state, last);
    lower = {whole.nearest(lower.lower), whole.nearest(lower.upper)};
    auto saturation = saturation_of(tasks, unit_, rows);
    Result<Tasks> found = with_scale(tasks, desired, Scalar(1));
    if (!lower.contains(desired)) {
      const JointVector rest = rows.near(braking(state, whole), whole);
      const JointVector first = braking_in_null_space(tasks, desired, rest);
      found = saturation(whole, rest, first);
      if (found.scale < Scalar(1)) {
        blend_with_least_squares<kLevel>(first_level(tasks), state.qd, whole, rows, first, found);
      }
      if (!is_finite(found.u)) {
        found.u = rest;
        set_scale(found, Scalar(0));
      } else {
        lower = {lower.lower.cwiseMin(found.u), lower.upper.cwiseMax(found.u)};
        resolve_lower(saturation, lower, desired, found);
      }
    }
    if (!jerk) return found;
    return toward_goal(saturation, box, rows, box.nearest(motions(limits_, state.qd, last)),
                       approach(limits_, state.qd, found.u), found);
  }

  /// Braking motion for saturation. With compensates_, in the box also for joints beyond their ranges, so that other
  /// joints compensate for their return.
  [[nodiscard]] JointVector braking(const JointState& state, const Box<N, Scalar>& box) const noexcept {
    JointVector rest = brake_in_proportion(limits_, state, box);
    const auto& bounds = limits_.bounds();
    for (Eigen::Index i = 0; compensates_ && i < rest.size(); ++i) {
      if (state.q.coeff(i) < bounds.lower.coeff(i) || state.q.coeff(i) > bounds.upper.coeff(i)) {
        rest.coeffRef(i) = std::clamp(rest.coeff(i), box.lower.coeff(i), box.upper.coeff(i));
      }
    }
    return rest;
  }

  /// Motion within the bounds that realises as much as possible of the desired motion.
  template <typename Saturation, typename Tasks, int P>
  [[nodiscard]] Result<Tasks> within(Saturation& saturation, const Tasks& tasks, const JointState& state,
                                     const Box<N, Scalar>& box, const Rows<N, P, Scalar>& rows,
                                     const JointVector& desired) const noexcept {
    if (box.contains(desired)) return with_scale(tasks, desired, Scalar(1));
    const JointVector rest = rows.near(braking(state, box), box);
    Result<Tasks> found = saturation(box, rest, desired);
    if (found.scale < Scalar(1)) {
      blend_with_least_squares<kLevel>(first_level(tasks), state.qd, box, rows, desired, found);
    }
    if (is_finite(found.u)) {
      resolve_lower(saturation, box, desired, found);
    } else {
      found.u = rest;
      set_scale(found, Scalar(0));
    }
    return found;
  }

  /// Largest relative change c of a level in limit_with_rows() with which the task scale is not reduced. The value is a
  /// definition. The cost μ of null-space motion (inverse_task_metric()) causes a small c, which is not reported as a
  /// blocked task (LimiterRows.scale_the_task_by_its_relative_change).
  static constexpr Scalar kNegligibleChange = Scalar(0.01);

  Limits<kLevel, N, Scalar> limits_;
  Limits<kLevel, N, Scalar> lower_limits_;  ///< Limits of the levels below the first level.
  bool reserves_;
  bool compensates_;
  JointVector unit_;  ///< Unit of each joint's null-space motion.
};

}  // namespace fpbm
