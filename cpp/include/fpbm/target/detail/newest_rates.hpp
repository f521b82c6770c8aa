#pragma once

#include <array>
#include <cstddef>
#include <numeric>

#include "fpbm/geometry/detail/chart_rates.hpp"

namespace fpbm {

/// Velocity and acceleration at the newest of `count` + 1 points, of the polynomial through the points (Newton's form).
/// From the newest to the oldest: h: times between two points [s], q: mean velocities between two points.
template <typename Scalar, typename Twist, std::size_t Capacity>
[[nodiscard]] Rates<Twist> newest_rates(const std::array<Scalar, Capacity>& h, std::array<Twist, Capacity> q,
                                        std::size_t count) noexcept {
  Rates<Twist> rates{q[0], Scalar(0) * q[0]};
  // First and second derivative, at the newest point, of the product of the differences to the points.
  Scalar distance = h[0];
  Scalar first = h[0];
  Scalar second(2);
  for (std::size_t order = 1; order < count; ++order) {
    for (std::size_t k = 0; k + order < count; ++k) {
      const Scalar* from = h.data() + k;
      q[k] = (q[k] - q[k + 1]) / std::accumulate(from, from + order + 1, Scalar(0));
    }
    rates.xd += first * q[0];
    rates.xdd += second * q[0];
    distance += h[order];
    second = second * distance + Scalar(2) * first;
    first *= distance;
  }
  return rates;
}

}  // namespace fpbm
