#pragma once

#include <limits>
#include <string>
#include <utility>

#include "fpbm/clearance/levers.hpp"
#include "fpbm/clearance/shape.hpp"

namespace fpbm {

/// One of a robot's capsules, and where it is. The body of a bound on a task is a point of a link, or a unit vector
/// that turns with a link: a point that only turning joints move, by no more than their angles.
template <typename Scalar>
struct Body {
  int link;
  Capsule<Scalar> in_link;  ///< Seen from the link's joint.
  std::string name;
  Vector<Eigen::Dynamic, Scalar> levers;  ///< Of both ends, the longer, by joint.
  Capsule<Scalar> now;
  Vector<3, Scalar> centre;
  Scalar size;               ///< Radius of the ball around it.
  Scalar reach = Scalar(0);  ///< Most that a motion in question can move its axis.
  bool is_direction = false;
  Scalar deceleration = std::numeric_limits<Scalar>::infinity();  ///< Most toward a bound of a task.

  /// capsule: in the link's frame, which the link's joint sees at in_joint.
  Body(const Levers<Scalar>& levers_of, int link_, const Transform<Scalar>& in_joint, const Capsule<Scalar>& capsule,
       std::string name_)
      : link(link_),
        in_link(placed(capsule, in_joint)),
        name(std::move(name_)),
        levers(levers_of(link, capsule.a).cwiseMax(levers_of(link, capsule.b))) {
    place({});
  }

  /// frame: that of the link's joint.
  void place(const Transform<Scalar>& frame) noexcept {
    now = placed(in_link, frame);
    set_ball();
  }

  /// The same of the body of a bound.
  void place_in_bound(const Transform<Scalar>& frame) noexcept {
    now = placed(in_link, frame);
    if (is_direction) now.a = now.b = frame.R.lazyProduct(in_link.a);
    set_ball();
  }

 private:
  void set_ball() noexcept {
    centre = (now.a + now.b) / Scalar(2);
    size = (now.b - now.a).norm() / Scalar(2) + now.radius;
  }
};

}  // namespace fpbm
