#pragma once

#include <initializer_list>
#include <vector>

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
/// rule above gives 15.0 rad/s² for the stall torque of 1.91 Nm at 7.4 V and a rotor inertia of 0.028 kg m². Inertias:
/// the same URDF file; the moving jaw is fixed at 0.
[[nodiscard]] inline Chain<> so101() {
  using arms::kHalfTurn;
  using arms::kRight;
  constexpr double kVelocity = 4.71;
  constexpr double kAcceleration = 7.5;
  const Vector<3> z(0.0, 0.0, 1.0);
  const auto within = [](double lower, double upper) { return JointBounds<>{lower, upper, kVelocity, kAcceleration}; };
  const std::vector<arms::Body> links = {
      // [kg], [m], xx, xy, xz, yy, yz, zz [kg m²]
      {0.100006, {-0.03076, -1.7e-5, -0.025271}, 8.3759e-5, 7.56e-8, -1.1634e-6, 8.10403e-5, 1.547e-7, 2.39783e-5},
      {0.103, {-0.089847, -0.008382, 0.018409}, 4.08e-5, -1.9782e-5, -4e-8, 0.000147318, 9e-9, 0.000142487},
      {0.104, {-0.09807, 0.003244, 0.018283}, 2.8744e-5, 7.412e-6, 1.264e-6, 0.000159844, -4.9e-8, 0.00014529},
      {0.079, {-0.000103, -0.038614, 0.028116}, 3.68263e-5, 1.79e-8, -5.28e-8, 2.5391e-5, 3.6412e-6, 2.1e-5},
      {0.099, {0.002445, 0.000158, -0.02861}, 4.25369e-5, -1.894e-7, -5.725e-7, 6.06362e-5, -1.564e-7, 3.99764e-5},
  };
  Chain<> chain = arms::chain_of(
      {
          {"shoulder_pan", {0.0388353, 0.0, 0.0624}, {kHalfTurn, 0.0, -kHalfTurn}, z, within(-1.91986, 1.91986)},
          {"shoulder_lift", {-0.0303992, -0.0182778, -0.0542}, {-kRight, -kRight, 0.0}, z, within(-1.74533, 1.74533)},
          {"elbow_flex", {-0.11257, -0.028, 0.0}, {0.0, 0.0, kRight}, z, within(-1.69, 1.69)},
          {"wrist_flex", {-0.1349, 0.0052, 0.0}, {0.0, 0.0, -kRight}, z, within(-1.65806, 1.65806)},
          {"wrist_roll", {0.0, -0.0611, 0.0181}, {kRight, 0.0486795, kHalfTurn}, z, within(-2.74385, 2.84121)},
      },
      arms::placed({-0.0079, -0.000218121, -0.0981274}, {0.0, kHalfTurn, 0.0}));
  for (Joint<>& joint : chain.joints) joint.drive.rotor_inertia = 0.028;
  return arms::powered(chain, links, std::vector<double>(links.size(), 1.91));
}

/// OpenArm v1.0 of Enactic, one arm, 7 joints, to the flange (openarm_link8), from openarm_link0.
///
/// Sources: openarm_description 1.0.0 (Apache-2.0), urdf/robot/v10.urdf.xacro without bimanual, for frames, ranges and
/// velocities; the velocities are no-load speeds of the motors. Accelerations: the rule above gives 65.7 rad/s².
/// Inertias and efforts: config/arm/v10 of the same package, inertials.yaml and joint_limits.yaml.
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
  const std::vector<arms::Body> links = {
      // [kg], [m], xx, xy, xz, yy, yz, zz [kg m²]
      {1.141668, {0.001147, 3.3e-5, 0.053953}, 0.001567, -1e-6, -2.9e-5, 0.001273, 0, 0.001016},
      {0.277509, {0.008396, 0, 0.032566}, 0.000359, 0, -0.000109, 0.000376, 0, 0.000232},
      {1.073863, {-0.002105, 0.000555, 0.088475}, 0.004372, 0, 1.1e-5, 0.004319, -3.6e-5, 0.000661},
      {0.559853, {-0.002901, -0.030306, 0.063396}, 0.000623, -1e-6, -1.9e-5, 0.000511, 3.8e-5, 0.000334},
      {0.550659, {-0.00305, 0.000887, 0.04308}, 0.000423, -8e-6, 6e-6, 0.000445, -6e-6, 0.000324},
      {0.35402, {-0.037137, 0.000332, -9.5e-5}, 0.000143, 4e-6, 0, 0.000157, 1e-6, 0.000159},
      {0.549977, {6.9e-5, -0.017662, 0.066519}, 0.000639, 0, 0, 0.000497, 8.9e-5, 0.000342},
  };
  const Chain<> chain = arms::chain_of(
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
  return arms::powered(chain, links, {40, 40, 27, 27, 7, 7, 7});
}

/// Unitree Z1, 6 joints, from its base (link00) to its flange, to which Unitree mounts the gripper (gripperStator).
///
/// Sources: robots/z1_description/xacro/z1.urdf of Unitree's unitree_ros (BSD-3-Clause) for frames, ranges and
/// velocities. Accelerations: the rule above gives 19.7 rad/s², with the gripper. Inertias, without the gripper, and
/// efforts: the same file.
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
  const std::vector<arms::Body> links = {
      // [kg], [m], xx, xy, xz, yy, yz, zz [kg m²]
      {0.673326, {2e-6, -0.000252, 0.023172}, 0.00128328, -6e-8, -4e-7, 0.00071931, 5e-7, 0.00083936},
      {1.191323, {-0.110126, 0.0024, 0.001583}, 0.00102138, 0.00062358, 5.13e-6, 0.02429457, -2.1e-6, 0.02466114},
      {0.839409,
       {0.106092, -0.005418, 0.034764},
       0.00108061,
       -8.669e-5,
       -0.00208102,
       0.00954238,
       -1.332e-5,
       0.00886621},
      {0.564046, {0.043667, 0.003647, -0.001702}, 0.00031576, 8.13e-5, 4.091e-5, 0.00092996, -5.96e-6, 0.00097912},
      {0.389385, {0.031215, 0, 0.006463}, 0.00017605, 4e-7, 5.689e-5, 0.00055896, -1.3e-7, 0.0005386},
      {0.288758, {0.024157, -0.000174, -0.001439}, 0.00018328, 1.22e-6, 5.4e-7, 0.0001475, 8e-8, 0.0001468},
  };
  const Chain<> chain = arms::chain_of(
      {
          {"joint1", {0.0, 0.0, 0.0585}, none, z, within(-150.0, 150.0)},
          {"joint2", {0.0, 0.0, 0.045}, none, y, within(0.0, 170.0)},
          {"joint3", {-0.35, 0.0, 0.0}, none, y, within(-165.0, 0.0)},
          {"joint4", {0.218, 0.0, 0.057}, none, y, within(-87.0, 87.0)},
          {"joint5", {0.07, 0.0, 0.0}, none, z, within(-77.0, 77.0)},
          {"joint6", {0.0492, 0.0, 0.0}, none, {1.0, 0.0, 0.0}, within(-160.0, 160.0)},
      },
      arms::placed({0.051, 0.0, 0.0}, none));
  return arms::powered(chain, links, {30, 60, 30, 30, 30, 30});
}

}  // namespace fpbm::presets
