#pragma once

#include "fpbm/limits/limits.hpp"

namespace fpbm {

/// Limits::box_in_time(), where the bounds that the bound on jerk does not restrict are copied from `tick` bit for bit.
/// tick: Limits::box() for this tick. last: acceleration of the last tick.
///
/// Limits::box_in_time() and Limits::box() compute the bounds by iteration, with different errors. If a goal exceeded a
/// bound of `tick` by the difference of the errors, the whole motion would be scaled down because of a joint on this
/// bound.
template <Level kLevel, int N, typename Scalar>
[[nodiscard]] Box<N, Scalar> box_in_time(const Limits<kLevel, N, Scalar>& limits, const State<N, Scalar>& state,
                                         const Vector<N, Scalar>& last, const Box<N, Scalar>& tick) noexcept {
  Box<N, Scalar> box = limits.box_in_time(state);
  for (Eigen::Index i = 0; i < last.size(); ++i) {
    if (!limits.bounds_jerk(i)) continue;
    const auto [least, most] = limits.jerk_limited(i).after(last(i));
    const Scalar low = limits.motion(state.qd(i), least);
    const Scalar high = limits.motion(state.qd(i), most);
    if (low < tick.upper(i) && tick.upper(i) < high) box.upper(i) = tick.upper(i);
    if (low < tick.lower(i) && tick.lower(i) < high) box.lower(i) = tick.lower(i);
  }
  return box;
}

}  // namespace fpbm
