#pragma once

#include <limits>

#include "fpbm/core/types.hpp"
#include "fpbm/path/detail/point.hpp"

namespace fpbm {

/// Rounding compensation of a point that is displaced tick by tick. Rounding of the point loses a part of each
/// displacement. The compensation is the sum of the lost parts [m, rad], as in Kahan summation. Without compensation, a
/// displacement per tick below the last bit of the point would have no effect.
template <typename Space, typename Scalar>
class RoundingCompensation {
 public:
  using Point = typename Space::template Point<Scalar>;
  using Twist = Vector<Space::kRows, Scalar>;

  /// Displacement from `from` to x, without the rounding error of `from`.
  [[nodiscard]] Twist difference(const Point& x, const Point& from) const noexcept {
    return Space::template difference<Scalar>(x, from) - lost_;
  }

  /// The point `from` after a displacement, rounded.
  [[nodiscard]] Point displace(const Point& from, const Twist& displacement) const noexcept {
    if (displacement.isZero(Scalar(0))) return from;
    return straightened(Space::template displace<Scalar>(from, displacement + lost_));
  }

  /// Adds the part of a displacement from `from` to `to` that was lost in rounding. The sum is limited to 4 epsilon
  /// times extent(to), since the point may also be set to a target. Limits of 1 to 400 epsilon pass TargetTurn.*, 0
  /// fails.
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
