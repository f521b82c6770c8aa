#pragma once

#include <cmath>

#include "fpbm/bound/detail/shape.hpp"
#include "fpbm/bound/detail/widest_gap.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/geometry/rotation.hpp"

namespace fpbm {

/// part / whole, clamped to [0, 1], for whole ≥ 0. Never NaN.
template <typename Scalar>
[[nodiscard]] Scalar fraction(Scalar part, Scalar whole) noexcept {
  if (!(part > Scalar(0))) return Scalar(0);
  return part < whole ? part / whole : Scalar(1);
}

/// Nearest points of two segments a + s u and b + t v (C. Ericson, Real-Time Collision Detection, 2005, 5.1.9), and the
/// unit vector from the second point to the first.
template <typename Scalar>
struct NearestOfSegments {
  using Vector3 = Vector<3, Scalar>;

  Scalar s;
  Scalar t;
  Scalar gap;  ///< Distance [m].
  Vector3 normal;

  NearestOfSegments(const Segment<Scalar>& first, const Segment<Scalar>& second) noexcept {
    using std::sqrt;
    const Vector3& u = first.extent;
    const Vector3& v = second.extent;
    const Vector3 w = first.start - second.start;
    const Vector3 c = cross(u, v);
    const Scalar uu = u.squaredNorm();
    const Scalar vv = v.squaredNorm();
    // Nearest points of the lines. For nearly parallel lines, |c|² in the form (u·u)(v·v) − (u·v)² would lose half of
    // the digits.
    s = fraction(c.dot(cross(v, w)), c.squaredNorm());
    t = fraction(v.dot(w + s * u), vv);
    if (t == Scalar(0) || t == Scalar(1)) s = fraction(u.dot(t * v - w), uu);
    const Vector3 between = w + s * u - t * v;
    const Scalar squared = between.squaredNorm();
    gap = sqrt(squared);
    if (tells_direction(squared, uu + vv)) {
      normal = between / gap;
    } else {
      normal = touching(u, v, w, c, between);
    }
  }

 private:
  static bool inside(Scalar fraction) noexcept { return Scalar(0) < fraction && fraction < Scalar(1); }

  /// Normal if the difference of the nearest points is too short to define a direction. A separate function, because
  /// the case is rare.
  [[gnu::noinline, gnu::cold]] Vector3 touching(const Vector3& u, const Vector3& v, const Vector3& w, const Vector3& c,
                                                Vector3 between) const noexcept {
    using std::abs;
    const auto half_extent = [&u, &v](const Vector3& n) { return (abs(n.dot(u)) + abs(n.dot(v))) / Scalar(2); };
    const Scalar size = u.cwiseAbs().sum() + v.cwiseAbs().sum();
    WidestGap<Scalar, decltype(half_extent)> widest(w + (u - v) / Scalar(2), half_extent, size);
    // The normal is perpendicular to each segment whose nearest point is not an end.
    if (inside(s)) between = across(between, u);
    if (inside(t)) between = across(between, v);
    widest.offer(between);
    // For nearly parallel segments, c is short and has a large relative error. The component of c along u is round-off
    // error.
    widest.offer(across(c, u));
    widest.offer(perpendicular(u.squaredNorm() > v.squaredNorm() ? u : v));
    return widest.normal();
  }
};

}  // namespace fpbm
