#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

namespace fpbm {

/// Sets the velocities at the points of a chunk of n pieces, the last of which has no next point: the velocities of the
/// cubic spline through the points whose third derivative is continuous at the second and at the last but one point
/// ("not a knot"; de Boor 1978). LU factorisation of the tridiagonal equations; all pivots are positive.
template <int Capacity, typename Piece>
void set_spline_velocities(Piece* piece, std::size_t n) noexcept {
  using Scalar = typename Piece::Scalar;
  const auto quotient = [piece](std::size_t k) -> typename Piece::Twist { return piece[k].d / piece[k].h; };
  if (n == 1) return;
  if (n == 2) {
    piece[0].start.xd = piece[1].start.xd = quotient(0);
    return;
  }
  if (n == 3) {
    const typename Piece::Twist second = (quotient(1) - quotient(0)) / (piece[0].h + piece[1].h);
    piece[0].start.xd = quotient(0) - piece[0].h * second;
    piece[1].start.xd = quotient(0) + piece[0].h * second;
    piece[2].start.xd = quotient(1) + piece[1].h * second;
    return;
  }
  std::array<Scalar, static_cast<std::size_t>(Capacity)> upper;
  // Velocity at an end: outer and inner are the pieces at the end.
  const auto at_end = [&](const Piece& outer, const Piece& inner) -> typename Piece::Twist {
    const Scalar both = outer.h + inner.h;
    return ((outer.h + both + both) * inner.h / outer.h * outer.d + outer.h * outer.h / inner.h * inner.d) / both;
  };
  upper[0] = (piece[0].h + piece[1].h) / piece[1].h;
  piece[0].start.xd = at_end(piece[0], piece[1]) / piece[1].h;
  for (std::size_t k = 1; k + 1 < n; ++k) {
    const Scalar before = Scalar(1) / piece[k - 1].h;
    const Scalar after = Scalar(1) / piece[k].h;
    const Scalar pivot = Scalar(2) * (before + after) - before * upper[k - 1];
    upper[k] = after / pivot;
    piece[k].start.xd =
        (Scalar(3) * (before * quotient(k - 1) + after * quotient(k)) - before * piece[k - 1].start.xd) / pivot;
  }
  const Scalar both = piece[n - 3].h + piece[n - 2].h;
  piece[n - 1].start.xd =
      (at_end(piece[n - 2], piece[n - 3]) - both * piece[n - 2].start.xd) / (piece[n - 3].h - both * upper[n - 2]);
  for (std::size_t k = n - 1; k-- > 0;) piece[k].start.xd -= upper[k] * piece[k + 1].start.xd;
}

}  // namespace fpbm
