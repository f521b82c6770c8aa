#pragma once

#include <limits>
#include <string>
#include <utility>

#include "fpbm/bound/detail/levers.hpp"
#include "fpbm/bound/detail/shape.hpp"

namespace fpbm {

/// A capsule of a robot, or the body of a bound on a task: a point of a link, or a unit vector fixed to a link. A unit
/// vector is treated as a point that only revolute joints move, by at most their angles.
template <typename Scalar, int Joints = Eigen::Dynamic>
struct Body {
  int link;
  Capsule<Scalar> in_link;  ///< In the frame of the joint of the link.
  std::string name;
  Vector<Joints, Scalar> levers;  ///< Larger lever of both ends, for each joint (levers.hpp).
  Scalar size;                    ///< Radius of the smallest ball around the capsule [m].
  bool is_direction = false;
  /// Largest deceleration toward a task bound [m/s²], or [1/s²] of a direction.
  Scalar deceleration = std::numeric_limits<Scalar>::infinity();

  /// capsule: in the frame of the link. in_joint: pose of this frame in the frame of the joint of the link.
  Body(const Levers<Scalar>& levers_of, int link_, const Transform<Scalar>& in_joint, const Capsule<Scalar>& capsule,
       std::string name_)
      : link(link_),
        in_link(placed(capsule, in_joint)),
        name(std::move(name_)),
        levers(levers_of(link, capsule.a).cwiseMax(levers_of(link, capsule.b))),
        size((capsule.b - capsule.a).norm() / Scalar(2) + capsule.radius) {}

  /// The capsule in the base frame. frame: pose of the joint of the link.
  [[nodiscard]] Capsule<Scalar> placed_by(const Transform<Scalar>& frame) const noexcept {
    if (!is_direction) return placed(in_link, frame);
    const Vector<3, Scalar> x = point_by(frame);
    return {x, x, in_link.radius};
  }
  /// The point or the direction of a bound in the base frame. frame: pose of the joint of the link.
  [[nodiscard]] Vector<3, Scalar> point_by(const Transform<Scalar>& frame) const noexcept {
    const Vector<3, Scalar> turned = frame.R.lazyProduct(in_link.a);
    return is_direction ? turned : Vector<3, Scalar>(frame.p + turned);
  }
};

}  // namespace fpbm
