#pragma once

#include "fpbm/core/types.hpp"
#include "fpbm/geometry/rotation.hpp"

/// Solid shapes on the links of an arm or in its environment [m].
namespace fpbm {

/// Segment start + t extent, with t in [0, 1].
template <typename Scalar = double>
struct Segment {
  Vector<3, Scalar> start;
  Vector<3, Scalar> extent;

  [[nodiscard]] Vector<3, Scalar> at(Scalar t) const noexcept { return start + t * extent; }
};

/// All points within `radius` of the segment from a to b; a sphere if a = b.
template <typename Scalar = double>
struct Capsule {
  Vector<3, Scalar> a;
  Vector<3, Scalar> b;
  Scalar radius;

  [[nodiscard]] Segment<Scalar> core() const noexcept { return {a, b - a}; }
};

/// All points x with normal · x ≤ offset: a floor or a wall.
template <typename Scalar = double>
struct HalfSpace {
  Vector<3, Scalar> normal;  ///< Unit vector that points out of the solid.
  Scalar offset;
};

/// Box in any pose: all points pose.p + pose.R x with |x_i| ≤ half_i.
template <typename Scalar = double>
struct Cuboid {
  Transform<Scalar> pose;
  Vector<3, Scalar> half;  ///< Half lengths of the edges, nonnegative.
};

/// Transforms a capsule from frame b to frame a. pose: frame b in frame a.
template <typename Scalar>
[[nodiscard]] Capsule<Scalar> placed(const Capsule<Scalar>& capsule, const Transform<Scalar>& pose) noexcept {
  return {pose.p + pose.R.lazyProduct(capsule.a), pose.p + pose.R.lazyProduct(capsule.b), capsule.radius};
}

}  // namespace fpbm
