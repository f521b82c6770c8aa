#pragma once

#include <algorithm>
#include <cmath>

#include "fpbm/bound/detail/shape.hpp"
#include "fpbm/bound/detail/widest_gap.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/geometry/rotation.hpp"

namespace fpbm {

/// Nearest point of a segment p + t d to the box |x_i| ≤ half_i, and the unit vector from the box to the segment. The
/// segment is given in the frame of the box. If the segment is in the box, gap and normal give the smallest
/// displacement that moves the segment out of the box.
template <typename Scalar>
struct NearestToBox {
  using Vector3 = Vector<3, Scalar>;

  Scalar t;
  Scalar gap;  ///< Distance [m]. Negative: the depth by which the segment must move to leave the box.
  Vector3 normal;

  NearestToBox(const Segment<Scalar>& segment, const Vector3& half) noexcept {
    using std::sqrt;
    t = nearest(segment, half);
    const Vector3 between = excess(segment.at(t), half);
    const Scalar squared = between.squaredNorm();
    gap = sqrt(squared);
    if (tells_direction(squared, segment.extent.squaredNorm() + half.squaredNorm())) {
      normal = between / gap;
    } else {
      touch(segment, half, between);
    }
  }

 private:
  /// Vector from the nearest point of the box to x.
  static Vector3 excess(const Vector3& x, const Vector3& half) noexcept { return x - x.cwiseMin(half).cwiseMax(-half); }

  /// Minimiser of f(t) = |excess(p + t d)|² in [0, 1]. The slope of f is nondecreasing and piecewise linear, with kinks
  /// at the planes of the faces. At most eight values of the slope therefore bracket its zero.
  static Scalar nearest(const Segment<Scalar>& segment, const Vector3& half) noexcept {
    const auto& [p, d] = segment;
    const Vector3 weight = d.cwiseAbs2();
    Vector3 enter;  // The t at which the line enters and leaves the slab between two opposite faces.
    Vector3 leave;
    for (int i = 0; i < 3; ++i) {
      const Scalar inverse = weight(i) > Scalar(0) ? Scalar(1) / d(i) : Scalar(0);
      const Scalar lower = (-half(i) - p(i)) * inverse;
      const Scalar upper = (half(i) - p(i)) * inverse;
      enter(i) = std::min(lower, upper);
      leave(i) = std::max(lower, upper);
    }
    const auto half_slope = [&](Scalar at) {
      Scalar sum(0);
      for (int i = 0; i < 3; ++i) {
        sum += weight(i) * (std::max(at - leave(i), Scalar(0)) + std::min(at - enter(i), Scalar(0)));
      }
      return sum;
    };
    Scalar low(0);
    Scalar high(1);
    Scalar falling = half_slope(low);
    if (!(falling < Scalar(0))) return low;
    Scalar rising = half_slope(high);
    if (!(rising > Scalar(0))) return high;
    const auto narrow = [&](Scalar at) {
      if (!(low < at && at < high)) return;
      const Scalar here = half_slope(at);
      const bool below = here < Scalar(0);
      (below ? low : high) = at;
      (below ? falling : rising) = here;
    };
    for (int i = 0; i < 3; ++i) {
      narrow(enter(i));
      narrow(leave(i));
    }
    return low + (high - low) * (falling / (falling - rising));
  }

  /// Sets the normal and the gap if the difference of the nearest points is too short to define a direction, or the
  /// segment is in the box. The candidates are the separating axes of a box and a segment: the normals of the faces,
  /// and the cross products of the edges with the segment (S. Gottschalk, M. C. Lin, D. Manocha, OBBTree, 1996).
  [[gnu::noinline, gnu::cold]] void touch(const Segment<Scalar>& segment, const Vector3& half,
                                          const Vector3& between) noexcept {
    using std::abs;
    const Vector3& d = segment.extent;
    const auto half_extent = [&](const Vector3& n) { return n.cwiseAbs().dot(half) + abs(n.dot(d)) / Scalar(2); };
    WidestGap<Scalar, decltype(half_extent)> widest(segment.at(Scalar(0.5)), half_extent,
                                                    half.sum() + d.cwiseAbs().sum());
    // Perpendicular to the segment, unless an end of the segment is nearest.
    const bool inside = Scalar(0) < t && t < Scalar(1);
    widest.offer(inside ? across(between, d) : between);
    for (int i = 0; i < 3; ++i) widest.offer(Vector3::Unit(i));
    for (int i = 0; i < 3; ++i) widest.offer(cross<Scalar>(Vector3::Unit(i), d));
    normal = widest.normal();
    if (gap > widest.round_off()) return;
    gap = widest.gap();
    t = nearest({segment.start - gap * normal, d}, half);  // Nearest point after the displacement.
  }
};

}  // namespace fpbm
