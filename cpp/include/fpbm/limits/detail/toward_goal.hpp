#pragma once

#include "fpbm/limits/detail/goals.hpp"
#include "fpbm/limits/detail/one_level.hpp"

namespace fpbm {

/// Motion from `steady` toward a goal, as far as the bounds allow. saturation: saturation of one level or of several
/// levels. first: goal of the first level, as if there were no lower levels. found: the scales with which the goal was
/// found. The scales of the result are multiplied by the scales of `found`. Motions have the unit of the box, [rad/s²]
/// or [rad/s].
template <typename Saturation, typename Found, int N, int P, typename Scalar>
[[nodiscard]] Found toward_goal(Saturation& saturation, const Box<N, Scalar>& box, const Rows<N, P, Scalar>& rows,
                                const Vector<N, Scalar>& steady, const Vector<N, Scalar>& first,
                                const Vector<N, Scalar>& goal, const Found& found) noexcept {
  Found next = found;
  next.u = first;
  set_scale(next, Scalar(1));
  if (!(box.contains(first) && rows.admit(first))) {
    const Vector<N, Scalar> from = rows.near(steady, box);
    next = saturation(box, from, first);
    if (!is_finite(next.u)) {
      next.u = from;
      set_scale(next, Scalar(0));
      return next;
    }
  }
  resolve_lower(saturation, box, goal, next);
  multiply_scales(next, found);
  return next;
}

/// Second pass of Limiter with bounds on jerk: moves toward `found`, and the first level toward its motion `first`.
/// last: acceleration of the last tick. box: Limits::box() after `last`.
template <typename Tasks, Level kLevel, typename Saturation, typename Found, int N, int P, typename Scalar>
[[nodiscard]] Found second_pass(const Limits<kLevel, N, Scalar>& limits, Saturation& saturation,
                                const State<N, Scalar>& state, const Vector<N, Scalar>& last, const Box<N, Scalar>& box,
                                const Rows<N, P, Scalar>& rows, const Vector<N, Scalar>& first,
                                const Found& found) noexcept {
  const Vector<N, Scalar> steady = box.nearest(motions(limits, state.qd, last));
  if constexpr (kHasLower<Tasks>) {
    const auto goals = approach(limits, state.qd, first, found.u);
    return toward_goal(saturation, box, rows, steady, goals.first, goals.all, found);
  } else {
    const Vector<N, Scalar> goal = approach(limits, state.qd, found.u, found.u).first;
    return toward_goal(saturation, box, rows, steady, goal, goal, found);
  }
}

}  // namespace fpbm
