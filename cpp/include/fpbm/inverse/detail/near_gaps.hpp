#pragma once

#include <algorithm>

#include "fpbm/bound/bounds.hpp"
#include "fpbm/core/types.hpp"

namespace fpbm {

/// The gaps of bounds that are below kBuffer in a posture: rows of a search, w ∇s·Δq = w (kBuffer − s), with a weight
/// w.
template <int N, typename Scalar>
struct NearGaps {
  /// Distance that a search keeps beyond a bound [m], so that a posture with a small error keeps the bound. A choice:
  /// smaller than the errors of measured obstacles.
  static constexpr Scalar kBuffer = Scalar(1e-4);
  /// Largest number of rows: the gaps that are the most negative. As PairRows::kPairs.
  static constexpr int kMost = 16;

  Matrix<N, kMost, Scalar> gradients;  ///< w ∇s.
  Vector<kMost, Scalar> beyond;        ///< w (kBuffer − s) [m].
  Eigen::Index count;
  Scalar cost;  ///< Σ w² (kBuffer − s)² over all gaps below kBuffer, also those without a row [m²].

  /// The weight w with which each gap is at least 0.9 kBuffer where the cost is at most the square of `largest` [m].
  [[nodiscard]] static Scalar weight(Scalar largest) noexcept {
    return std::max(Scalar(1), largest / (Scalar(0.1) * kBuffer));
  }

  template <typename Bounds_>
  void set(Bounds_& bounds, const Vector<N, Scalar>& q, Scalar weight) noexcept {
    gradients.resize(q.size(), kMost);
    count = 0;
    cost = Scalar(0);
    bounds.gaps(q, kBuffer, [&](Scalar gap, const Vector<N, Scalar>& gradient) noexcept {
      const Scalar size = weight * (kBuffer - gap);
      cost += size * size;
      Eigen::Index k = count;
      if (count < kMost) {
        ++count;
      } else {
        k = std::min_element(beyond.data(), beyond.data() + kMost) - beyond.data();
        if (!(size > beyond(k))) return;
      }
      beyond(k) = size;
      for (Eigen::Index i = 0; i < q.size(); ++i) gradients.coeffRef(i, k) = weight * gradient.coeff(i);
    });
  }
};

}  // namespace fpbm
