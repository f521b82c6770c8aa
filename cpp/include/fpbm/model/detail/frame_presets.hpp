#pragma once

#include <initializer_list>

#include "fpbm/geometry/rotation.hpp"
#include "fpbm/model/chain.hpp"
#include "fpbm/model/detail/preset_parts.hpp"
#include "fpbm/model/joint.hpp"

/// Presets of arms with joint frames from a URDF file; see presets.hpp.
///
/// The makers publish no bounds on acceleration. Each value here is half of the acceleration that the torques of the
/// motors allow, rounded: for all joints at the same time, at rest, without payload, in the least favourable of 4000
/// random postures, by Pinocchio 4.1.0 from the masses in the URDF file. The other half is for payload and friction.
namespace fpbm::presets {

namespace arms {

/// Joint in the form of a URDF file.
struct Frame {
  const char* name;
  Vector<3> origin;  ///< [m]
  Vector<3> turn;    ///< Roll, pitch, yaw [rad].
  Vector<3> axis;
  JointBounds<> bounds;
};

[[nodiscard]] inline Chain<> chain_of(std::initializer_list<Frame> frames, const Transform<>& tip) {
  Chain<> chain{{}, tip};
  for (const Frame& each : frames) {
    chain.joints.push_back(
        {JointType::kRevolute, placed(each.origin, each.turn), each.axis, each.bounds, each.name, {}});
  }
  return chain;
}

}  // namespace arms

/// SO-101 of TheRobotStudio and Hugging Face, 5 joints, to the frame between the jaws (gripper_frame_link). Zero is
/// the middle of each range, as in LeRobot.
///
/// Sources: so101_new_calib.urdf of TheRobotStudio/SO-ARM100 (Apache-2.0) for frames and ranges; right angles are
/// exact here, and numbers below 1 µm are omitted. Velocity: Feetech STS3215, 45 rpm without load. Accelerations: the
/// rule above gives 15.0 rad/s² for the stall torque of 1.91 Nm at 7.4 V and a rotor inertia of 0.028 kg m².
[[nodiscard]] inline Chain<> so101() {
  using arms::kHalfTurn;
  using arms::kRight;
  constexpr double kVelocity = 4.71;
  constexpr double kAcceleration = 7.5;
  const Vector<3> z(0.0, 0.0, 1.0);
  const auto within = [](double lower, double upper) { return JointBounds<>{lower, upper, kVelocity, kAcceleration}; };
  return arms::chain_of(
      {
          {"shoulder_pan", {0.0388353, 0.0, 0.0624}, {kHalfTurn, 0.0, -kHalfTurn}, z, within(-1.91986, 1.91986)},
          {"shoulder_lift", {-0.0303992, -0.0182778, -0.0542}, {-kRight, -kRight, 0.0}, z, within(-1.74533, 1.74533)},
          {"elbow_flex", {-0.11257, -0.028, 0.0}, {0.0, 0.0, kRight}, z, within(-1.69, 1.69)},
          {"wrist_flex", {-0.1349, 0.0052, 0.0}, {0.0, 0.0, -kRight}, z, within(-1.65806, 1.65806)},
          {"wrist_roll", {0.0, -0.0611, 0.0181}, {kRight, 0.0486795, kHalfTurn}, z, within(-2.74385, 2.84121)},
      },
      arms::placed({-0.0079, -0.000218121, -0.0981274}, {0.0, kHalfTurn, 0.0}));
}

/// OpenArm v1.0 of Enactic, one arm, 7 joints, to the flange (openarm_link8), from openarm_link0.
///
/// Sources: openarm_description 1.0.0 (Apache-2.0), urdf/robot/v10.urdf.xacro without bimanual, for frames, ranges and
/// velocities; the velocities are no-load speeds of the motors. Accelerations: the rule above gives 65.7 rad/s².
[[nodiscard]] inline Chain<> openarm() {
  constexpr double kAcceleration = 30.0;
  const Vector<3> none(0.0, 0.0, 0.0);
  const Vector<3> z(0.0, 0.0, 1.0);
  const auto both_ways = [](double position, double velocity) {
    return JointBounds<>{-position, position, velocity, kAcceleration};
  };
  const Vector<3> minus_x(-1.0, 0.0, 0.0);
  const JointBounds<> shoulder{-1.396263, 3.490659, 16.754666, kAcceleration};
  const JointBounds<> elbow{0.0, 2.443461, 5.445426, kAcceleration};
  return arms::chain_of(
      {
          {"openarm_joint1", {0.0, 0.0, 0.0625}, none, z, shoulder},
          {"openarm_joint2", {-0.0301, 0.0, 0.06}, none, minus_x, both_ways(1.745329, 16.754666)},
          {"openarm_joint3", {0.0301, 0.0, 0.06625}, none, z, both_ways(1.570796, 5.445426)},
          {"openarm_joint4", {0.0, 0.0315, 0.15375}, none, {0.0, 1.0, 0.0}, elbow},
          {"openarm_joint5", {0.0, -0.0315, 0.0955}, none, z, both_ways(1.570796, 20.943946)},
          {"openarm_joint6", {0.0375, 0.0, 0.1205}, none, {1.0, 0.0, 0.0}, both_ways(0.785398, 20.943946)},
          {"openarm_joint7", {-0.0375, 0.0, 0.0}, none, {0.0, -1.0, 0.0}, both_ways(1.570796, 20.943946)},
      },
      arms::placed({0.000001, 0.0205, 0.0}, none));
}

/// Unitree Z1, 6 joints, from its base (link00) to its flange, to which Unitree mounts the gripper (gripperStator).
///
/// Sources: robots/z1_description/xacro/z1.urdf of Unitree's unitree_ros (BSD-3-Clause) for frames, ranges and
/// velocities. Accelerations: the rule above gives 19.7 rad/s², with the gripper.
[[nodiscard]] inline Chain<> z1() {
  constexpr double kVelocity = 3.1415;
  constexpr double kAcceleration = 10.0;
  using arms::kDegree;
  const Vector<3> none(0.0, 0.0, 0.0);
  const Vector<3> y(0.0, 1.0, 0.0);
  const Vector<3> z(0.0, 0.0, 1.0);
  const auto within = [](double lower, double upper) {
    return JointBounds<>{lower * kDegree, upper * kDegree, kVelocity, kAcceleration};
  };
  return arms::chain_of(
      {
          {"joint1", {0.0, 0.0, 0.0585}, none, z, within(-150.0, 150.0)},
          {"joint2", {0.0, 0.0, 0.045}, none, y, within(0.0, 170.0)},
          {"joint3", {-0.35, 0.0, 0.0}, none, y, within(-165.0, 0.0)},
          {"joint4", {0.218, 0.0, 0.057}, none, y, within(-87.0, 87.0)},
          {"joint5", {0.07, 0.0, 0.0}, none, z, within(-77.0, 77.0)},
          {"joint6", {0.0492, 0.0, 0.0}, none, {1.0, 0.0, 0.0}, within(-160.0, 160.0)},
      },
      arms::placed({0.051, 0.0, 0.0}, none));
}

}  // namespace fpbm::presets
