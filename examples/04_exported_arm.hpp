// Written by fpbm-cpp export-header from 04_exported_arm.urdf, tip tool. Do not edit.
#pragma once

#include <array>
#include <fpbm/model/serial_arm.hpp>

namespace exported_arm {

inline constexpr int kDof = 7;

inline constexpr std::array<const char*, kDof> kJointNames = {
    "base_yaw",        // q(0)
    "shoulder_pitch",  // q(1)
    "shoulder_roll",   // q(2)
    "elbow_pitch",     // q(3)
    "forearm_roll",    // q(4)
    "wrist_pitch",     // q(5)
    "wrist_roll",      // q(6)
};

/// The joints from base to tip, each placed in the frame of the previous joint [m].
/// Bounds are lower, upper [rad] or [m], velocity, acceleration, jerk, and the offset and deceleration of the velocity
/// bound near an end of the range; effort [Nm] or [N]. A value that is left out means no bound. moved: mass [kg],
/// centre [m] and inertia [kg m²] of the link. drive: inertia of the rotor, viscous and dry friction.
inline fpbm::Chain<double, 7> chain() {
  constexpr double kNone = fpbm::JointBounds<double>::kNone;
  fpbm::Chain<double, 7> chain;

  chain.joints[0].name = "base_yaw";
  chain.joints[0].type = fpbm::JointType::kRevolute;
  chain.joints[0].placement.p = {0.0, 0.0, 0.12};
  chain.joints[0].axis = {0.0, 0.0, 1.0};
  chain.joints[0].bounds = {-2.9, 2.9, 1.8};
  chain.joints[0].bounds.effort = 120.0;

  chain.joints[1].name = "shoulder_pitch";
  chain.joints[1].type = fpbm::JointType::kRevolute;
  chain.joints[1].placement.p = {0.0, 0.0, 0.23};
  chain.joints[1].axis = {0.0, 1.0, 0.0};
  chain.joints[1].bounds = {-1.9, 1.9, 1.8};
  chain.joints[1].bounds.effort = 120.0;

  chain.joints[2].name = "shoulder_roll";
  chain.joints[2].type = fpbm::JointType::kRevolute;
  chain.joints[2].placement.p = {0.0, 0.0, 0.21};
  chain.joints[2].axis = {0.0, 0.0, 1.0};
  chain.joints[2].bounds = {-2.9, 2.9, 2.1};
  chain.joints[2].bounds.effort = 80.0;

  chain.joints[3].name = "elbow_pitch";
  chain.joints[3].type = fpbm::JointType::kRevolute;
  chain.joints[3].placement.p = {0.06, 0.0, 0.22};
  chain.joints[3].axis = {0.0, 1.0, 0.0};
  chain.joints[3].bounds = {-0.2, 2.6, 2.1};
  chain.joints[3].bounds.effort = 80.0;

  chain.joints[4].name = "forearm_roll";
  chain.joints[4].type = fpbm::JointType::kRevolute;
  chain.joints[4].placement.p = {-0.06, 0.0, 0.19};
  chain.joints[4].axis = {0.0, 0.0, 1.0};
  chain.joints[4].bounds = {-2.9, 2.9, 2.6};
  chain.joints[4].bounds.effort = 30.0;

  chain.joints[5].name = "wrist_pitch";
  chain.joints[5].type = fpbm::JointType::kRevolute;
  chain.joints[5].placement.p = {0.0, 0.0, 0.21};
  chain.joints[5].axis = {0.0, 1.0, 0.0};
  chain.joints[5].bounds = {-2.0, 2.0, 2.6};
  chain.joints[5].bounds.effort = 30.0;

  chain.joints[6].name = "wrist_roll";
  chain.joints[6].type = fpbm::JointType::kContinuous;
  chain.joints[6].placement.p = {0.0, 0.0, 0.09};
  chain.joints[6].axis = {0.0, 0.0, 1.0};
  chain.joints[6].bounds = {-kNone, kNone, 3.1};
  chain.joints[6].bounds.effort = 30.0;

  chain.tip.p = {0.0, 0.0, 0.14};
  chain.tip.R = fpbm::Matrix<3, 3, double>{
      {0.7071067811865475, -0.7071067811865476, 0.0},
      {0.7071067811865476, 0.7071067811865475, 0.0},
      {0.0, 0.0, 1.0},
  };

  return chain;
}

inline fpbm::SerialArm<kDof, double> arm() {
  return fpbm::SerialArm<kDof, double>(chain());
}

}  // namespace exported_arm
