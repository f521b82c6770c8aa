#pragma once

#include <string>

#include "fpbm/bound/clearance.hpp"
#include "fpbm/task/detail/link_frame.hpp"

namespace fpbm {

/// A point of the link of a frame as the body of a bound on a task. point: in the frame of the link [m]. If the frame
/// is at the tip, point is in the frame of the tip. Throws std::invalid_argument if the link does not exist.
template <int N, typename Scalar, int Joints>
[[nodiscard]] Body<Scalar, Joints> bound_body(const Clearance<N, Scalar, Joints>& clearance,
                                              const LinkFrame<Scalar>& frame, const Vector<3, Scalar>& point,
                                              const std::string& name) {
  const auto& robot = clearance.robot();
  robot.require_link("frame", frame.link());
  const bool is_tip = frame.link() == Clearance<N, Scalar, Joints>::Tree::kTip;
  const int link = is_tip ? robot.joints() : frame.link();
  const Transform<Scalar> to_joint = robot.in_joint(link, {});
  Transform<Scalar> at;
  at.p = point;
  const Vector<3, Scalar> in_link = is_tip ? (inverse(to_joint) * robot.in_joint(frame.link(), at)).p : point;
  // The negative radius cancels the margin, which does not apply to bounds on tasks.
  return {clearance.levers(), link, to_joint, {in_link, in_link, -clearance.margin()}, name};
}

/// The origin of a frame as the body of a bound.
template <int N, typename Scalar, int Joints>
[[nodiscard]] Body<Scalar, Joints> bound_point(const Clearance<N, Scalar, Joints>& clearance,
                                               const LinkFrame<Scalar>& frame, const std::string& name) {
  return bound_body(clearance, frame, frame.offset().p, name);
}

/// An axis of a frame, a unit vector, as the body of a bound.
template <int N, typename Scalar, int Joints>
[[nodiscard]] Body<Scalar, Joints> bound_direction(const Clearance<N, Scalar, Joints>& clearance,
                                                   const LinkFrame<Scalar>& frame, const Vector<3, Scalar>& axis,
                                                   const std::string& name) {
  const auto& robot = clearance.robot();
  Body<Scalar, Joints> body = bound_body(clearance, frame, Vector<3, Scalar>(frame.offset().R * axis), name);
  body.is_direction = true;
  each_joint(robot.moved_by(body.link), [&](Eigen::Index k) { body.levers(k) = Scalar(robot.turns(k) ? 1 : 0); });
  const Matrix<3, 3, Scalar> R = robot.in_joint(frame.link(), frame.offset()).R;
  body.in_link.a = body.in_link.b = R * axis;
  return body;
}

}  // namespace fpbm
