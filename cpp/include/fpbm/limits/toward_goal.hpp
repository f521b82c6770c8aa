#pragma once

#include "fpbm/limits/one_level.hpp"

namespace fpbm {

/// From a motion `steady` as far toward a goal as bounds allow. found: the scales of the goal, which the result
/// multiplies by its own. saturation: of one level or several.
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
