#pragma once

#include <algorithm>

#include "fpbm/bound/bounds.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/linalg/detail/entrywise.hpp"

namespace fpbm {

/// The gaps of bounds that are below kBuffer in a posture: rows of a search, ∇s·Δq = kBuffer − s.
template <int N, typename Scalar>
struct NearGaps {
  /// Distance that a search keeps beyond a bound [m], so that a posture with a small error keeps the bound. A choice:
  /// larger than the tolerance, and smaller than the errors of measured obstacles.
  static constexpr Scalar kBuffer = Scalar(1e-4);
  /// Largest number of rows: the gaps that are the most negative. As PairRows::kPairs.
  static constexpr int kMost = 16;

  Matrix<N, kMost, Scalar> gradients;
  Vector<kMost, Scalar> beyond;  ///< kBuffer − s [m].
  Eigen::Index count;
  Scalar cost;  ///< Σ (kBuffer − s)² over all gaps below kBuffer, also those without a row.

  template <typename Bounds_>
  void set(Bounds_& bounds, const Vector<N, Scalar>& q) noexcept {
    gradients.resize(q.size(), kMost);
    count = 0;
    cost = Scalar(0);
    bounds.gaps(q, kBuffer, [&](Scalar gap, const Vector<N, Scalar>& gradient) noexcept {
      const Scalar size = kBuffer - gap;
      cost += size * size;
      Eigen::Index k = count;
      if (count < kMost) {
        ++count;
      } else {
        k = std::min_element(beyond.data(), beyond.data() + kMost) - beyond.data();
        if (!(size > beyond(k))) return;
      }
      beyond(k) = size;
      set_column(gradients, k, gradient);
    });
  }
};

}  // namespace fpbm
