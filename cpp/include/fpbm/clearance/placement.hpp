#pragma once

#include <vector>

#include "fpbm/clearance/shape.hpp"
#include "fpbm/model/robot_state.hpp"

namespace fpbm {

/// The bodies of a clearance in a posture, in the base frame. Clearance::place() sets all members.
template <int N, typename Scalar = double, int Joints = N>
struct Placement {
  RobotState<N, Scalar, Joints> state;
  std::vector<Capsule<Scalar>> bodies;
  std::vector<Vector<3, Scalar>> centres;       ///< Of the smallest balls around the bodies [m].
  std::vector<Vector<3, Scalar>> speed_points;  ///< The points, or directions, whose speed is bounded.
};

}  // namespace fpbm
