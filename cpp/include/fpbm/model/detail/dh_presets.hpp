#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "fpbm/model/chain.hpp"
#include "fpbm/model/detail/preset_parts.hpp"
#include "fpbm/model/dh.hpp"
#include "fpbm/model/joint.hpp"

/// Presets of arms with a table of Denavit-Hartenberg parameters; see presets.hpp.
namespace fpbm::presets {

/// Franka Emika Panda, 7 joints, to its flange (link 8 in ROS).
///
/// Source: Franka Control Interface documentation of August 2025, "Robot and interface specifications": "Limits for
/// Panda", and "Denavit–Hartenberg parameters" in Craig's convention, which also hold for the Franka Research 3.
[[nodiscard]] inline Chain<> panda() {
  using arms::kRight;
  Chain<> chain = modified_dh<double>({
      // a [m], alpha [rad], d [m]
      {0.0, 0.0, 0.333},
      {0.0, -kRight, 0.0},
      {0.0, kRight, 0.316},
      {0.0825, kRight, 0.0},
      {-0.0825, -kRight, 0.384},
      {0.0, kRight, 0.0},
      {0.088, kRight, 0.0},
  });
  chain.tip.p(2) = 0.107;
  const std::vector<JointBounds<>> bounds = {
      // [rad], [rad], [rad/s], [rad/s²], [rad/s³]
      {-2.8973, 2.8973, 2.1750, 15.0, 7500.0},  {-1.7628, 1.7628, 2.1750, 7.5, 3750.0},
      {-2.8973, 2.8973, 2.1750, 10.0, 5000.0},  {-3.0718, -0.0698, 2.1750, 12.5, 6250.0},
      {-2.8973, 2.8973, 2.6100, 15.0, 7500.0},  {-0.0175, 3.7525, 2.6100, 20.0, 10000.0},
      {-2.8973, 2.8973, 2.6100, 20.0, 10000.0},
  };
  return arms::driven(chain, "panda_joint", bounds);
}

/// Franka Research 3, 7 joints, to its flange. The links are the links of the Panda.
///
/// Sources: bounds on position, on velocity, and on velocity near the ends from the URDF of the robot in libfranka
/// 0.21, test/fr3.urdf; accelerations and jerks from the Franka Control Interface documentation of August 2025, "Limits
/// for Franka Research 3".
[[nodiscard]] inline Chain<> fr3() {
  constexpr double kAcceleration = 10.0;
  constexpr double kJerk = 5000.0;
  const std::vector<JointBounds<>> bounds = {
      // [rad], [rad], [rad/s], [rad/s²], [rad/s³], offset [rad/s], deceleration [rad/s²]
      {-2.7501, 2.7501, 2.62, kAcceleration, kJerk, 0.30, 6.0},
      {-1.7918, 1.7918, 2.62, kAcceleration, kJerk, 0.20, 2.585},
      {-2.9065, 2.9065, 2.62, kAcceleration, kJerk, 0.20, 3.5},
      {-3.0481, -0.1458, 2.62, kAcceleration, kJerk, 0.30, 4.0},
      {-2.8101, 2.8101, 5.26, kAcceleration, kJerk, 0.35, 17.0},
      {0.54092, 4.5205, 4.18, kAcceleration, kJerk, 0.35, 5.5},
      {-3.0196, 3.0196, 5.26, kAcceleration, kJerk, 0.35, 17.0},
  };
  return arms::driven(panda(), "fr3_joint", bounds);
}

/// KUKA LBR iiwa 14 R820, 7 joints, to its flange.
///
/// Source: KUKA "LBR iiwa 7 R800, LBR iiwa 14 R820, Specification" V5 of January 2015, figure 4-4, "Working envelope",
/// and section 4.3.2, "Axis data". The document has no table of Denavit-Hartenberg parameters. The signs of alpha are
/// chosen so that positive A2 and A6, and negative A4, tilt the upright arm to +x, as on the robot. KUKA publishes no
/// accelerations. The values here were measured on an arm (C. Larsen, "Including a Collaborative Robot in Digital Twin
/// Manufacturing Systems", Chalmers 2019, table 4; cited in Drake, pull requests 16377 and 20921).
[[nodiscard]] inline Chain<> iiwa14() {
  using arms::kRight;
  const Chain<> chain = classic_dh<double>({
      // a [m], alpha [rad], d [m]
      {0.0, -kRight, 0.360},
      {0.0, kRight, 0.0},
      {0.0, kRight, 0.420},
      {0.0, -kRight, 0.0},
      {0.0, -kRight, 0.400},
      {0.0, kRight, 0.0},
      {0.0, 0.0, 0.126},
  });
  const std::vector<arms::BothWays> bounds = {
      {170.0, 85.0, 8.57},   {120.0, 85.0, 8.57},   {170.0, 100.0, 8.74},  {120.0, 75.0, 11.36},
      {170.0, 130.0, 12.23}, {120.0, 135.0, 15.72}, {175.0, 135.0, 15.72},
  };
  return arms::driven(chain, "joint_a", bounds);
}

/// Kinova Gen3 with a spherical wrist, 7 joints, to the frame of its interface module.
///
/// Source: Kinova "Gen3 Ultra lightweight robot, User Guide" R07 of 2022, table 94, "7 DoF spherical Classical DH
/// parameters", and tables 39 and 40 for the bounds. The base row of table 94 is alpha of the first joint here. The
/// guide rounds lengths to 0.1 mm and omits the offset at joint 6. The lengths here are from GEN3_URDF_V12 of Kinova's
/// kortex_description, which has all digits. Bounds on acceleration depend on the control mode. The bounds here are the
/// hard limits of Kinova's ros_kortex, gen3_move_it_config/config/7dof/hard_joint_limits.yaml.
[[nodiscard]] inline Chain<> gen3() {
  using arms::kHalfTurn;
  using arms::kRight;
  constexpr JointType kTurns = JointType::kRevolute;
  constexpr JointType kEndless = JointType::kContinuous;
  constexpr double kAny = JointBounds<>::kNone;
  Chain<> chain = modified_dh<double>({
      // a [m], alpha [rad], d [m], theta [rad]
      {0.0, kHalfTurn, -(0.15643 + 0.12838), 0.0, kEndless},
      {0.0, kRight, -(0.005375 + 0.006375), kHalfTurn, kTurns},
      {0.0, kRight, -(0.21038 + 0.21038), kHalfTurn, kEndless},
      {0.0, kRight, -(0.006375 + 0.006375), kHalfTurn, kTurns},
      {0.0, kRight, -(0.20843 + 0.10593), kHalfTurn, kEndless},
      {0.0, kRight, -(0.00017505 + 0.00017505), kHalfTurn, kTurns},
      {0.0, kRight, -(0.10593 + 0.061525), kHalfTurn, kEndless},
  });
  chain.tip = dh::along_x<double>({0.0, kHalfTurn});
  const std::vector<arms::BothWays> bounds = {
      {kAny, 79.64, 4.94}, {128.9, 79.64, 4.94}, {kAny, 79.64, 4.94}, {147.8, 79.64, 4.94},
      {kAny, 69.91, 9.5},  {120.3, 69.91, 9.5},  {kAny, 69.91, 9.5},
  };
  return arms::driven(chain, "joint_", bounds);
}

namespace arms {

/// Arm of Universal Robots; all models have the same structure. DH parameters: a of the two long links, d of joints 1,
/// 4, 5 and 6 [m]. speeds: bounds of the two shoulder joints and of the four other joints [deg/s].
[[nodiscard]] inline Chain<> universal_robot(const std::vector<double>& a, const std::vector<double>& d,
                                             const std::vector<double>& speeds) {
  Chain<> chain = classic_dh<double>({
      // a [m], alpha [rad], d [m]
      {0.0, kRight, d[0]},
      {a[0], 0.0, 0.0},
      {a[1], 0.0, 0.0},
      {0.0, kRight, d[1]},
      {0.0, -kRight, d[2]},
      {0.0, 0.0, d[3]},
  });
  constexpr const char* kNames[] = {"shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint",
                                    "wrist_1_joint",      "wrist_2_joint",       "wrist_3_joint"};
  for (std::size_t i = 0; i < chain.joints.size(); ++i) {
    chain.joints[i].name = kNames[i];
    chain.joints[i].bounds = BothWays{360.0, speeds[i < 2 ? 0 : 1], 5.0};
  }
  return chain;
}

}  // namespace arms

/// Universal Robots UR5e, 6 joints, to its flange (tool0 in ROS), from the base frame of its controller (base in ROS,
/// which is base_link rotated by 180°).
///
/// Sources: Universal Robots, "DH Parameters for calculations of kinematics and dynamics", and the user manual of the
/// e-Series 5.8 for the bounds on position and velocity. ROS halves the range of the elbow for planners. Universal
/// Robots publishes no accelerations, since the drives are limited by torque. 5 rad/s² is the conservative value of the
/// ROS driver, ur_moveit_config/config/joint_limits.yaml.
[[nodiscard]] inline Chain<> ur5e() {
  return arms::universal_robot({-0.425, -0.3922}, {0.1625, 0.1333, 0.0997, 0.0996}, {180.0, 180.0});
}

/// Universal Robots UR10e, 6 joints, with the frames and sources of the UR5e.
[[nodiscard]] inline Chain<> ur10e() {
  return arms::universal_robot({-0.6127, -0.57155}, {0.1807, 0.17415, 0.11985, 0.11655}, {120.0, 180.0});
}

/// UFACTORY xArm 7, 7 joints, to its flange.
///
/// Sources: UFACTORY, "Kinematic and Dynamic Parameters of UFACTORY xArm Series", modified DH parameters, and the URDF
/// of the robot in xarm_ros2, xarm_description, for the bounds on position and velocity. The accelerations are from
/// xarm_moveit_config/config/xarm7/joint_limits.yaml of xarm_ros2.
[[nodiscard]] inline Chain<> xarm7() {
  using arms::kRight;
  constexpr double kPi = arms::kHalfTurn;
  constexpr double kVelocity = 3.14;
  constexpr double kAcceleration = 20.0;
  const Chain<> chain = modified_dh<double>({
      // a [m], alpha [rad], d [m]
      {0.0, 0.0, 0.267},
      {0.0, -kRight, 0.0},
      {0.0, kRight, 0.293},
      {0.0525, kRight, 0.0},
      {0.0775, kRight, 0.3425},
      {0.0, kRight, 0.0},
      {0.076, -kRight, 0.097},
  });
  const std::vector<JointBounds<>> bounds = {
      // [rad], [rad], [rad/s], [rad/s²]
      {-2.0 * kPi, 2.0 * kPi, kVelocity, kAcceleration}, {-2.059, 2.0944, kVelocity, kAcceleration},
      {-2.0 * kPi, 2.0 * kPi, kVelocity, kAcceleration}, {-0.19198, 3.927, kVelocity, kAcceleration},
      {-2.0 * kPi, 2.0 * kPi, kVelocity, kAcceleration}, {-1.69297, kPi, kVelocity, kAcceleration},
      {-2.0 * kPi, 2.0 * kPi, kVelocity, kAcceleration},
  };
  return arms::driven(chain, "joint", bounds);
}

}  // namespace fpbm::presets
