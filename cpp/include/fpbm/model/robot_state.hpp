#pragma once

#include <array>

#include "fpbm/core/rotation.hpp"
#include "fpbm/model/screws.hpp"

namespace fpbm {

/// State of a robot, which tasks read: placements in the base frame, and angular velocities in its axes.
/// Robot::update() fills it.
template <int N, typename Scalar = double, int Joints = N>
struct RobotState {
  Vector<N, Scalar> q;   ///< Of the drives [rad] or [m].
  Vector<N, Scalar> qd;  ///< [rad/s] or [m/s]
  /// Of the base and each joint; z is the joint's axis.
  std::array<Vector<3, Scalar>, kCapacity<Joints> + 1> p;
  std::array<Matrix<3, 3, Scalar>, kCapacity<Joints> + 1> R;
  Screws<Joints, Scalar> screws;    ///< Axes of the joints, and how their links turn.
  Vector<Joints, Scalar> joint_qd;  ///< Of all joints, where some follow others.
  bool moves = true;                ///< False: qd was not given, J̇ is not needed.

  RobotState() noexcept {}  // NOLINT(modernize-use-equals-default): braces would set all bytes to 0.

  [[nodiscard]] Transform<Scalar> placement(std::size_t i) const noexcept { return {p[i], R[i]}; }
  /// Angular velocity of a link, in the base frame's axes [rad/s].
  [[nodiscard]] Vector<3, Scalar> angular_velocity(int link) const noexcept {
    return link > 0 ? screws.angular_velocity(link - 1) : filled<Vector<3, Scalar>>(3);
  }
};

}  // namespace fpbm
