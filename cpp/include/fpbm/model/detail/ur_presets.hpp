#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "fpbm/model/chain.hpp"
#include "fpbm/model/detail/preset_parts.hpp"
#include "fpbm/model/dh.hpp"
#include "fpbm/model/joint.hpp"

/// Presets of the arms of Universal Robots; see presets.hpp.
namespace fpbm::presets {

namespace arms {

/// Arm of Universal Robots; all models have the same structure. DH parameters: a of the two long links, d of joints 1,
/// 4, 5 and 6 [m]. speeds: bounds of the two shoulder joints and of the four other joints [deg/s]. links: in the frames
/// of the table, of which frame i moves with joint i. efforts: bounds of the shoulder, the elbow and the wrist [Nm].
[[nodiscard]] inline Chain<> universal_robot(const std::vector<double>& a, const std::vector<double>& d,
                                             const std::vector<double>& speeds, const std::vector<Body>& links,
                                             const std::vector<double>& efforts) {
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
    chain.joints[i].bounds.effort = efforts[i < 2 ? 0 : i < 3 ? 1 : 2];
    chain.joints[i].moved = links[i].in(i + 1 < chain.joints.size() ? chain.joints[i + 1].placement : chain.tip);
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
/// ROS driver, ur_moveit_config/config/joint_limits.yaml. Inertias: the same table of Universal Robots, as in
/// Universal_Robots_ROS2_Description (BSD-3-Clause), config/ur5e/physical_parameters.yaml. Efforts: the same
/// repository, config/ur5e/joint_limits.yaml.
[[nodiscard]] inline Chain<> ur5e() {
  const std::vector<arms::Body> links = {
      // [kg], [m], xx, xy, xz, yy, yz, zz [kg m²]
      {3.761, {0, -0.02561, 0.00193}, 0.0070021, 7.3e-7, -1.053e-5, 0.00648091, 0.00049994, 0.00657286},
      {8.058, {0.2125, 0, 0.11336}, 0.01505885, -5.4e-5, 5.63e-6, 0.33388086, -1.81e-6, 0.33247207},
      {2.846, {0.15, 0, 0.0265}, 0.00399632, -1.365e-5, 0.00137272, 0.07879254, -6.6e-6, 0.0784851},
      {1.37, {0, -0.0018, 0.01634}, 0.00165491, -2.82e-6, -4.38e-6, 0.00135962, 0.00010157, 0.00126279},
      {1.3, {0, 0.0018, 0.01634}, 0.00135617, -2.74e-6, 4.44e-6, 0.00127827, -5.048e-5, 0.00096614},
      {0.365, {0, 0, -0.001159}, 0.00018694, 6e-8, -1.7e-7, 0.00018908, -9.2e-7, 0.00025756},
  };
  return arms::universal_robot({-0.425, -0.3922}, {0.1625, 0.1333, 0.0997, 0.0996}, {180.0, 180.0}, links,
                               {150.0, 150.0, 28.0});
}

/// Universal Robots UR10e, 6 joints, with the frames and sources of the UR5e.
[[nodiscard]] inline Chain<> ur10e() {
  const std::vector<arms::Body> links = {
      // [kg], [m], xx, xy, xz, yy, yz, zz [kg m²]
      {7.369, {0.021, 0, 0.027}, 0.03408, 2e-5, -0.00425, 0.03529, 8e-5, 0.02156},
      {13.051, {0.38, 0, 0.158}, 0.02814, 5e-5, -0.01561, 0.77068, 2e-5, 0.76943},
      {3.989, {0.24, 0, 0.068}, 0.01014, 8e-5, 0.00916, 0.30928, 0, 0.30646},
      {2.1, {0, 0.007, 0.018}, 0.00296, -1e-5, 0, 0.00222, -0.00024, 0.00258},
      {1.98, {0, 0.007, 0.018}, 0.00296, -1e-5, 0, 0.00222, -0.00024, 0.00258},
      {0.615, {0, 0, -0.026}, 0.0004, 0, 0, 0.00041, 0, 0.00034},
  };
  return arms::universal_robot({-0.6127, -0.57155}, {0.1807, 0.17415, 0.11985, 0.11655}, {120.0, 180.0}, links,
                               {330.0, 150.0, 56.0});
}

}  // namespace fpbm::presets
