#pragma once

#include <string>
#include <utility>

#include "fpbm/bound/detail/levers.hpp"
#include "fpbm/bound/detail/shape.hpp"

namespace fpbm {

/// A capsule of a robot.
template <typename Scalar, int Joints = Eigen::Dynamic>
struct Body {
  int link;
  Capsule<Scalar> in_link;  ///< In the frame of the joint of the link.
  std::string name;
  Vector<Joints, Scalar> levers;  ///< Larger lever of both ends, for each joint (levers.hpp).
  Scalar size;                    ///< Radius of the smallest ball around the capsule [m].

  /// capsule: in the frame of the link. in_joint: pose of this frame in the frame of the joint of the link.
  Body(const Levers<Scalar>& levers_of, int link_, const Transform<Scalar>& in_joint, const Capsule<Scalar>& capsule,
       std::string name_)
      : link(link_),
        in_link(placed(capsule, in_joint)),
        name(std::move(name_)),
        levers(levers_of(link, capsule.a).cwiseMax(levers_of(link, capsule.b))),
        size((capsule.b - capsule.a).norm() / Scalar(2) + capsule.radius) {}
};

}  // namespace fpbm
