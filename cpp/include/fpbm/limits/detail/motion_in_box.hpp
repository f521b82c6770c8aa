#pragma once

#include <algorithm>

#include "fpbm/limits/detail/braking.hpp"
#include "fpbm/limits/detail/least_squares_blend.hpp"
#include "fpbm/limits/detail/one_level.hpp"

namespace fpbm {

/// Motion within a box that realises as much as possible of a desired motion, level by level. A step of Limiter.
template <Level kLevel, int N, int P, typename Scalar>
struct MotionInBox {
  using JointVector = Vector<N, Scalar>;

  const Limits<kLevel, N, Scalar>& limits;
  const State<N, Scalar>& state;
  const Box<N, Scalar>& box;
  const Rows<N, P, Scalar>& rows;
  bool compensates;  ///< Whether other joints compensate for a joint that returns from beyond its range.

  /// saturation: saturation_of(tasks). first: set to the motion of the first level alone, if there are lower levels.
  template <typename Saturation, typename Tasks>
  [[nodiscard]] auto resolve(Saturation& saturation, const Tasks& tasks, const JointVector& desired,
                             JointVector& first) const noexcept {
    auto found = resolve_first(saturation, tasks, first_motion(tasks, desired));
    if constexpr (kHasLower<Tasks>) {
      first = found.u;
      resolve_lower(saturation, box, desired, found);
    }
    return found;
  }

  /// First level of resolve(). If the result of the saturation is not finite, the arm brakes.
  template <typename Saturation, typename Tasks>
  [[nodiscard]] auto resolve_first(Saturation& saturation, const Tasks& tasks,
                                   const JointVector& desired) const noexcept {
    if (box.contains(desired)) return with_scale(tasks, desired, Scalar(1));
    const JointVector from = rest();
    auto found = saturation(box, from, desired);
    if (found.scale < Scalar(1)) {
      blend_with_least_squares<kLevel>(first_level(tasks), state.qd, box, rows, desired, found);
    }
    if (!is_finite(found.u)) {
      found.u = from;
      set_scale(found, Scalar(0));
    }
    return found;
  }

  /// Braking motion, or a motion near the braking motion that the rows admit. With `compensates`, in the box also for
  /// joints beyond their ranges.
  [[nodiscard]] JointVector rest() const noexcept {
    JointVector rest = brake_in_proportion(limits, state, box);
    const auto& bounds = limits.bounds();
    for (Eigen::Index i = 0; compensates && i < rest.size(); ++i) {
      if (state.q.coeff(i) < bounds.lower.coeff(i) || state.q.coeff(i) > bounds.upper.coeff(i)) {
        rest.coeffRef(i) = std::clamp(rest.coeff(i), box.lower.coeff(i), box.upper.coeff(i));
      }
    }
    return rows.near(rest, box);
  }
};

}  // namespace fpbm
