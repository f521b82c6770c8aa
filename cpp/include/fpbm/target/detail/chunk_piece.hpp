#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "fpbm/core/detail/quickest_stop.hpp"
#include "fpbm/geometry/detail/chart_rates.hpp"
#include "fpbm/geometry/rotation.hpp"
#include "fpbm/path/reference.hpp"
#include "fpbm/target/detail/target_bounds.hpp"

namespace fpbm {

/// A point of a chunk.
template <typename Space, typename Scalar = double>
struct TimedPoint {
  Scalar time;                                      ///< Time after the stamp of the chunk [s].
  typename Space::template Point<Scalar> x;         ///< [m, rad]
  std::optional<Vector<Space::kRows, Scalar>> xd;   ///< Velocity [m/s, rad/s]; estimated if not given.
  std::optional<Vector<Space::kRows, Scalar>> xdd;  ///< Acceleration [m/s², rad/s²]; estimated if not given.
};

/// Coordinate i of a point: of a pose, of its position.
template <typename Derived>
[[nodiscard]] typename Derived::Scalar coordinate(const Eigen::MatrixBase<Derived>& x, Eigen::Index i) noexcept {
  return x(i);
}
template <typename Scalar>
[[nodiscard]] Scalar coordinate(const Transform<Scalar>& x, Eigen::Index i) noexcept {
  return x.p(i);
}

/// Motion from a point of a chunk to the next point: for each coordinate of the displacement, the polynomial of degree
/// 5 with the positions, velocities and accelerations of both points. After the last point, a motion at constant
/// velocity.
template <typename Space, typename Scalar_>
struct ChunkPiece {
  using Scalar = Scalar_;
  using Twist = Vector<Space::kRows, Scalar>;
  using Moving = Reference<Space, Scalar>;

  Scalar from;  ///< Time of the point [s].
  Moving start;
  Scalar h;             ///< Time to the next point [s]; 0 after the last point.
  Twist d;              ///< Displacement to the next point.
  Rates<Twist> end;     ///< Rates of the displacement at the next point.
  bool joined = false;  ///< Whether the next piece begins at the next point with the same velocity and acceleration.
  Twist low;            ///< Least coordinates of this piece and all later pieces, of lengths and joints only [m, rad].
  Twist high;           ///< Largest coordinates [m, rad].

  /// Rest, or motion at constant velocity, from a time on.
  [[nodiscard]] static ChunkPiece last(Scalar time, const Moving& start) noexcept {
    const auto none = filled<Twist>(Space::kRows);
    return {time, start, Scalar(0), none, {none, none}, false, none, none};
  }

  /// Sets the time and the displacement to the next point.
  void lead_to(const ChunkPiece& next) noexcept {
    h = next.from - from;
    d = Space::template difference<Scalar>(next.start.x, start.x);
  }

  /// The target t [s] after the start.
  [[nodiscard]] Moving at(Scalar t) const noexcept {
    Twist displacement = d;
    Rates<Twist> rates{start.xd, start.xdd};
    for (int i = 0; i < Space::kRows; ++i) {
      if (h > Scalar(0)) {
        const AxisState<Scalar> axis = along(i, t);
        displacement(i) = axis.q;
        rates.xd(i) = axis.v;
        rates.xdd(i) = axis.a;
      } else {
        displacement(i) = start.xd(i) == Scalar(0) ? Scalar(0) : start.xd(i) * t;
      }
    }
    if (h > Scalar(0)) rates = rates_of_point<Space, Scalar>(displacement, rates);
    return {Space::template displace<Scalar>(start.x, displacement), rates.xd, rates.xdd};
  }

  /// Largest magnitude of the jerk of coordinate i until t [s], at least until the next point: a polynomial of
  /// degree 2.
  [[nodiscard]] Scalar largest_jerk(Eigen::Index i, Scalar t) const noexcept {
    if (!(h > Scalar(0))) return Scalar(0);
    const Coefficients c = coefficients(i);
    const auto at = [&](Scalar s) noexcept {
      return std::abs(Scalar(6) * c.c3 + s * (Scalar(24) * c.c4 + s * Scalar(60) * c.c5));
    };
    const Scalar last = std::max(t / h, Scalar(1));
    const Scalar vertex = std::min(std::max(Scalar(-0.2) * c.c4 / c.c5, Scalar(0)), last);
    const Scalar largest = std::max(at(Scalar(0)), at(last));
    return (std::isfinite(vertex) ? std::max(largest, at(vertex)) : largest) / (h * h * h);
  }

  /// Includes the Bézier points of coordinate i between the ends, whose range contains the polynomial.
  void include_extremes(Eigen::Index i, Range<Scalar>& range) const noexcept {
    const Scalar x0 = coordinate(start.x, i);
    const Scalar x1 = x0 + d(i);
    const Scalar first = h / Scalar(5) * start.xd(i);
    const Scalar last = h / Scalar(5) * end.xd(i);
    const Scalar square = h * h / Scalar(20);
    range.include(x0 + first);
    range.include(x0 + Scalar(2) * first + square * start.xdd(i));
    range.include(x1 - last);
    range.include(x1 - Scalar(2) * last + square * end.xdd(i));
  }

  /// Sets `low` and `high`. next: the next piece, if there is one.
  void set_range(const ChunkPiece* next) noexcept {
    for (Eigen::Index i = 0; i < AxesOf<Space, Scalar>::kLengths; ++i) {
      Range<Scalar> range{coordinate(start.x, i), coordinate(start.x, i)};
      if (next != nullptr) range = {std::min(range.low, next->low(i)), std::max(range.high, next->high(i))};
      if (h > Scalar(0)) include_extremes(i, range);
      low(i) = range.low;
      high(i) = range.high;
    }
  }

  /// Accelerations at the ends of the polynomial of degree 3 with the positions and velocities of both points.
  [[nodiscard]] Twist first() const noexcept {
    return (Scalar(6) / h * d - Scalar(4) * start.xd - Scalar(2) * end.xd) / h;
  }
  [[nodiscard]] Twist last() const noexcept {
    const Twist second = (Scalar(-6) / h * d + Scalar(2) * start.xd + Scalar(4) * end.xd) / h;
    return rates_of_point<Space, Scalar>(d, Rates<Twist>{end.xd, second}).xdd;
  }
  /// Sets the velocity and the acceleration at the next point.
  void set_end(const Twist& xd, const Twist& xdd) noexcept {
    end = rates_of_displacement<Space, Scalar>(d, Rates<Twist>{xd, xdd});
  }

 private:
  struct Coefficients {
    Scalar c1, c2, c3, c4, c5;
  };
  /// Coefficients of a coordinate as a polynomial in t/h.
  [[nodiscard]] Coefficients coefficients(Eigen::Index i) const noexcept {
    const Scalar v0 = h * start.xd(i);
    const Scalar v1 = h * end.xd(i);
    const Scalar a0 = h * h * start.xdd(i) / Scalar(2);
    const Scalar a1 = h * h * end.xdd(i) / Scalar(2);
    return {v0, a0, Scalar(10) * d(i) - Scalar(6) * v0 - Scalar(4) * v1 - Scalar(3) * a0 + a1,
            Scalar(-15) * d(i) + Scalar(8) * v0 + Scalar(7) * v1 + Scalar(3) * a0 - Scalar(2) * a1,
            Scalar(6) * d(i) - Scalar(3) * (v0 + v1) - a0 + a1};
  }
  [[nodiscard]] AxisState<Scalar> along(Eigen::Index i, Scalar t) const noexcept {
    const auto [c1, c2, c3, c4, c5] = coefficients(i);
    const Scalar s = t / h;
    return {s * (c1 + s * (c2 + s * (c3 + s * (c4 + s * c5)))),
            (c1 + s * (Scalar(2) * c2 + s * (Scalar(3) * c3 + s * (Scalar(4) * c4 + s * Scalar(5) * c5)))) / h,
            (Scalar(2) * c2 + s * (Scalar(6) * c3 + s * (Scalar(12) * c4 + s * Scalar(20) * c5))) / (h * h)};
  }
};

}  // namespace fpbm
