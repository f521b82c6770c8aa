#pragma once

#include "fpbm/bound/detail/levers.hpp"
#include "fpbm/task/detail/link_frame.hpp"

namespace fpbm {

/// A point of a link, or a unit vector fixed to a link, whose coordinates are bounded. A unit vector is a point that
/// only revolute joints move, by at most their angles.
template <int Joints, typename Scalar = double>
struct LinkVector {
  int link;
  Vector<3, Scalar> in_joint;  ///< In the frame of the joint of the link.
  bool is_direction;
  JointBits moved_by;             ///< Joints that move the link.
  Vector<Joints, Scalar> levers;  ///< For each joint (levers.hpp).

  /// The origin of a frame. Throws std::invalid_argument if the link does not exist.
  template <typename Robot>
  [[nodiscard]] static LinkVector point(const Robot& robot, const Levers<Scalar>& levers,
                                        const LinkFrame<Scalar>& frame) {
    const int link = link_of(robot, frame);
    const Vector<3, Scalar> p = robot.in_joint(frame.link(), frame.offset()).p;
    return {link, p, false, robot.moved_by(link), levers(link, (inverse(robot.in_joint(link, {})) * at(p)).p)};
  }

  /// An axis of a frame: a unit vector in the frame. Throws std::invalid_argument if the link does not exist.
  template <typename Robot>
  [[nodiscard]] static LinkVector direction(const Robot& robot, const LinkFrame<Scalar>& frame,
                                            const Vector<3, Scalar>& axis) {
    const int link = link_of(robot, frame);
    const JointBits moved_by = robot.moved_by(link);
    auto levers = filled<Vector<Joints, Scalar>>(robot.joints());
    each_joint(moved_by, [&](Eigen::Index k) { levers(k) = Scalar(robot.turns(k) ? 1 : 0); });
    return {link, robot.in_joint(frame.link(), frame.offset()).R * axis, true, moved_by, levers};
  }

  /// The vector in the base frame. state: of the robot.
  template <typename RobotState>
  [[nodiscard]] Vector<3, Scalar> in_base(const RobotState& state) const noexcept {
    const Transform<Scalar> frame = state.placement(static_cast<std::size_t>(link));
    const Vector<3, Scalar> turned = frame.R.lazyProduct(in_joint);
    return is_direction ? turned : Vector<3, Scalar>(frame.p + turned);
  }

 private:
  template <typename Robot>
  [[nodiscard]] static int link_of(const Robot& robot, const LinkFrame<Scalar>& frame) {
    robot.require_link("frame", frame.link());
    return frame.link() == Robot::kTip ? robot.joints() : frame.link();
  }
  [[nodiscard]] static Transform<Scalar> at(const Vector<3, Scalar>& p) {
    Transform<Scalar> place;
    place.p = p;
    return place;
  }
};

/// Throws std::invalid_argument if a vector is zero or not finite. Returns the vector with the length 1.
template <typename Scalar>
[[nodiscard]] Vector<3, Scalar> unit_vector(const char* name, const Vector<3, Scalar>& vector) {
  validation::require_finite(name, vector);
  const Scalar length = vector.stableNorm();
  if (!(length > Scalar(0))) validation::fail(name, Scalar(0), "a nonzero vector");
  return vector / length;
}

}  // namespace fpbm
