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

/// KUKA LBR iiwa 14 R820, 7 joints, to its flange.
///
/// Source: KUKA "LBR iiwa 7 R800, LBR iiwa 14 R820, Specification" V5 of January 2015, figure 4-4, "Working envelope",
/// and section 4.3.2, "Axis data". The document has no table of Denavit-Hartenberg parameters. The signs of alpha are
/// chosen so that positive A2 and A6, and negative A4, tilt the upright arm to +x, as on the robot. KUKA publishes no
/// accelerations. The values here were measured on an arm (C. Larsen, "Including a Collaborative Robot in Digital Twin
/// Manufacturing Systems", Chalmers 2019, table 4; cited in Drake, pull requests 16377 and 20921). KUKA publishes no
/// inertias either. The values here, and the efforts, are from Drake (BSD-3-Clause),
/// manipulation/models/iiwa_description/urdf/iiwa14_no_collision.urdf.
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
  const std::vector<arms::Body> links = {
      // [kg], [m], xx, xy, xz, yy, yz, zz [kg m²]
      {5.76, {0, -0.03, 0.2775}, 0.033, 0, 0, 0.0333, 0, 0.0123},
      {6.35, {-0.0003, -0.059, 0.042}, 0.0305, 0, 0, 0.0304, 0, 0.011},
      {3.5, {0, 0.03, 0.3345}, 0.025, 0, 0, 0.0238, 0, 0.0076},
      {3.5, {0, 0.067, 0.034}, 0.017, 0, 0, 0.0164, 0, 0.006},
      {3.5, {-0.0001, -0.021, 0.2605}, 0.01, 0, 0, 0.0087, 0, 0.00449},
      {1.8, {0, -0.0006, 0.0004}, 0.0049, 0, 0, 0.0047, 0, 0.0036},
      {1.2, {0, 0, 0.101}, 0.001, 0, 0, 0.001, 0, 0.001},
  };
  return arms::powered(arms::driven(chain, "joint_a", bounds), links, {320, 320, 176, 176, 110, 40, 40});
}

/// Kinova Gen3 with a spherical wrist, 7 joints, to the frame of its interface module.
///
/// Source: Kinova "Gen3 Ultra lightweight robot, User Guide" R07 of 2022, table 94, "7 DoF spherical Classical DH
/// parameters", and tables 39 and 40 for the bounds. The base row of table 94 is alpha of the first joint here. The
/// guide rounds lengths to 0.1 mm and omits the offset at joint 6. The lengths here are from GEN3_URDF_V12 of Kinova's
/// kortex_description, which has all digits. Bounds on acceleration depend on the control mode. The bounds here are the
/// hard limits of Kinova's ros_kortex, gen3_move_it_config/config/7dof/hard_joint_limits.yaml. Inertias and efforts:
/// GEN3_URDF_V12 (BSD-3-Clause).
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
  const std::vector<arms::Body> links = {
      // [kg], [m], xx, xy, xz, yy, yz, zz [kg m²]
      {1.3773, {-2.3e-5, -0.010364, 0.05502}, 0.00457, 1e-6, 2e-6, 0.004831, 0.000448, 0.001409},
      {1.1636, {4.4e-5, 0.09958, -0.006903}, 0.011088, 5e-6, 0, 0.001072, 0.000691, 0.011255},
      {1.1636, {-4.4e-5, -0.006641, 0.092488}, 0.010932, 0, -7e-6, 0.011127, 0.000606, 0.001043},
      {0.9302, {1.8e-5, 0.075478, -0.008631}, 0.008147, -1e-6, 0, 0.000631, 0.0005, 0.008316},
      {0.6781, {1e-6, -0.009432, 0.042047}, 0.001596, 0, 0, 0.001607, 0.000256, 0.000399},
      {0.6781, {-1e-6, 0.045483, -0.009475}, 0.001641, 0, 0, 0.00041, 0.000278, 0.001641},
      {0.5006, {-0.000281, -0.011402, 0.031727}, 0.000587, 3e-6, 3e-6, 0.000369, 0.000118, 0.000609},
  };
  return arms::powered(arms::driven(chain, "joint_", bounds), links, {39, 39, 39, 39, 9, 9, 9});
}

/// UFACTORY xArm 7, 7 joints, to its flange.
///
/// Sources: UFACTORY, "Kinematic and Dynamic Parameters of UFACTORY xArm Series", modified DH parameters, and the URDF
/// of the robot in xarm_ros2, xarm_description, for the bounds on position and velocity. The accelerations are from
/// xarm_moveit_config/config/xarm7/joint_limits.yaml of xarm_ros2. Inertias and efforts: xarm_description
/// (BSD-3-Clause), as in example-robot-data 6.0.0, xarm7.urdf.
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
  const std::vector<arms::Body> links = {
      // [kg], [m], xx, xy, xz, yy, yz, zz [kg m²]
      {2.382, {-0.0002, 0.02905, -0.01233}, 0.0056905, -1.579e-5, 5.13e-6, 0.0049566, -0.00087338, 0.00331665},
      {1.869, {0.00022, -0.12856, 0.01735}, 0.0095989, 1.54e-6, 5.56e-6, 0.0038247, -0.00317156, 0.00756567},
      {1.6383, {0.0466, -0.02463, -0.00768}, 0.00310955, 0.00030837, -0.00058453, 0.00264483, 0.00033889, 0.0026624},
      {1.7269, {0.07047, -0.11575, 0.012}, 0.005889, 0.00137112, 0.00088143, 0.00359703, -0.00176216, 0.00543244},
      {1.3203, {-0.00032, 0.01604, -0.026}, 0.00534665, 1.512e-5, -3.7e-7, 0.0049779, -0.00022132, 0.0013624},
      {1.325, {0.06469, 0.03278, 0.02141}, 0.0014745, -0.000488, 0.0002953, 0.0019037, 0.00014749, 0.0023652},
      {0.17, {0, -0.00677, -0.01098}, 9.3e-5, 0, 0, 5.87e-5, -3.6e-6, 0.000132},
  };
  return arms::powered(arms::driven(chain, "joint", bounds), links, {50, 50, 30, 30, 30, 20, 20});
}

}  // namespace fpbm::presets
