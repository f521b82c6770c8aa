#pragma once

#include "fpbm/clearance/segment_cuboid.hpp"
#include "fpbm/clearance/segment_segment.hpp"
#include "fpbm/clearance/shape.hpp"
#include "fpbm/core/types.hpp"

namespace fpbm {

/// Nearest points of two shapes. If several pairs of points are nearest, or several directions separate overlapping
/// shapes equally, the result is one of them. Never NaN for shapes whose lengths have finite squares.
template <typename Scalar = double>
struct Nearest {
  Scalar distance;              ///< Signed [m]. Negative: the smallest displacement that separates them.
  Vector<3, Scalar> normal;     ///< Unit vector from second to first: moving first along it by x adds x to distance.
  Vector<3, Scalar> on_first;   ///< On the surface of first; on_first = on_second + distance · normal.
  Vector<3, Scalar> on_second;  ///< On the surface of second.

  /// For a capsule whose core has this distance from second. point: the nearest point of the core.
  [[nodiscard]] static Nearest of_core(Scalar distance, const Vector<3, Scalar>& normal, const Vector<3, Scalar>& point,
                                       Scalar radius) noexcept {
    return {distance - radius, normal, point - radius * normal, point - distance * normal};
  }
};

/// Separation of two capsules.
template <typename Scalar>
[[nodiscard]] Nearest<Scalar> nearest(const Capsule<Scalar>& first, const Capsule<Scalar>& second) noexcept {
  const Segment<Scalar> core = first.core();
  const NearestOfSegments<Scalar> cores(core, second.core());
  return Nearest<Scalar>::of_core(cores.gap - second.radius, cores.normal, core.at(cores.s), first.radius);
}

/// Separation of a capsule and a half-space: at the deeper end of the capsule.
template <typename Scalar>
[[nodiscard]] Nearest<Scalar> nearest(const Capsule<Scalar>& first, const HalfSpace<Scalar>& second) noexcept {
  const Scalar at_a = second.normal.dot(first.a);
  const Scalar at_b = second.normal.dot(first.b);
  const bool b_deeper = at_b < at_a;
  const Scalar distance = (b_deeper ? at_b : at_a) - second.offset;
  return Nearest<Scalar>::of_core(distance, second.normal, b_deeper ? first.b : first.a, first.radius);
}

/// Separation of a capsule and a box.
template <typename Scalar>
[[nodiscard]] Nearest<Scalar> nearest(const Capsule<Scalar>& first, const Cuboid<Scalar>& second) noexcept {
  const Segment<Scalar> core = first.core();
  const auto to_box = second.pose.R.transpose();
  const NearestToBox<Scalar> cores({to_box.lazyProduct(core.start - second.pose.p), to_box.lazyProduct(core.extent)},
                                   second.half);
  const Vector<3, Scalar> normal = second.pose.R.lazyProduct(cores.normal);
  return Nearest<Scalar>::of_core(cores.gap, normal, core.at(cores.t), first.radius);
}

}  // namespace fpbm
