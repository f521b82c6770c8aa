#pragma once

#include "fpbm/core/types.hpp"
#include "fpbm/linalg/detail/entrywise.hpp"

namespace fpbm {

/// Desired motion of the tip at one instant.
template <typename Space, typename Scalar = double>
struct Reference {
  typename Space::template Point<Scalar> x;  ///< Desired point, in the base frame [m, rad].
  Vector<Space::kRows, Scalar> xd;           ///< Desired velocity, linear rows above angular rows [m/s, rad/s].
  Vector<Space::kRows, Scalar> xdd;          ///< Desired acceleration [m/s², rad/s²].

  /// Reference at rest at x.
  [[nodiscard]] static Reference hold(const typename Space::template Point<Scalar>& x) noexcept {
    using Twist = Vector<Space::kRows, Scalar>;
    return {x, filled<Twist>(Space::kRows), filled<Twist>(Space::kRows)};
  }

  template <typename Other>
  [[nodiscard]] Reference<Space, Other> cast() const noexcept {
    return {x.template cast<Other>(), xd.template cast<Other>(), xdd.template cast<Other>()};
  }
};

/// The reference after `seconds` [s] at constant acceleration.
template <typename Space, typename Scalar>
[[nodiscard]] Reference<Space, Scalar> ahead(const Reference<Space, Scalar>& reference, Scalar seconds) noexcept {
  Reference<Space, Scalar> later = reference;
  if (seconds != Scalar(0)) {
    const Vector<Space::kRows, Scalar>& xd = reference.xd;
    const Vector<Space::kRows, Scalar>& xdd = reference.xdd;
    const Scalar half = seconds / Scalar(2);
    const auto displacement =
        entrywise(xd, [&](Eigen::Index i) { return seconds * (xd.coeff(i) + half * xdd.coeff(i)); });
    later.x = Space::template displace<Scalar>(reference.x, displacement);
    later.xd = entrywise(xd, [&](Eigen::Index i) { return xd.coeff(i) + seconds * xdd.coeff(i); });
  }
  return later;
}

}  // namespace fpbm
