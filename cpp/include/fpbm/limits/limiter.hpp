#pragma once

#include <type_traits>
#include <utility>

#include "fpbm/limits/box_in_time.hpp"
#include "fpbm/limits/braking.hpp"
#include "fpbm/limits/limits.hpp"
#include "fpbm/limits/one_level.hpp"
#include "fpbm/limits/reserved_limits.hpp"
#include "fpbm/limits/row_projection.hpp"
#include "fpbm/limits/task_given_up.hpp"
#include "fpbm/limits/tick_motions.hpp"
#include "fpbm/limits/toward_goal.hpp"
#include "fpbm/limits/yield.hpp"
#include "fpbm/linalg/product.hpp"
#include "fpbm/linalg/sums.hpp"

namespace fpbm {

/// Makes any scheme keep the joint limits: takes the scheme's answer, returns a motion within the limits.
///
/// A motion within the box of Limits passes unchanged. Otherwise it is saturated in the null space, so that other
/// joints take over; where they cannot, the task is scaled down along its direction. Where the scale comes near zero
/// (at the edge of the reach, say) the arm would stand still for good; so the smaller the scale, the more the motion
/// yields to the one that still brings the tip nearer.
///
/// With bounds on jerk this is done twice: first without regard to the last tick, to find where the motion is to go;
/// then, from the last tick's acceleration toward that, as far along the task's line as the jerks allow.
template <Level kLevel, int N, typename Scalar = double>
class Limiter {
 public:
  using JointVector = Vector<N, Scalar>;
  using JointState = State<N, Scalar>;
  /// Saturated, or SaturatedLevels for TaskLevels.
  template <typename Tasks>
  using Found = decltype(with_scale(std::declval<const Tasks&>(), std::declval<const JointVector&>(), Scalar(1)));

  /// reserve: share of each joint's bound on acceleration that the levels below the first leave to the first, and half
  /// of that share of the bound on velocity. 0: the first level has no reserve, and all levels share the limits. Throws
  /// std::invalid_argument where it is not in [0, 1].
  explicit Limiter(const Limits<kLevel, N, Scalar>& limits, Scalar reserve = Scalar(0))
      : limits_(limits),
        lower_limits_(reserved_limits(limits, reserve)),
        reserves_(reserve > Scalar(0)),
        unit_(limits.bounds().acceleration) {
    for (Eigen::Index i = 0; i < unit_.size(); ++i) {
      if (!std::isfinite(unit_(i))) unit_(i) = Scalar(1);
    }
  }

  [[nodiscard]] const Limits<kLevel, N, Scalar>& limits() const noexcept { return limits_; }

  /// Whether an arm may go from one state to another in a tick without being limited.
  [[nodiscard]] bool admits(const JointState& from, const JointState& to, const JointVector& last) const noexcept {
    return lower_limits_.admits(from, to, last);
  }

  /// The motion within the limits for a desired qdd, or qd at velocity level, where the state's qd is the last command.
  /// last: acceleration of the last tick, which bounds on jerk start from.
  ///
  /// tasks: the Jacobian of one task level, or TaskLevels, which are saturated level by level (SaturationByLevel).
  /// rows: further bounds on the motion (RowProjection), kept as far as the limits admit.
  template <typename Tasks, int P = 0>
  [[nodiscard]] Found<Tasks> motion(const Tasks& tasks, const JointState& state, const JointVector& desired,
                                    const JointVector& last, const Rows<N, P, Scalar>& rows = {}) const noexcept {
    if constexpr (P > 0) {
      if (!rows.admit(desired)) return beside(rows, tasks, state, desired, last);
    }
    return bounded(tasks, state, desired, last, rows);
  }

  /// The motion for an arm whose last acceleration does not matter: without bounds on jerk, or at rest.
  template <typename Tasks>
  [[nodiscard]] Found<Tasks> motion(const Tasks& tasks, const JointState& state,
                                    const JointVector& desired) const noexcept {
    return motion(tasks, state, desired, JointVector::Zero(state.q.size()));
  }

  /// The motion that resolves the first level as `desired` does, and brings the joints to rest in its null space.
  template <typename Tasks, int P = 0>
  [[nodiscard]] Found<Tasks> stop_on_first_level(const Tasks& tasks, const JointState& state,
                                                 const JointVector& desired, const JointVector& last,
                                                 const Rows<N, P, Scalar>& rows = {}) const noexcept {
    const JointVector rest = brake_in_proportion(limits_, state, limits_.box(state, last));
    return motion(only_first(tasks), state, braking_beside(tasks, desired, rest), last, rows);
  }

  /// The motion that brings the arm to rest, or one near to it that rows admit.
  template <int P = 0>
  [[nodiscard]] Saturated<N, Scalar> brake(const JointState& state, const JointVector& last,
                                           const Rows<N, P, Scalar>& rows = {}) const noexcept {
    return {rows.near(fpbm::brake(limits_, state, last), limits_.box(state, last)), Scalar(0), 0, 0};
  }

 private:
  /// motion() for a motion that rows do not admit: the nearest that they admit replaces it. Self-motion costs little,
  /// so that joints go around a row where they can and the tip slides along it where they cannot. But where self-motion
  /// can do next to nothing, what the tip has to give up costs less still, else joints would rush for that little.
  template <typename Tasks, int P>
  [[nodiscard]] Found<Tasks> beside(const Rows<N, P, Scalar>& rows, const Tasks& tasks, const JointState& state,
                                    const JointVector& desired, const JointVector& last) const noexcept {
    const auto& J = first_level(tasks);
    constexpr int M = std::decay_t<decltype(J)>::RowsAtCompileTime;
    const Scalar mu = kSelfMotion * squared_norm(J);
    const auto [given_up, self_motion] = task_given_up(J, mu, rows, desired);
    const Scalar square = squared_norm(given_up);
    const Scalar lacks = std::max(Scalar(1) - self_motion / kServes, Scalar(0));
    Matrix<M, M, Scalar> B;
    B.resize(J.rows(), J.rows());
    const Scalar price = square > Scalar(0) ? lacks * lacks * mu / kGivenUp / square : Scalar(0);
    for (Eigen::Index j = 0; j < J.rows(); ++j) {
      for (Eigen::Index i = 0; i < J.rows(); ++i) {
        B.coeffRef(i, j) = price * given_up.coeff(i) * given_up.coeff(j) + (i == j ? mu : Scalar(0));
      }
    }
    RowProjection<M, N, P, Scalar> projection(J, B, rows);
    const JointVector wanted = projection(desired);
    Found<Tasks> found = bounded(tasks, state, wanted, last, rows);
    found.rows |= projection.active();
    const JointVector change = entrywise(wanted, [&](Eigen::Index i) { return wanted.coeff(i) - desired.coeff(i); });
    multiply_scales(found, tasks, [&](const auto& level) noexcept {
      const Scalar lost = norm(product(level, change));
      const Scalar task = norm(product(level, desired));
      if (!(lost > kUnseen * task)) return Scalar(1);
      return lost < task ? Scalar(1) - lost / task : Scalar(0);
    });
    return found;
  }

  /// motion() for one that rows admit, or nearly.
  template <typename Tasks, int P>
  [[nodiscard]] Found<Tasks> bounded(const Tasks& tasks, const JointState& state, const JointVector& desired,
                                     const JointVector& last, const Rows<N, P, Scalar>& rows) const noexcept {
    const Box<N, Scalar> box = limits_.box(state, last);
    if constexpr (kHasLower<Tasks>) {
      if (reserves_) return with_reserve(tasks, state, desired, last, rows, box);
    }
    if (box.contains(desired)) return with_scale(tasks, desired, Scalar(1));
    auto saturation = saturation_of(tasks, unit_, rows);
    if (!limits_.bounds_jerk()) return within(saturation, tasks, state, box, rows, desired);
    const Found<Tasks> found = within(saturation, tasks, state, box_in_time(limits_, state, last, box), rows, desired);
    return toward_goal(saturation, box, rows, box.nearest(motions(limits_, state.qd, last)),
                       approach(limits_, state.qd, found.u), found);
  }

  /// u + N₁(r − u): the first level as in u, and the braking motion r in its null space.
  template <typename Tasks>
  [[nodiscard]] static JointVector braking_beside(const Tasks& tasks, const JointVector& u,
                                                  const JointVector& r) noexcept {
    return u + null_space_motion(only_first(tasks), JointVector(r - u));
  }

  /// bounded() where the lower levels leave a reserve: the first level alone brakes within the limits, the lower levels
  /// move within those of the reserve, widened by the motion of the first level.
  template <typename Tasks, int P>
  [[nodiscard]] Found<Tasks> with_reserve(const Tasks& tasks, const JointState& state, const JointVector& desired,
                                          const JointVector& last, const Rows<N, P, Scalar>& rows,
                                          const Box<N, Scalar>& box) const noexcept {
    const bool jerk = limits_.bounds_jerk();
    const Box<N, Scalar> whole = jerk ? box_in_time(limits_, state, last, box) : box;
    Box<N, Scalar> lower = jerk ? lower_limits_.box_in_time(state) : lower_limits_.box(state, last);
    lower = {whole.nearest(lower.lower), whole.nearest(lower.upper)};
    auto saturation = saturation_of(tasks, unit_, rows);
    Found<Tasks> found = with_scale(tasks, desired, Scalar(1));
    if (!lower.contains(desired)) {
      const JointVector rest = rows.near(brake_in_proportion(limits_, state, whole), whole);
      const JointVector wanted = braking_beside(tasks, desired, rest);
      found = saturation(whole, rest, wanted);
      if (found.scale < Scalar(1)) yield<kLevel>(first_level(tasks), state.qd, whole, rows, wanted, found);
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

  /// The motion within bounds that does as much as possible of a desired one.
  template <typename Saturation, typename Tasks, int P>
  [[nodiscard]] Found<Tasks> within(Saturation& saturation, const Tasks& tasks, const JointState& state,
                                    const Box<N, Scalar>& box, const Rows<N, P, Scalar>& rows,
                                    const JointVector& desired) const noexcept {
    if (box.contains(desired)) return with_scale(tasks, desired, Scalar(1));
    const JointVector rest = rows.near(brake_in_proportion(limits_, state, box), box);
    Found<Tasks> found = saturation(box, rest, desired);
    if (found.scale < Scalar(1)) yield<kLevel>(first_level(tasks), state.qd, box, rows, desired, found);
    if (is_finite(found.u)) {
      resolve_lower(saturation, box, desired, found);
    } else {
      found.u = rest;
      set_scale(found, Scalar(0));
    }
    return found;
  }

  static constexpr Scalar kSelfMotion = Scalar(1e-4);  ///< Price of self-motion along rows, as a share of ‖J‖²_F.
  static constexpr Scalar kGivenUp = Scalar(1e-3);     ///< Price of what the task gives up, as a share of the rest.
  static constexpr Scalar kServes = Scalar(0.1);       ///< From here on self-motion serves: ‖Nv‖² / ‖v‖².
  static constexpr Scalar kUnseen = Scalar(0.01);      ///< Share of the task that may be lost unreported.

  Limits<kLevel, N, Scalar> limits_;
  Limits<kLevel, N, Scalar> lower_limits_;  ///< Of the levels below the first.
  bool reserves_;
  JointVector unit_;  ///< Unit of each joint's motion in the null space.
};

}  // namespace fpbm
