#pragma once

#include "fpbm/core/detail/validation.hpp"
#include "fpbm/limits/limits.hpp"

namespace fpbm {

/// Limits of the levels below the first level, which leave a reserve to the first level: the bounds on acceleration and
/// deceleration are multiplied by 1 − reserve, the bounds on velocity by 1 − reserve/2. Throws std::invalid_argument if
/// reserve is not in [0, 1].
template <Level kLevel, int N, typename Scalar>
[[nodiscard]] Limits<kLevel, N, Scalar> reserved_limits(const Limits<kLevel, N, Scalar>& limits, Scalar reserve) {
  validation::require_fraction("reserve", reserve);
  if (!(reserve > Scalar(0))) return limits;
  JointLimits<N, Scalar> bounds = limits.bounds();
  for (Eigen::Index i = 0; i < bounds.velocity.size(); ++i) {
    bounds.velocity(i) *= Scalar(1) - reserve / Scalar(2);
    bounds.acceleration(i) *= Scalar(1) - reserve;
    bounds.deceleration(i) *= Scalar(1) - reserve;
  }
  return Limits<kLevel, N, Scalar>(bounds, limits.tick());
}

}  // namespace fpbm
