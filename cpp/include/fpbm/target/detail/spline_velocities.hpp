#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>

namespace fpbm {

/// Sets the velocities at the points of a chunk of n pieces, the last of which has no next point: the velocities of the
/// cubic spline through the points whose third derivative is continuous at the second and at the last but one point
/// ("not a knot"; de Boor 1978). first: changes the velocity at the first point before the others follow from it.
/// Elimination in the tridiagonal equations from the last point to the first; all pivots are positive.
template <int Capacity, typename Piece, typename First>
void set_spline_velocities(Piece* piece, std::size_t n, const First& first) noexcept {
  using Scalar = typename Piece::Scalar;
  using Twist = typename Piece::Twist;
  const auto quotient = [piece](std::size_t k) -> Twist { return piece[k].d / piece[k].h; };
  if (n == 1) return;
  if (n == 2) {
    piece[0].start.xd = piece[1].start.xd = quotient(0);
    return;
  }
  if (n == 3) {
    const Twist second = (quotient(1) - quotient(0)) / (piece[0].h + piece[1].h);
    piece[0].start.xd = quotient(0) - piece[0].h * second;
    piece[1].start.xd = quotient(0) + piece[0].h * second;
    piece[2].start.xd = quotient(1) + piece[1].h * second;
    first(piece[0].start.xd);
    return;
  }
  // Velocity k, of the elimination, is piece[k].start.xd - lower[k] * velocity k - 1.
  std::array<Scalar, static_cast<std::size_t>(Capacity)> lower;
  // Velocity at an end: outer and inner are the pieces at the end.
  const auto at_end = [&](const Piece& outer, const Piece& inner) -> Twist {
    const Scalar both = outer.h + inner.h;
    return ((outer.h + both + both) * inner.h / outer.h * outer.d + outer.h * outer.h / inner.h * inner.d) / both;
  };
  lower[n - 1] = (piece[n - 2].h + piece[n - 3].h) / piece[n - 3].h;
  piece[n - 1].start.xd = at_end(piece[n - 2], piece[n - 3]) / piece[n - 3].h;
  for (std::size_t k = n - 2; k > 0; --k) {
    const Scalar before = Scalar(1) / piece[k - 1].h;
    const Scalar after = Scalar(1) / piece[k].h;
    const Scalar pivot = Scalar(2) * (before + after) - after * lower[k + 1];
    lower[k] = before / pivot;
    piece[k].start.xd =
        (Scalar(3) * (before * quotient(k - 1) + after * quotient(k)) - after * piece[k + 1].start.xd) / pivot;
  }
  const Scalar both = piece[0].h + piece[1].h;
  piece[0].start.xd = (at_end(piece[0], piece[1]) - both * piece[1].start.xd) / (piece[1].h - both * lower[1]);
  first(piece[0].start.xd);
  for (std::size_t k = 1; k < n; ++k) piece[k].start.xd -= lower[k] * piece[k - 1].start.xd;
}

/// Sets the velocity xd at the first point of a chunk of at least three points to the velocity before the chunk, for
/// each coordinate in which they differ by less than the difference between the velocities of the first quotient and of
/// the parabola through the first three points: an estimate from one side has an error of this size.
template <typename Piece>
void continue_velocity(const Piece* piece, const typename Piece::Twist& before, typename Piece::Twist& xd) noexcept {
  using Scalar = typename Piece::Scalar;
  const Scalar part = piece[0].h / (piece[0].h + piece[1].h);
  for (Eigen::Index i = 0; i < xd.size(); ++i) {
    const Scalar error = part * std::abs(piece[1].d(i) / piece[1].h - piece[0].d(i) / piece[0].h);
    if (std::abs(before(i) - xd(i)) < error) xd(i) = before(i);
  }
}

}  // namespace fpbm
