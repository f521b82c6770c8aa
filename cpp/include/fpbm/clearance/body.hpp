#pragma once

#include <string>
#include <utility>

#include "fpbm/clearance/shape.hpp"
#include "fpbm/model/links.hpp"

namespace fpbm {

/// One of an arm's capsules, and where it is.
template <int N, typename Scalar>
struct Body {
  using ChainVector = typename Links<N, Scalar>::ChainVector;

  Eigen::Index link;
  Capsule<Scalar> in_link;
  std::string name;
  ChainVector levers;  ///< Of both ends, the longer.
  Capsule<Scalar> now;
  Vector<3, Scalar> centre;
  Scalar size;               ///< Radius of the ball around it.
  Scalar reach = Scalar(0);  ///< Most that a motion in question can move its axis.

  Body(const Links<N, Scalar>& links, Eigen::Index link_, const Capsule<Scalar>& capsule, std::string name_)
      : link(link_),
        in_link(capsule),
        name(std::move(name_)),
        levers(links.levers(link, capsule.a).cwiseMax(links.levers(link, capsule.b))) {
    place({});
  }

  /// frame: that of its link.
  void place(const Transform<Scalar>& frame) noexcept {
    now = placed(in_link, frame);
    centre = (now.a + now.b) / Scalar(2);
    size = (now.b - now.a).norm() / Scalar(2) + now.radius;
  }
};

}  // namespace fpbm
