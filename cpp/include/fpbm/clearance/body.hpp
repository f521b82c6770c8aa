#pragma once

#include <limits>
#include <string>
#include <utility>

#include "fpbm/clearance/shape.hpp"
#include "fpbm/model/links.hpp"

namespace fpbm {

/// One of an arm's capsules, and where it is. The body of a bound on a task is a point of a link, or a unit vector that
/// turns with a link: a point that only turning joints move, by no more than their angles.
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
  bool is_direction = false;
  Scalar deceleration = std::numeric_limits<Scalar>::infinity();  ///< Most toward a bound of a task.

  Body(const Links<N, Scalar>& links, Eigen::Index link_, const Capsule<Scalar>& capsule, std::string name_)
      : link(link_),
        in_link(capsule),
        name(std::move(name_)),
        levers(links.levers(link, capsule.a).cwiseMax(links.levers(link, capsule.b))) {
    place({});
  }

  /// A unit vector of a link, as a point that translations do not move. radius: see Clearance::keep_above().
  [[nodiscard]] static Body direction(const Links<N, Scalar>& links, Eigen::Index link, const Vector<3, Scalar>& axis,
                                      Scalar radius, std::string name) {
    Body body(links, link, {axis, axis, radius}, std::move(name));
    for (Eigen::Index k = 0; k < link; ++k) body.levers(k) = links.turns(k) ? Scalar(1) : Scalar(0);
    body.is_direction = true;
    return body;
  }

  /// frame: that of its link.
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
