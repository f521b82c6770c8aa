#pragma once

#include "fpbm/core/rotation.hpp"
#include "fpbm/core/types.hpp"

/// Solid shapes [m], on an arm's links or in the world around it.
namespace fpbm {

/// From one end to the other: start + t way, t in [0, 1].
template <typename Scalar = double>
struct Segment {
  Vector<3, Scalar> start;
  Vector<3, Scalar> way;

  [[nodiscard]] Vector<3, Scalar> at(Scalar t) const noexcept { return start + t * way; }
};

/// All points within radius of the segment from a to b; a sphere where a = b.
template <typename Scalar = double>
struct Capsule {
  Vector<3, Scalar> a;
  Vector<3, Scalar> b;
  Scalar radius;

  [[nodiscard]] Segment<Scalar> core() const noexcept { return {a, b - a}; }
};

/// All points x with normal · x ≤ offset: a floor, or a wall.
template <typename Scalar = double>
struct HalfSpace {
  Vector<3, Scalar> normal;  ///< Of length 1, out of what is solid.
  Scalar offset;
};

/// A box in any pose: all points pose.p + pose.R x with |x_i| ≤ half_i.
template <typename Scalar = double>
struct Cuboid {
  Transform<Scalar> pose;
  Vector<3, Scalar> half;  ///< Half the length of each edge, zero or more.
};

/// A capsule given in frame b, in frame a, where pose is that of b in a.
template <typename Scalar>
[[nodiscard]] Capsule<Scalar> placed(const Capsule<Scalar>& capsule, const Transform<Scalar>& pose) noexcept {
  return {pose.p + pose.R.lazyProduct(capsule.a), pose.p + pose.R.lazyProduct(capsule.b), capsule.radius};
}

}  // namespace fpbm
