#pragma once

#include "fpbm/bound/detail/joint_axes.hpp"
#include "fpbm/bound/detail/link_vector.hpp"
#include "fpbm/model/robot.hpp"

namespace fpbm {

/// A robot in a posture, for coordinates of points of links and of unit vectors fixed to links (LinkVector).
template <int N, typename Scalar = double, int Joints = N>
struct PlacedRobot {
  using Vector3 = Vector<3, Scalar>;
  using Point = LinkVector<Joints, Scalar>;

  Robot<N, Scalar, Joints> robot;
  Levers<Scalar> levers;
  typename Robot<N, Scalar, Joints>::State state;  ///< In the posture of place().
  JointAxes<Joints, Scalar> axes;

  /// source: the Tree or the Chain of the robot.
  template <typename Source>
  explicit PlacedRobot(const Source& source) : robot(source), levers(source) {}

  /// The origin of a frame. Throws std::invalid_argument if the link does not exist.
  [[nodiscard]] Point point(const LinkFrame<Scalar>& frame) const { return Point::point(robot, levers, frame); }
  /// An axis of a frame, a unit vector in the frame. Throws std::invalid_argument if the link does not exist.
  [[nodiscard]] Point direction(const LinkFrame<Scalar>& frame, const Vector3& axis) const {
    return Point::direction(robot, frame, axis);
  }

  /// Sets state and axes to the posture q [rad] or [m].
  void place(const Vector<N, Scalar>& q) noexcept {
    robot.update(q, state);
    axes.set(robot, state);
  }
  /// A point [m] or a direction in the base frame.
  [[nodiscard]] Vector3 in_base(const Point& x) const noexcept { return x.in_base(state); }
  /// Gradient of n·x with respect to all joints [m/rad or 1]. n: in the base frame.
  [[nodiscard]] Vector<Joints, Scalar> gradient(const Vector3& n, const Point& x) const noexcept {
    return axes.gradient(n, in_base(x), x.moved_by, x.is_direction);
  }
};

}  // namespace fpbm
