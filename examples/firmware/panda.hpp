// Written by fpbm-cpp export-header from preset panda. Do not edit.
#pragma once

#include <array>
#include <fpbm/model/serial_arm.hpp>

namespace panda {

inline constexpr int kDof = 7;

inline constexpr std::array<const char*, kDof> kJointNames = {
    "panda_joint1",  // q(0)
    "panda_joint2",  // q(1)
    "panda_joint3",  // q(2)
    "panda_joint4",  // q(3)
    "panda_joint5",  // q(4)
    "panda_joint6",  // q(5)
    "panda_joint7",  // q(6)
};

/// The joints from base to tip, each placed in the frame of the previous joint [m].
/// Bounds are lower, upper [rad] or [m], velocity, acceleration, jerk, and the offset and deceleration of the velocity
/// bound near an end of the range. A value that is left out means no bound.
inline fpbm::Chain<float, 7> chain() {
  fpbm::Chain<float, 7> chain;

  chain.joints[0].name = "panda_joint1";
  chain.joints[0].type = fpbm::JointType::kRevolute;
  chain.joints[0].placement.p = {0.0F, 0.0F, 0.333F};
  chain.joints[0].axis = {0.0F, 0.0F, 1.0F};
  chain.joints[0].bounds = {-2.8973F, 2.8973F, 2.175F, 15.0F, 7500.0F};

  chain.joints[1].name = "panda_joint2";
  chain.joints[1].type = fpbm::JointType::kRevolute;
  chain.joints[1].placement.R = fpbm::Matrix<3, 3, float>{
      {1.0F, 0.0F, 0.0F},
      {0.0F, 2.220446049250313e-16F, 1.0F},
      {0.0F, -1.0F, 2.220446049250313e-16F},
  };
  chain.joints[1].axis = {0.0F, 0.0F, 1.0F};
  chain.joints[1].bounds = {-1.7628F, 1.7628F, 2.175F, 7.5F, 3750.0F};

  chain.joints[2].name = "panda_joint3";
  chain.joints[2].type = fpbm::JointType::kRevolute;
  chain.joints[2].placement.p = {0.0F, -0.316F, 7.01660951563099e-17F};
  chain.joints[2].placement.R = fpbm::Matrix<3, 3, float>{
      {1.0F, 0.0F, 0.0F},
      {0.0F, 2.220446049250313e-16F, -1.0F},
      {0.0F, 1.0F, 2.220446049250313e-16F},
  };
  chain.joints[2].axis = {0.0F, 0.0F, 1.0F};
  chain.joints[2].bounds = {-2.8973F, 2.8973F, 2.175F, 10.0F, 5000.0F};

  chain.joints[3].name = "panda_joint4";
  chain.joints[3].type = fpbm::JointType::kRevolute;
  chain.joints[3].placement.p = {0.0825F, 0.0F, 0.0F};
  chain.joints[3].placement.R = fpbm::Matrix<3, 3, float>{
      {1.0F, 0.0F, 0.0F},
      {0.0F, 2.220446049250313e-16F, -1.0F},
      {0.0F, 1.0F, 2.220446049250313e-16F},
  };
  chain.joints[3].axis = {0.0F, 0.0F, 1.0F};
  chain.joints[3].bounds = {-3.0718F, -0.0698F, 2.175F, 12.5F, 6250.0F};

  chain.joints[4].name = "panda_joint5";
  chain.joints[4].type = fpbm::JointType::kRevolute;
  chain.joints[4].placement.p = {-0.0825F, 0.384F, 8.526512829121202e-17F};
  chain.joints[4].placement.R = fpbm::Matrix<3, 3, float>{
      {1.0F, 0.0F, 0.0F},
      {0.0F, 2.220446049250313e-16F, 1.0F},
      {0.0F, -1.0F, 2.220446049250313e-16F},
  };
  chain.joints[4].axis = {0.0F, 0.0F, 1.0F};
  chain.joints[4].bounds = {-2.8973F, 2.8973F, 2.61F, 15.0F, 7500.0F};

  chain.joints[5].name = "panda_joint6";
  chain.joints[5].type = fpbm::JointType::kRevolute;
  chain.joints[5].placement.R = fpbm::Matrix<3, 3, float>{
      {1.0F, 0.0F, 0.0F},
      {0.0F, 2.220446049250313e-16F, -1.0F},
      {0.0F, 1.0F, 2.220446049250313e-16F},
  };
  chain.joints[5].axis = {0.0F, 0.0F, 1.0F};
  chain.joints[5].bounds = {-0.0175F, 3.7525F, 2.61F, 20.0F, 10000.0F};

  chain.joints[6].name = "panda_joint7";
  chain.joints[6].type = fpbm::JointType::kRevolute;
  chain.joints[6].placement.p = {0.088F, 0.0F, 0.0F};
  chain.joints[6].placement.R = fpbm::Matrix<3, 3, float>{
      {1.0F, 0.0F, 0.0F},
      {0.0F, 2.220446049250313e-16F, -1.0F},
      {0.0F, 1.0F, 2.220446049250313e-16F},
  };
  chain.joints[6].axis = {0.0F, 0.0F, 1.0F};
  chain.joints[6].bounds = {-2.8973F, 2.8973F, 2.61F, 20.0F, 10000.0F};

  chain.tip.p = {0.0F, 0.0F, 0.107F};

  return chain;
}

inline fpbm::SerialArm<kDof, float> arm() {
  return fpbm::SerialArm<kDof, float>(chain());
}

}  // namespace panda
