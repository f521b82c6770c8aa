#pragma once

#include <limits>
#include <string>
#include <utility>

#include "fpbm/clearance/levers.hpp"
#include "fpbm/clearance/shape.hpp"

namespace fpbm {

/// One of a robot's capsules. The body of a bound on a task is a point of a link, or a unit vector that turns with a
/// link: a point that only turning joints move, by no more than their angles.
template <typename Scalar, int Joints = Eigen::Dynamic>
struct Body {
  int link;
  Capsule<Scalar> in_link;  ///< Seen from the link's joint.
  std::string name;
  Vector<Joints, Scalar> levers;  ///< Of both ends, the longer, by joint.
  Scalar size;                    ///< Radius of the smallest ball around the capsule [m].
  bool is_direction = false;
  Scalar deceleration = std::numeric_limits<Scalar>::infinity();  ///< Most toward a bound of a task.

  /// capsule: in the link's frame, which the link's joint sees at in_joint.
  Body(const Levers<Scalar>& levers_of, int link_, const Transform<Scalar>& in_joint, const Capsule<Scalar>& capsule,
       std::string name_)
      : link(link_),
        in_link(placed(capsule, in_joint)),
        name(std::move(name_)),
        levers(levers_of(link, capsule.a).cwiseMax(levers_of(link, capsule.b))),
        size((capsule.b - capsule.a).norm() / Scalar(2) + capsule.radius) {}

  /// The capsule in the base frame. frame: that of the link's joint.
  [[nodiscard]] Capsule<Scalar> placed_by(const Transform<Scalar>& frame) const noexcept {
    return placed(in_link, frame);
  }
  /// The point or the direction of a bound, in the base frame.
  [[nodiscard]] Vector<3, Scalar> point_by(const Transform<Scalar>& frame) const noexcept {
    const Vector<3, Scalar> turned = frame.R.lazyProduct(in_link.a);
    return is_direction ? turned : Vector<3, Scalar>(frame.p + turned);
  }
};

}  // namespace fpbm
