#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "fpbm/core/types.hpp"

namespace fpbm {

/// Quintic spline through points at given times, with given velocities and accelerations at both ends, and four
/// continuous derivatives: of all curves through the points, the curve with the least ∫|jerk|² dt.
///
/// Allocates at construction and when copied, never in at().
template <int M, typename Scalar = double>
class Spline {
 public:
  using Point = Vector<M, Scalar>;
  using Rates = Matrix<2, M, Scalar>;  ///< Velocity and acceleration.

  /// Value and the first two derivatives with respect to time.
  struct Sample {
    Point x;
    Point xd;
    Point xdd;
  };

  /// At least two points, at strictly increasing times [s], at rest at both ends.
  Spline(const std::vector<Point>& points, const std::vector<Scalar>& times)
      : Spline(points, times, Rates::Zero(2, points[0].size()), Rates::Zero(2, points[0].size())) {}

  /// start, end: velocity and acceleration at the first and the last point.
  Spline(const std::vector<Point>& points, const std::vector<Scalar>& times, const Rates& start, const Rates& end)
      : times_(times) {
    knots_.reserve(points.size());
    for (const Point& point : points) knots_.push_back({point, start.row(0), start.row(1)});
    knots_.back().xd = end.row(0);
    knots_.back().xdd = end.row(1);
    solve(start, end);
  }

  [[nodiscard]] const std::vector<Scalar>& times() const noexcept { return times_; }

  /// Sample at t [s]. Outside of the times, the sample of the nearest end.
  [[nodiscard]] Sample at(Scalar t) const noexcept {
    const auto after = std::upper_bound(times_.begin() + 1, times_.end() - 1, t);
    const auto i = static_cast<std::size_t>(after - times_.begin()) - 1;
    const Knot& a = knots_[i];
    const Knot& b = knots_[i + 1];
    const Scalar h = times_[i + 1] - times_[i];
    const Scalar u = std::clamp((t - times_[i]) / h, Scalar(0), Scalar(1));
    const Scalar s = u * h;
    Sample sample{a.x, a.x, a.x};
    for (Eigen::Index j = 0; j < a.x.size(); ++j) {  // Scalars compile in a third of the time of vectors.
      const auto [c3, c4, c5] = higher(a, b, h, j);
      sample.x(j) = a.x(j) + s * (a.xd(j) + s / 2 * a.xdd(j)) + u * u * u * (c3 + u * (c4 + u * c5));
      sample.xd(j) = a.xd(j) + s * a.xdd(j) + u * u / h * (3 * c3 + u * (4 * c4 + u * (5 * c5)));
      sample.xdd(j) = a.xdd(j) + u / (h * h) * (6 * c3 + u * (12 * c4 + u * (20 * c5)));
    }
    return sample;
  }

  /// Value and all five derivatives at t [s], of the piece between times i and i + 1.
  [[nodiscard]] std::array<Point, 6> derivatives(std::size_t i, Scalar t) const noexcept {
    const Scalar h = times_[i + 1] - times_[i];
    const Scalar u = (t - times_[i]) / h;
    const Sample here = at(t);
    std::array<Point, 6> result{here.x, here.xd, here.xdd, here.x, here.x, here.x};
    for (Eigen::Index j = 0; j < here.x.size(); ++j) {
      const auto [c3, c4, c5] = higher(knots_[i], knots_[i + 1], h, j);
      result[3](j) = (6 * c3 + u * (24 * c4 + u * (60 * c5))) / (h * h * h);
      result[4](j) = (24 * c4 + u * (120 * c5)) / (h * h * h * h);
      result[5](j) = 120 * c5 / (h * h * h * h * h);
    }
    return result;
  }

 private:
  struct Knot {
    Point x;
    Point xd;
    Point xdd;
  };

  /// Coefficients of u³, u⁴ and u⁵ in coordinate j of the piece between two knots with the time difference h [s].
  static std::array<Scalar, 3> higher(const Knot& a, const Knot& b, Scalar h, Eigen::Index j) noexcept {
    // Differences at b from the Taylor polynomial at a.
    const Scalar x = b.x(j) - (a.x(j) + h * (a.xd(j) + h / 2 * a.xdd(j)));
    const Scalar xd = h * (b.xd(j) - (a.xd(j) + h * a.xdd(j)));
    const Scalar xdd = h * h * (b.xdd(j) - a.xdd(j));
    return {10 * x - 4 * xd + xdd / 2, -15 * x + 7 * xd - xdd, 6 * x - 3 * xd + xdd / 2};
  }

  using Block = Matrix<2, 2, Scalar>;

  /// Computes the velocities and accelerations of the inner knots that make jerk and snap continuous. The continuity
  /// conditions are the normal equations of the least ∫|jerk|² dt: a block tridiagonal system, which is positive
  /// definite and therefore needs no pivoting.
  void solve(const Rates& start, const Rates& end) {
    const std::size_t inner = knots_.size() - 2;
    std::vector<Block> upper(inner);
    std::vector<Rates> rates(inner);
    for (std::size_t i = 0; i < inner; ++i) {
      const Scalar h = times_[i + 1] - times_[i];
      const Scalar g = times_[i + 2] - times_[i + 1];
      Block diagonal = ends(h) + begins(g);
      const Point before = (knots_[i + 1].x - knots_[i].x) / (h * h * h);
      const Point after = (knots_[i + 2].x - knots_[i + 1].x) / (g * g * g);
      Rates right(2, before.size());
      right.row(0) = 360 * (before / h + after / g).transpose();
      right.row(1) = 60 * (after - before).transpose();
      const Block lower = across(h).transpose();
      if (i > 0) diagonal -= lower * upper[i - 1];
      right -= lower * (i > 0 ? rates[i - 1] : start);
      if (i + 1 == inner) right -= across(g) * end;
      const Block inverse = inverted(diagonal);
      upper[i] = inverse * across(g);
      rates[i] = inverse * right;
    }
    for (std::size_t i = inner; i-- > 0;) {
      if (i + 1 < inner) rates[i] -= upper[i] * rates[i + 1];
      knots_[i + 1].xd = rates[i].row(0).transpose();
      knots_[i + 1].xdd = rates[i].row(1).transpose();
    }
  }

  /// Contribution of the rates of a knot to −snap and jerk at the end, and at the start, of a piece of h seconds.
  static Block ends(Scalar h) {
    Block block;
    block << 192 / (h * h * h), -36 / (h * h), -36 / (h * h), 9 / h;
    return block;
  }
  static Block begins(Scalar h) {
    Block block;
    block << 192 / (h * h * h), 36 / (h * h), 36 / (h * h), 9 / h;
    return block;
  }
  /// Contribution of the rates of the next knot.
  static Block across(Scalar h) {
    Block block;
    block << 168 / (h * h * h), -24 / (h * h), 24 / (h * h), -3 / h;
    return block;
  }

  static Block inverted(const Block& block) {
    Block adjugate;
    adjugate << block(1, 1), -block(0, 1), -block(1, 0), block(0, 0);
    return adjugate / (block(0, 0) * block(1, 1) - block(0, 1) * block(1, 0));
  }

  std::vector<Scalar> times_;
  std::vector<Knot> knots_;
};

}  // namespace fpbm
