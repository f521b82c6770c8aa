#pragma once

#include "fpbm/bound/detail/segment_cuboid.hpp"
#include "fpbm/bound/detail/segment_segment.hpp"
#include "fpbm/bound/detail/shape.hpp"
#include "fpbm/core/types.hpp"

namespace fpbm {

/// Nearest points of two shapes. If several pairs of points are nearest, the result is one of these pairs. If several
/// directions separate overlapping shapes equally, the result has one of these directions. Never NaN for shapes whose
/// lengths have finite squares.
template <typename Scalar = double>
struct Nearest {
  Scalar distance;              ///< Signed [m]. Negative: minus the smallest displacement that separates the shapes.
  Vector<3, Scalar> normal;     ///< Unit vector from the second shape to the first. A displacement x of the first shape
                                ///< along the normal adds x to the distance.
  Vector<3, Scalar> on_first;   ///< On the surface of the first shape: on_second + distance · normal.
  Vector<3, Scalar> on_second;  ///< On the surface of the second shape.

  /// Nearest points if the first shape is a capsule. distance: from the core of the capsule to the second shape. point:
  /// the nearest point of the core.
  [[nodiscard]] static Nearest of_core(Scalar distance, const Vector<3, Scalar>& normal, const Vector<3, Scalar>& point,
                                       Scalar radius) noexcept {
    return {distance - radius, normal, point - radius * normal, point - distance * normal};
  }
};

/// Nearest points of two capsules.
template <typename Scalar>
[[nodiscard]] Nearest<Scalar> nearest(const Capsule<Scalar>& first, const Capsule<Scalar>& second) noexcept {
  const Segment<Scalar> core = first.core();
  const NearestOfSegments<Scalar> cores(core, second.core());
  return Nearest<Scalar>::of_core(cores.gap - second.radius, cores.normal, core.at(cores.s), first.radius);
}

/// Nearest points of a capsule and a half-space, at the deeper end of the capsule.
template <typename Scalar>
[[nodiscard]] Nearest<Scalar> nearest(const Capsule<Scalar>& first, const HalfSpace<Scalar>& second) noexcept {
  const Scalar at_a = second.normal.dot(first.a);
  const Scalar at_b = second.normal.dot(first.b);
  const bool b_deeper = at_b < at_a;
  const Scalar distance = (b_deeper ? at_b : at_a) - second.offset;
  return Nearest<Scalar>::of_core(distance, second.normal, b_deeper ? first.b : first.a, first.radius);
}

/// Nearest points of a capsule and a box.
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
