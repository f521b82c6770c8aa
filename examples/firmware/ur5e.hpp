// Written by fpbm-cpp export-header from preset ur5e. Do not edit.
#pragma once

#include <array>
#include <fpbm/model/serial_arm.hpp>

namespace ur5e {

inline constexpr int kDof = 6;

inline constexpr std::array<const char*, kDof> kJointNames = {
    "shoulder_pan_joint",   // q(0)
    "shoulder_lift_joint",  // q(1)
    "elbow_joint",          // q(2)
    "wrist_1_joint",        // q(3)
    "wrist_2_joint",        // q(4)
    "wrist_3_joint",        // q(5)
};

/// The joints from base to tip, each placed in the frame of the previous joint [m].
/// Bounds are lower, upper [rad] or [m], velocity, acceleration, jerk, and the offset and deceleration of the velocity
/// bound near an end of the range; effort [Nm] or [N]. A value that is left out means no bound. moved: mass [kg],
/// centre [m] and inertia [kg m²] of the link. drive: inertia of the rotor, viscous and dry friction.
inline fpbm::Chain<float, 6> chain() {
  fpbm::Chain<float, 6> chain;

  chain.joints[0].name = "shoulder_pan_joint";
  chain.joints[0].type = fpbm::JointType::kRevolute;
  chain.joints[0].axis = {0.0F, 0.0F, 1.0F};
  chain.joints[0].bounds = {-6.283185307179586F, 6.283185307179586F, 3.141592653589793F, 5.0F};
  chain.joints[0].bounds.effort = 150.0F;
  chain.joints[0].moved = {3.761F, {0.0F, -0.0019300000000000057F, 0.13689F}};
  chain.joints[0].moved.inertia = fpbm::Matrix<3, 3, float>{
      {0.0070021F, 1.053e-05F, 7.299999999999977e-07F},
      {1.053e-05F, 0.00657286F, -0.00049994F},
      {7.299999999999977e-07F, -0.00049994F, 0.00648091F},
  };

  chain.joints[1].name = "shoulder_lift_joint";
  chain.joints[1].type = fpbm::JointType::kRevolute;
  chain.joints[1].placement.p = {0.0F, 0.0F, 0.1625F};
  chain.joints[1].placement.R = fpbm::Matrix<3, 3, float>{
      {1.0F, 0.0F, 0.0F},
      {0.0F, 2.220446049250313e-16F, -1.0F},
      {0.0F, 1.0F, 2.220446049250313e-16F},
  };
  chain.joints[1].axis = {0.0F, 0.0F, 1.0F};
  chain.joints[1].bounds = {-6.283185307179586F, 6.283185307179586F, 3.141592653589793F, 5.0F};
  chain.joints[1].bounds.effort = 150.0F;
  chain.joints[1].moved = {8.058F, {-0.2125F, 0.0F, 0.11336F}};
  chain.joints[1].moved.inertia = fpbm::Matrix<3, 3, float>{
      {0.01505885F, -5.4e-05F, 5.63e-06F},
      {-5.4e-05F, 0.33388086F, -1.81e-06F},
      {5.63e-06F, -1.81e-06F, 0.33247207F},
  };

  chain.joints[2].name = "elbow_joint";
  chain.joints[2].type = fpbm::JointType::kRevolute;
  chain.joints[2].placement.p = {-0.425F, 0.0F, 0.0F};
  chain.joints[2].axis = {0.0F, 0.0F, 1.0F};
  chain.joints[2].bounds = {-6.283185307179586F, 6.283185307179586F, 3.141592653589793F, 5.0F};
  chain.joints[2].bounds.effort = 150.0F;
  chain.joints[2].moved = {2.846F, {-0.2422F, 0.0F, 0.0265F}};
  chain.joints[2].moved.inertia = fpbm::Matrix<3, 3, float>{
      {0.00399632F, -1.365e-05F, 0.00137272F},
      {-1.365e-05F, 0.07879254F, -6.6e-06F},
      {0.00137272F, -6.6e-06F, 0.0784851F},
  };

  chain.joints[3].name = "wrist_1_joint";
  chain.joints[3].type = fpbm::JointType::kRevolute;
  chain.joints[3].placement.p = {-0.3922F, 0.0F, 0.0F};
  chain.joints[3].axis = {0.0F, 0.0F, 1.0F};
  chain.joints[3].bounds = {-6.283185307179586F, 6.283185307179586F, 3.141592653589793F, 5.0F};
  chain.joints[3].bounds.effort = 28.0F;
  chain.joints[3].moved = {1.37F, {0.0F, -0.01634F, 0.1315F}};
  chain.joints[3].moved.inertia = fpbm::Matrix<3, 3, float>{
      {0.00165491F, 4.3799999999999996e-06F, -2.820000000000001e-06F},
      {4.3799999999999996e-06F, 0.00126279F, -0.00010156999999999999F},
      {-2.820000000000001e-06F, -0.00010156999999999999F, 0.00135962F},
  };

  chain.joints[4].name = "wrist_2_joint";
  chain.joints[4].type = fpbm::JointType::kRevolute;
  chain.joints[4].placement.p = {0.0F, 0.0F, 0.1333F};
  chain.joints[4].placement.R = fpbm::Matrix<3, 3, float>{
      {1.0F, 0.0F, 0.0F},
      {0.0F, 2.220446049250313e-16F, -1.0F},
      {0.0F, 1.0F, 2.220446049250313e-16F},
  };
  chain.joints[4].axis = {0.0F, 0.0F, 1.0F};
  chain.joints[4].bounds = {-6.283185307179586F, 6.283185307179586F, 3.141592653589793F, 5.0F};
  chain.joints[4].bounds.effort = 28.0F;
  chain.joints[4].moved = {1.3F, {0.0F, 0.01634F, 0.0979F}};
  chain.joints[4].moved.inertia = fpbm::Matrix<3, 3, float>{
      {0.00135617F, 4.439999999999999e-06F, 2.740000000000001e-06F},
      {4.439999999999999e-06F, 0.00096614F, 5.047999999999993e-05F},
      {2.740000000000001e-06F, 5.047999999999993e-05F, 0.00127827F},
  };

  chain.joints[5].name = "wrist_3_joint";
  chain.joints[5].type = fpbm::JointType::kRevolute;
  chain.joints[5].placement.p = {0.0F, 0.0F, 0.0997F};
  chain.joints[5].placement.R = fpbm::Matrix<3, 3, float>{
      {1.0F, 0.0F, 0.0F},
      {0.0F, 2.220446049250313e-16F, 1.0F},
      {0.0F, -1.0F, 2.220446049250313e-16F},
  };
  chain.joints[5].axis = {0.0F, 0.0F, 1.0F};
  chain.joints[5].bounds = {-6.283185307179586F, 6.283185307179586F, 3.141592653589793F, 5.0F};
  chain.joints[5].bounds.effort = 28.0F;
  chain.joints[5].moved = {0.365F, {0.0F, 0.0F, 0.098441F}};
  chain.joints[5].moved.inertia = fpbm::Matrix<3, 3, float>{
      {0.00018694F, 6e-08F, -1.7e-07F},
      {6e-08F, 0.00018908F, -9.2e-07F},
      {-1.7e-07F, -9.2e-07F, 0.00025756F},
  };

  chain.tip.p = {0.0F, 0.0F, 0.0996F};

  return chain;
}

inline fpbm::SerialArm<kDof, float> arm() {
  return fpbm::SerialArm<kDof, float>(chain());
}

}  // namespace ur5e
