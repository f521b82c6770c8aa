// The upper body of a humanoid, a Unitree G1 of 17 joints, reaches forward, lifts and turns with both hands. Both hands
// are on the first level. The waist bends as far as the hands need. With the centre of mass of the robot on the second
// level, the arms move more and the waist less. The header was written by
//   fpbm-cpp export-header g1_29dof_rev_1_0.urdf --base fixed --tip left_wrist_yaw_link --tip right_wrist_yaw_link
//       -o examples/17_upper_body.hpp
// from the URDF file of the package example-robot-data (BSD-3-Clause, Unitree Robotics).

#include "17_upper_body.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdio>
#include <fpbm/fpbm.hpp>

constexpr int kDof = upper_body::kDof;
using Joints = fpbm::Vector<kDof>;
using Robot = fpbm::Robot<kDof>;

struct Place {
  const char* name;
  double x, z, yaw;  // [m], [rad]
};
constexpr Place kPlaces[] = {{"forward", 0.3, 0.05, 0.0}, {"lifted", 0.3, 0.2, 0.0}, {"turned", 0.3, 0.2, 0.6}};
constexpr double kHalf = 0.16;  // Half of the distance between the hands [m].

/// The pose of a hand at a place in front of the pelvis, rotated about the vertical axis. side: 1 left, -1 right.
fpbm::Reference<fpbm::Pose> goal(const Place& place, double side) {
  fpbm::Transform<> at;
  at.R = Eigen::AngleAxisd(place.yaw, fpbm::Vector<3>::UnitZ()).toRotationMatrix();
  at.p = at.R * fpbm::Vector<3>(place.x, side * kHalf, place.z);
  return fpbm::Reference<fpbm::Pose>::hold(at);
}

/// The robot's centre of mass [m].
fpbm::Vector<3> center_of_mass(const Robot& robot, const Joints& q) {
  Robot::State state;
  robot.update(q, Joints::Zero(), state);
  fpbm::Vector<3> centre, velocity;
  fpbm::Matrix<3, kDof> J, Jd;
  fpbm::center_of_mass(robot, state, centre, velocity, J, Jd);
  return centre;
}

/// Prints errors, waist and centre of mass at each place. Returns false if the robot stops early. lower: references of
/// the levels below the hands.
template <typename Stack, typename... Lower>
bool reach(const Robot& robot, const Stack& stack, const Lower&... lower) {
  const auto scheme = fpbm::Balanced<kDof>(0.0, fpbm::UnitWeights{}, fpbm::NullSpace<kDof>().with_damping(2.0));
  const Joints q0 = Joints::Zero();
  auto tracker = fpbm::stack_tracker(robot, stack, scheme, q0);
  for (const Place& place : kPlaces) {
    const auto left = goal(place, 1.0);
    const auto right = goal(place, -1.0);
    auto tick = tracker.tick(left, right, lower...);
    for (int i = 1; i < 3000; ++i) tick = tracker.tick(left, right, lower...);
    if (fpbm::failed(tick.status)) return false;
    const double off = std::max(tick.error.template head<6>().norm(), tick.error.template segment<6>(6).norm());
    const double moved = (center_of_mass(robot, tick.q) - center_of_mass(robot, q0)).template head<2>().norm();
    std::printf("  %-8s hands off by %.0e m and rad; waist %5.2f, %5.2f, %5.2f rad; centre of mass %.3f m away\n",
                place.name, off, tick.q(0), tick.q(1), tick.q(2), moved);
  }
  return true;
}

int main() {
  auto tree = upper_body::tree();
  for (auto& each : tree.joints) {
    each.joint.bounds.velocity = 3.0;       // [rad/s]
    each.joint.bounds.acceleration = 20.0;  // [rad/s²]; the URDF file has no bounds on acceleration.
  }
  const Robot robot(tree);
  const fpbm::TaskGains<> gains(20.0, 100.0);  // k1 [1/s], k2 [1/s²]
  const fpbm::TaskLevel hands(fpbm::PoseTask<>{fpbm::frame_of(tree, "left_wrist_yaw_link"), gains},
                              fpbm::PoseTask<>{fpbm::frame_of(tree, "right_wrist_yaw_link"), gains});
  const fpbm::PostureTask<kDof> posture{fpbm::TaskGains<>(4.0, 4.0)};
  const auto home = fpbm::Reference<fpbm::JointSpace<kDof>>::hold(Joints::Zero());
  std::printf("hands, posture:\n");
  bool done = reach(robot, fpbm::Stack(hands, posture), home);
  std::printf("hands, centre of mass, posture:\n");
  const auto centre = fpbm::Reference<fpbm::Position<3>>::hold(center_of_mass(robot, Joints::Zero()));
  done = reach(robot, fpbm::Stack(hands, fpbm::CenterOfMassTask<2>{{10.0, 25.0}}, posture), centre, home) && done;
  return done ? 0 : 1;
}
