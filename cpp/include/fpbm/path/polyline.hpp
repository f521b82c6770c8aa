#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <type_traits>
#include <vector>

#include "fpbm/core/detail/validation.hpp"
#include "fpbm/geometry/rotation.hpp"
#include "fpbm/geometry/space.hpp"
#include "fpbm/path/detail/curve.hpp"
#include "fpbm/path/detail/point.hpp"
#include "fpbm/path/path.hpp"

namespace fpbm {

/// Straight segments through points of a task space, with blends at the corners. In space, the rotation between two
/// poses is proportional to the distance along the segment.
///
/// A blend begins at a distance r before its corner, and ends at r after the corner; r is the given radius, but at most
/// half of the shorter segment. The blend is a Bézier curve of degree 4 in the triangle of its ends and the corner,
/// with continuous curvature: its control points are the ends, the corner, and the middles between them. s is
/// proportional to the distance along the segments; in a blend, to the distance along the corner that the blend
/// replaces. Without blends, the path stops at each corner: the fraction of each segment has the time law Quintic.
template <typename Space_, typename Scalar_ = double>
class Polyline {
 public:
  using Scalar = Scalar_;
  using Space = Space_;
  using Point = typename Space::template Point<Scalar>;

  /// Only differences from the first point matter. Throws std::invalid_argument unless there are at least two points,
  /// all numbers are finite, successive points have different positions, and blend [m] is finite and not negative.
  explicit Polyline(const std::vector<Point>& points, Scalar blend = Scalar(0)) : stops_(blend == Scalar(0)) {
    validation::require_non_negative("blend", blend);
    require_points<Space, Scalar>(points);
    Corner corner{Space::template origin<Scalar>(), Scalar(0), Scalar(0), filled<Twist>(Space::kRows)};
    for (std::size_t i = 1; i < points.size(); ++i) {
      const Twist moved = Space::template difference<Scalar>(points[i], points[i - 1]);
      const Scalar length = moved.template head<kLinear>().norm();
      if (!(length > Scalar(0))) {
        validation::reject(validation::element("points", static_cast<Eigen::Index>(i)),
                           ": must have another position than the previous point");
      }
      corner.blend = std::min(corner.blend, length / Scalar(2));
      corner.slope = moved / length;
      corners_.push_back(corner);
      if constexpr (kTurns) {
        corner.x = {points[i].p - points[0].p, points[i].R * points[0].R.transpose()};
      } else {
        corner.x += moved;
      }
      corner.distance += length;
      corner.blend = std::min(blend, length / Scalar(2));
    }
    corner.blend = Scalar(0);
    corners_.push_back(corner);
  }

  [[nodiscard]] Curve<Space, Scalar> at(Scalar s) const noexcept {
    const Scalar length = corners_.back().distance;
    const Scalar distance = s * length;
    // The corner at the start of the segment, or the corner in whose blend the distance is.
    const auto next = std::upper_bound(corners_.begin() + 1, corners_.end() - 1, distance,
                                       [](Scalar d, const Corner& each) { return d < each.distance - each.blend; });
    const auto i = static_cast<std::size_t>(next - corners_.begin()) - 1;
    const Corner& corner = corners_[i];
    const Scalar beyond = distance - corner.distance;
    const Twist& before = corners_[i == 0 ? 0 : i - 1].slope;
    if (stops_) {
      const Scalar segment = next->distance - corner.distance;
      const Phase<Scalar> phase = Quintic::at(beyond / segment);
      return scaled(about(corner, before, {}, {phase.s * segment, phase.sd, phase.sdd / segment}), length);
    }
    if (!(beyond < corner.blend)) return scaled(about(corner, before, {}, {beyond, Scalar(1), Scalar(0)}), length);
    // Distance after the corner, with the Bézier coefficients (0, 0, 0, 1/2, 1) r; before the corner, it is symmetric.
    // With these coefficients, a blend without a turn has constant speed.
    const Scalar width = Scalar(2) * corner.blend;
    const auto gone = [width](Scalar u) -> Phase<Scalar> {
      const Scalar cube = u * u * u;
      return {width * cube * (Scalar(1) - u / Scalar(2)), u * u * (Scalar(3) - Scalar(2) * u),
              Scalar(6) * u * (Scalar(1) - u) / width};
    };
    const Scalar u = (beyond + corner.blend) / width;
    const Phase<Scalar> back = gone(Scalar(1) - u);
    return scaled(about(corner, before, {-back.s, back.sd, -back.sdd}, gone(u)), length);
  }

 private:
  static constexpr bool kTurns = std::is_same_v<Space, Pose>;
  static constexpr int kLinear = Space::kRows - Space::kTurns;
  using Twist = Vector<Space::kRows, Scalar>;

  struct Corner {
    Point x;
    Scalar distance;  ///< From the start, along the segments [m].
    Scalar blend;     ///< Distance at which the blend begins and ends [m].
    Twist slope;      ///< Displacement per metre of the segment after the corner.
  };

  /// The point after the displacement a.s `before` to the corner, and the displacement b.s of the segment after the
  /// corner, with derivatives with respect to the distance. The rotations are R = exp(b.s w_b) exp(a.s w_a) R_corner.
  static Curve<Space, Scalar> about(const Corner& corner, const Twist& before, const Phase<Scalar>& a,
                                    const Phase<Scalar>& b) noexcept {
    const Twist& after = corner.slope;
    Curve<Space, Scalar> curve{corner.x, before * a.sd + after * b.sd, before * a.sdd + after * b.sdd};
    curve.d = Space::template displace<Scalar>(Space::template displace<Scalar>(corner.x, before * a.s), after * b.s);
    if constexpr (kTurns) {
      const Matrix<3, 3, Scalar> turned = rotation(Vector<3, Scalar>(after.template tail<3>() * b.s));
      const Vector<3, Scalar> w = turned * before.template tail<3>();
      const Vector<3, Scalar> own = after.template tail<3>() * b.sd;
      curve.d1.template tail<3>() = own + w * a.sd;
      curve.d2.template tail<3>() =
          after.template tail<3>() * b.sdd + cross<Scalar>(own, Vector<3, Scalar>(w * a.sd)) + w * a.sdd;
    }
    return curve;
  }

  /// Derivatives with respect to s instead of the distance.
  static Curve<Space, Scalar> scaled(Curve<Space, Scalar> curve, Scalar length) noexcept {
    curve.d1 *= length;
    curve.d2 *= length * length;
    return curve;
  }

  bool stops_;
  std::vector<Corner> corners_;
};

}  // namespace fpbm
