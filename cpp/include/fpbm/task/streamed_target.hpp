#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "fpbm/core/space.hpp"

namespace fpbm {

/// A target that comes as points, and its velocity, estimated from them.
///
/// The velocity is, axis by axis, the smaller of the last two difference quotients, and zero where their signs differ
/// (minmod): a target that moves evenly has its own after three points, and one that jumps has none.
template <typename Space, typename Scalar>
class StreamedTarget {
 public:
  using Point = typename Space::template Point<Scalar>;
  using Twist = Vector<Space::kRows, Scalar>;

  /// At rest at x, until points come. No quotient is of points nearer in time than least, or farther than most [s]; no
  /// velocity exceeds the fastest.
  StreamedTarget(const Point& x, Scalar least, Scalar most, Twist fastest) noexcept
      : least_(least), most_(most), fastest_(std::move(fastest)) {
    rest_at(x);
  }

  /// Seconds after the newest point.
  [[nodiscard]] Point at(Scalar seconds) const noexcept { return Space::template displace<Scalar>(x_, seconds * v_); }
  [[nodiscard]] const Twist& velocity() const noexcept { return v_; }

  /// Whether a point has come since it was at rest.
  [[nodiscard]] bool streams() const noexcept { return streams_; }

  /// A point some seconds after the one before.
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

  /// Is at rest from now on, and forgets the points that came.
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
  Point base_;       ///< Where the last quotient ends,
  Twist quotient_;   ///< what it is,
  Scalar since_{0};  ///< and how long before the newest point that was.
  bool streams_ = false;
};

}  // namespace fpbm
