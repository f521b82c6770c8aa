#pragma once

#include <array>

#include "fpbm/geometry/rotation.hpp"
#include "fpbm/model/detail/screws.hpp"

namespace fpbm {

/// State of a robot for the tasks: placements in the base frame, and angular velocities along the axes of the base
/// frame. Robot::update() fills the state.
template <int N, typename Scalar = double, int Joints = N>
struct RobotState {
  Vector<N, Scalar> q;   ///< Positions of the drives [rad] or [m].
  Vector<N, Scalar> qd;  ///< Velocities of the drives [rad/s] or [m/s].
  /// Origins p [m] and axes R of the placements of the base and of each joint. z is the axis of the joint.
  std::array<Vector<3, Scalar>, kCapacity<Joints> + 1> p;
  std::array<Matrix<3, 3, Scalar>, kCapacity<Joints> + 1> R;
  Screws<Joints, Scalar> screws;    ///< Axes of the joints and angular velocities of their links.
  Vector<Joints, Scalar> joint_qd;  ///< Velocities of all joints, if some joints follow others.
  bool moves = true;                ///< False if qd was not given and J̇ is not needed.

  RobotState() noexcept {}  // NOLINT(modernize-use-equals-default): braces would set all bytes to 0.

  [[nodiscard]] Transform<Scalar> placement(std::size_t i) const noexcept { return {p[i], R[i]}; }
  /// Angular velocity of a link, along the axes of the base frame [rad/s].
  [[nodiscard]] Vector<3, Scalar> angular_velocity(int link) const noexcept {
    return link > 0 ? screws.angular_velocity(link - 1) : filled<Vector<3, Scalar>>(3);
  }
};

}  // namespace fpbm
