#pragma once

#include "fpbm/limits/limits.hpp"

namespace fpbm {

/// Limits::box_in_time(), with the same bits as the box of a tick where jerk does not set that box's bound.
///
/// The bound is the same number then, but each box finds it by iteration, to an error of its own. A goal beyond the
/// tick's bound by this error would let a joint on that bound hold back the whole motion.
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
