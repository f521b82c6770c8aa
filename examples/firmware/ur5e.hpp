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
/// bound near an end of the range. A value that is left out means no bound.
inline fpbm::Chain<float, 6> chain() {
  fpbm::Chain<float, 6> chain;

  chain.joints[0].name = "shoulder_pan_joint";
  chain.joints[0].type = fpbm::JointType::kRevolute;
  chain.joints[0].axis = {0.0F, 0.0F, 1.0F};
  chain.joints[0].bounds = {-6.283185307179586F, 6.283185307179586F, 3.141592653589793F, 5.0F};

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

  chain.joints[2].name = "elbow_joint";
  chain.joints[2].type = fpbm::JointType::kRevolute;
  chain.joints[2].placement.p = {-0.425F, 0.0F, 0.0F};
  chain.joints[2].axis = {0.0F, 0.0F, 1.0F};
  chain.joints[2].bounds = {-6.283185307179586F, 6.283185307179586F, 3.141592653589793F, 5.0F};

  chain.joints[3].name = "wrist_1_joint";
  chain.joints[3].type = fpbm::JointType::kRevolute;
  chain.joints[3].placement.p = {-0.3922F, 0.0F, 0.0F};
  chain.joints[3].axis = {0.0F, 0.0F, 1.0F};
  chain.joints[3].bounds = {-6.283185307179586F, 6.283185307179586F, 3.141592653589793F, 5.0F};

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

  chain.tip.p = {0.0F, 0.0F, 0.0996F};

  return chain;
}

inline fpbm::SerialArm<kDof, float> arm() {
  return fpbm::SerialArm<kDof, float>(chain());
}

}  // namespace ur5e
