#pragma once

#include <algorithm>
#include <cmath>

#include "fpbm/clearance/shape.hpp"
#include "fpbm/clearance/widest_gap.hpp"
#include "fpbm/core/rotation.hpp"
#include "fpbm/core/types.hpp"

namespace fpbm {

/// Where a segment p + t d comes nearest to the box |x_i| ≤ half_i in whose frame it is given, and the unit vector from
/// the box to the segment there. Where the segment is in the box: the shortest way out.
template <typename Scalar>
struct NearestToBox {
  using Vector3 = Vector<3, Scalar>;

  Scalar t;
  Scalar gap;  ///< Distance; below zero, how far the segment must move to leave the box.
  Vector3 normal;

  NearestToBox(const Segment<Scalar>& segment, const Vector3& half) noexcept {
    using std::sqrt;
    t = nearest(segment, half);
    const Vector3 between = excess(segment.at(t), half);
    const Scalar squared = between.squaredNorm();
    gap = sqrt(squared);
    if (tells_direction(squared, segment.way.squaredNorm() + half.squaredNorm())) {
      normal = between / gap;
    } else {
      touch(segment, half, between);
    }
  }

 private:
  /// From the nearest point of the box to x.
  static Vector3 excess(const Vector3& x, const Vector3& half) noexcept { return x - x.cwiseMin(half).cwiseMax(-half); }

  /// Where f(t) = |excess(p + t d)|² is least in [0, 1]: its slope never falls, and is straight between the planes of
  /// the faces, so that eight values of it at most find its zero.
  static Scalar nearest(const Segment<Scalar>& segment, const Vector3& half) noexcept {
    const auto& [p, d] = segment;
    const Vector3 weight = d.cwiseAbs2();
    Vector3 enter;  // The t at which the line comes between the planes of two opposite faces, and leaves again.
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

  /// The normal where the difference of the nearest points is too short to tell, and the gap within the box: by the
  /// separating axes of a box and a segment, which are its faces' normals and those of its edges with the segment
  /// (S. Gottschalk, M. C. Lin, D. Manocha, OBBTree, 1996).
  [[gnu::noinline, gnu::cold]] void touch(const Segment<Scalar>& segment, const Vector3& half,
                                          const Vector3& between) noexcept {
    using std::abs;
    const Vector3& d = segment.way;
    const auto reach = [&](const Vector3& n) { return n.cwiseAbs().dot(half) + abs(n.dot(d)) / Scalar(2); };
    WidestGap<Scalar, decltype(reach)> widest(segment.at(Scalar(0.5)), reach, half.sum() + d.cwiseAbs().sum());
    // At right angles to the segment, but for an end's.
    const bool inside = Scalar(0) < t && t < Scalar(1);
    widest.offer(inside ? across(between, d) : between);
    for (int i = 0; i < 3; ++i) widest.offer(Vector3::Unit(i));
    for (int i = 0; i < 3; ++i) widest.offer(cross<Scalar>(Vector3::Unit(i), d));
    normal = widest.normal();
    if (gap > widest.round_off()) return;
    gap = widest.gap();
    t = nearest({segment.start - gap * normal, d}, half);  // Moved out of the box, the segment touches it there.
  }
};

}  // namespace fpbm
