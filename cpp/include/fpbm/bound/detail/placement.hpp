#pragma once

#include <vector>

#include "fpbm/bound/detail/joint_axes.hpp"
#include "fpbm/bound/detail/shape.hpp"
#include "fpbm/model/detail/robot_state.hpp"

namespace fpbm {

/// The bodies of a clearance in a posture, in the base frame. Shapes::place() sets all members.
template <int N, typename Scalar = double, int Joints = N>
struct Placement {
  RobotState<N, Scalar, Joints> state;
  std::vector<Capsule<Scalar>> bodies;
  std::vector<Vector<3, Scalar>> centres;  ///< Centres of the smallest balls around the bodies [m].
  JointAxes<Joints, Scalar> axes;
};

}  // namespace fpbm
