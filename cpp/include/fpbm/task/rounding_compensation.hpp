#pragma once

#include <limits>

#include "fpbm/core/types.hpp"
#include "fpbm/task/point.hpp"

namespace fpbm {

/// Rounding compensation of a point that is displaced tick by tick: the sum of what the displacements lose when the
/// point is rounded [m, rad], as in Kahan's summation. Without it a displacement of less than the point's last bit per
/// tick would be lost.
template <typename Space, typename Scalar>
class RoundingCompensation {
 public:
  using Point = typename Space::template Point<Scalar>;
  using Twist = Vector<Space::kRows, Scalar>;

  /// Displacement from a point, without its rounding error, to another.
  [[nodiscard]] Twist difference(const Point& x, const Point& from) const noexcept {
    return Space::template difference<Scalar>(x, from) - lost_;
  }

  /// The point after a displacement, rounded.
  [[nodiscard]] Point displace(const Point& from, const Twist& displacement) const noexcept {
    if (displacement.isZero(Scalar(0))) return from;
    return straightened(Space::template displace<Scalar>(from, displacement + lost_));
  }

  /// Adds what a displacement between two points lost; at most a few last bits, since a point may also be set.
  void add(const Twist& displacement, const Point& to, const Point& from) noexcept {
    lost_ += displacement - Space::template difference<Scalar>(to, from);
    const Scalar most = Scalar(4) * std::numeric_limits<Scalar>::epsilon() * extent(to);
    lost_ = lost_.cwiseMax(-most).cwiseMin(most);
  }

  void clear() noexcept { lost_ = filled<Twist>(Space::kRows); }

 private:
  Twist lost_ = filled<Twist>(Space::kRows);
};

}  // namespace fpbm
