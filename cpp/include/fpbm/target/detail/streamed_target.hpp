#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "fpbm/geometry/space.hpp"

namespace fpbm {

/// Target that is received as points, with a velocity that is estimated from the points.
///
/// The velocity of each axis is the smaller of the last two difference quotients, or zero if their signs differ
/// (minmod). For a target with constant velocity, the estimate is exact after three points. For a target that jumps,
/// the estimate is zero.
template <typename Space, typename Scalar>
class StreamedTarget {
 public:
  using Point = typename Space::template Point<Scalar>;
  using Twist = Vector<Space::kRows, Scalar>;

  /// At rest at x until the first point. Each difference quotient uses two points with a time difference of at least
  /// `least` and less than `most` [s]. No velocity exceeds `fastest`.
  StreamedTarget(const Point& x, Scalar least, Scalar most, Twist fastest) noexcept
      : least_(least), most_(most), fastest_(std::move(fastest)) {
    rest_at(x);
  }

  /// Point `seconds` [s] after the newest point.
  [[nodiscard]] Point at(Scalar seconds) const noexcept { return Space::template displace<Scalar>(x_, seconds * v_); }
  [[nodiscard]] const Twist& velocity() const noexcept { return v_; }

  /// Whether a point was received since the target was at rest.
  [[nodiscard]] bool streams() const noexcept { return streams_; }

  /// Adds a point, `elapsed` [s] after the previous point.
  void push(const Point& x, Scalar elapsed) noexcept {
    since_ += elapsed;
    if (!streams_ || !(since_ < most_)) {
      rest_at(x);
      base_ = x;
      streams_ = true;
      return;
    }
    x_ = x;
    if (since_ < least_) return;
    const Twist quotient = Space::template difference<Scalar>(x, base_) / since_;
    for (int i = 0; i < Space::kRows; ++i) {
      const bool agree = (quotient(i) > Scalar(0)) == (quotient_(i) > Scalar(0));
      const Scalar speed = std::min({std::abs(quotient(i)), std::abs(quotient_(i)), fastest_(i)});
      v_(i) = agree ? std::copysign(speed, quotient(i)) : Scalar(0);
    }
    quotient_ = quotient;
    base_ = x;
    since_ = Scalar(0);
  }

  /// Sets the target to rest at x, and forgets the received points.
  void rest_at(const Point& x) noexcept {
    x_ = x;
    v_.setZero();
    quotient_.setZero();
    since_ = Scalar(0);
    streams_ = false;
  }

 private:
  Scalar least_;
  Scalar most_;
  Twist fastest_;
  Point x_;
  Twist v_;
  Point base_;       ///< Point at the end of the last quotient.
  Twist quotient_;   ///< The last quotient.
  Scalar since_{0};  ///< Time from base_ to the newest point [s].
  bool streams_ = false;
};

}  // namespace fpbm
