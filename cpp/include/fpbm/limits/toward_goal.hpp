#pragma once

#include "fpbm/limits/one_level.hpp"

namespace fpbm {

/// Motion from `steady` toward a goal, as far as the bounds allow. saturation: saturation of one level or of several
/// levels. found: the scales with which the goal was found. The scales of the result are multiplied by the scales of
/// `found`. Motions have the unit of the box, [rad/s²] or [rad/s].
template <typename Saturation, typename Found, int N, int P, typename Scalar>
[[nodiscard]] Found toward_goal(Saturation& saturation, const Box<N, Scalar>& box, const Rows<N, P, Scalar>& rows,
                                const Vector<N, Scalar>& steady, const Vector<N, Scalar>& goal,
                                const Found& found) noexcept {
  Found next = found;
  next.u = goal;
  if (box.contains(goal) && rows.admit(goal)) return next;
  const Vector<N, Scalar> from = rows.near(steady, box);
  next = saturation(box, from, goal);
  if (is_finite(next.u)) {
    resolve_lower(saturation, box, goal, next);
    multiply_scales(next, found);
  } else {
    next.u = from;
    set_scale(next, Scalar(0));
  }
  return next;
}

}  // namespace fpbm
