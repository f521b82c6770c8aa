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
/// bound near an end of the range; effort [Nm] or [N]. A value that is left out means no bound. moved: mass [kg],
/// centre [m] and inertia [kg m²] of the link. drive: inertia of the rotor, viscous and dry friction.
inline fpbm::Chain<float, 7> chain() {
  fpbm::Chain<float, 7> chain;

  chain.joints[0].name = "panda_joint1";
  chain.joints[0].type = fpbm::JointType::kRevolute;
  chain.joints[0].placement.p = {0.0F, 0.0F, 0.333F};
  chain.joints[0].axis = {0.0F, 0.0F, 1.0F};
  chain.joints[0].bounds = {-2.8973F, 2.8973F, 2.175F, 15.0F, 7500.0F};
  chain.joints[0].bounds.effort = 87.0F;
  chain.joints[0].moved = {4.970684F, {0.003875F, 0.002081F, -0.04762F}};
  chain.joints[0].moved.inertia = fpbm::Matrix<3, 3, float>{
      {0.70337F, -0.000139F, 0.006772F},
      {-0.000139F, 0.70661F, 0.019169F},
      {0.006772F, 0.019169F, 0.009117F},
  };

  chain.joints[1].name = "panda_joint2";
  chain.joints[1].type = fpbm::JointType::kRevolute;
  chain.joints[1].placement.R = fpbm::Matrix<3, 3, float>{
      {1.0F, 0.0F, 0.0F},
      {0.0F, 2.220446049250313e-16F, 1.0F},
      {0.0F, -1.0F, 2.220446049250313e-16F},
  };
  chain.joints[1].axis = {0.0F, 0.0F, 1.0F};
  chain.joints[1].bounds = {-1.7628F, 1.7628F, 2.175F, 7.5F, 3750.0F};
  chain.joints[1].bounds.effort = 87.0F;
  chain.joints[1].moved = {0.646926F, {-0.003141F, -0.02872F, 0.003495F}};
  chain.joints[1].moved.inertia = fpbm::Matrix<3, 3, float>{
      {0.007962F, -0.003925F, 0.010254F},
      {-0.003925F, 0.02811F, 0.000704F},
      {0.010254F, 0.000704F, 0.025995F},
  };

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
  chain.joints[2].bounds.effort = 87.0F;
  chain.joints[2].moved = {3.228604F, {0.027518F, 0.039252F, -0.066502F}};
  chain.joints[2].moved.inertia = fpbm::Matrix<3, 3, float>{
      {0.037242F, -0.004761F, -0.011396F},
      {-0.004761F, 0.036155F, -0.012805F},
      {-0.011396F, -0.012805F, 0.01083F},
  };

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
  chain.joints[3].bounds.effort = 87.0F;
  chain.joints[3].moved = {3.587895F, {-0.05317F, 0.104419F, 0.027454F}};
  chain.joints[3].moved.inertia = fpbm::Matrix<3, 3, float>{
      {0.025853F, 0.007796F, -0.001332F},
      {0.007796F, 0.019552F, 0.008641F},
      {-0.001332F, 0.008641F, 0.028323F},
  };

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
  chain.joints[4].bounds.effort = 12.0F;
  chain.joints[4].moved = {1.225946F, {-0.011953F, 0.041065F, -0.038437F}};
  chain.joints[4].moved.inertia = fpbm::Matrix<3, 3, float>{
      {0.035549F, -0.002117F, -0.004037F},
      {-0.002117F, 0.029474F, 0.000229F},
      {-0.004037F, 0.000229F, 0.008627F},
  };

  chain.joints[5].name = "panda_joint6";
  chain.joints[5].type = fpbm::JointType::kRevolute;
  chain.joints[5].placement.R = fpbm::Matrix<3, 3, float>{
      {1.0F, 0.0F, 0.0F},
      {0.0F, 2.220446049250313e-16F, -1.0F},
      {0.0F, 1.0F, 2.220446049250313e-16F},
  };
  chain.joints[5].axis = {0.0F, 0.0F, 1.0F};
  chain.joints[5].bounds = {-0.0175F, 3.7525F, 2.61F, 20.0F, 10000.0F};
  chain.joints[5].bounds.effort = 12.0F;
  chain.joints[5].moved = {1.666555F, {0.060149F, -0.014117F, -0.010517F}};
  chain.joints[5].moved.inertia = fpbm::Matrix<3, 3, float>{
      {0.001964F, 0.000109F, -0.001158F},
      {0.000109F, 0.004354F, 0.000341F},
      {-0.001158F, 0.000341F, 0.005433F},
  };

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
  chain.joints[6].bounds.effort = 12.0F;
  chain.joints[6].moved = {0.735522F, {0.010517F, -0.004252F, 0.061597F}};
  chain.joints[6].moved.inertia = fpbm::Matrix<3, 3, float>{
      {0.012516F, -0.000428F, -0.001196F},
      {-0.000428F, 0.010027F, -0.000741F},
      {-0.001196F, -0.000741F, 0.004815F},
  };

  chain.tip.p = {0.0F, 0.0F, 0.107F};

  return chain;
}

inline fpbm::SerialArm<kDof, float> arm() {
  return fpbm::SerialArm<kDof, float>(chain());
}

}  // namespace panda
