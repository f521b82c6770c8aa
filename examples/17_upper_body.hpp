// Written by fpbm-cpp export-header from g1_29dof_rev_1_0.urdf, base fixed, tips left_wrist_yaw_link,
// right_wrist_yaw_link. Do not edit.
#pragma once

#include <array>
#include <fpbm/model/robot.hpp>

namespace upper_body {

inline constexpr int kDof = 17;

inline constexpr std::array<const char*, kDof> kJointNames = {
    "waist_yaw_joint",             // q(0)
    "waist_roll_joint",            // q(1)
    "waist_pitch_joint",           // q(2)
    "left_shoulder_pitch_joint",   // q(3)
    "left_shoulder_roll_joint",    // q(4)
    "left_shoulder_yaw_joint",     // q(5)
    "left_elbow_joint",            // q(6)
    "left_wrist_roll_joint",       // q(7)
    "left_wrist_pitch_joint",      // q(8)
    "left_wrist_yaw_joint",        // q(9)
    "right_shoulder_pitch_joint",  // q(10)
    "right_shoulder_roll_joint",   // q(11)
    "right_shoulder_yaw_joint",    // q(12)
    "right_elbow_joint",           // q(13)
    "right_wrist_roll_joint",      // q(14)
    "right_wrist_pitch_joint",     // q(15)
    "right_wrist_yaw_joint",       // q(16)
};

/// The joints from the base on, each placed in the frame of its parent link [m], with their links; frames. Link 0 is
/// the base, with its mass [kg] and centre [m]; link i + 1 is the child of joint i.
/// Bounds are lower, upper [rad] or [m], velocity, acceleration, jerk, and the offset and deceleration of the velocity
/// bound near an end of the range; effort [Nm] or [N]. A value that is left out means no bound. moved: mass [kg],
/// centre [m] and inertia [kg m²] of the link. drive: inertia of the rotor, viscous and dry friction.
inline fpbm::Tree<double, 17, 2> tree() {
  fpbm::Tree<double, 17, 2> tree;

  tree.base = {18.186, {0.013668888975755453, 2.2893084473464958e-18, -0.3242131606081695}};

  tree.joints[0].joint.name = "waist_yaw_joint";
  tree.joints[0].joint.type = fpbm::JointType::kRevolute;
  tree.joints[0].joint.axis = {0.0, 0.0, 1.0};
  tree.joints[0].joint.bounds = {-2.618, 2.618, 32.0};
  tree.joints[0].joint.bounds.effort = 88.0;
  tree.joints[0].joint.moved = {0.214, {0.003494, 0.000233, 0.018034}};
  tree.joints[0].joint.moved.inertia = fpbm::Matrix<3, 3, double>{
      {0.00010673, 2.703e-06, -7.631e-06},
      {2.703e-06, 0.00010422, -2.01e-07},
      {-7.631e-06, -2.01e-07, 0.0001625},
  };
  tree.joints[0].parent = 0;

  tree.joints[1].joint.name = "waist_roll_joint";
  tree.joints[1].joint.type = fpbm::JointType::kRevolute;
  tree.joints[1].joint.placement.p = {-0.0039635, 0.0, 0.044};
  tree.joints[1].joint.axis = {1.0, 0.0, 0.0};
  tree.joints[1].joint.bounds = {-0.52, 0.52, 30.0};
  tree.joints[1].joint.bounds.effort = 35.0;
  tree.joints[1].joint.moved = {0.086, {0.0, 2.3e-05, 0.0}};
  tree.joints[1].joint.moved.inertia = fpbm::Matrix<3, 3, double>{
      {7.079e-06, 0.0, 0.0},
      {0.0, 6.339e-06, 0.0},
      {0.0, 0.0, 8.245e-06},
  };
  tree.joints[1].parent = 1;

  tree.joints[2].joint.name = "waist_pitch_joint";
  tree.joints[2].joint.type = fpbm::JointType::kRevolute;
  tree.joints[2].joint.axis = {0.0, 1.0, 0.0};
  tree.joints[2].joint.bounds = {-0.52, 0.52, 30.0};
  tree.joints[2].joint.bounds.effort = 35.0;
  tree.joints[2].joint.moved = {7.817, {0.002031334463349111, 0.00033972674939235003, 0.1845971451963669}};
  tree.joints[2].joint.moved.inertia = fpbm::Matrix<3, 3, double>{
      {0.12164651964290055, 3.111021029758628e-05, -0.0037428195854218842},
      {3.111021029758628e-05, 0.10977258485702901, -1.5429925458139438e-05},
      {-0.0037428195854218842, -1.5429925458139438e-05, 0.02752191941535313},
  };
  tree.joints[2].parent = 2;

  tree.joints[3].joint.name = "left_shoulder_pitch_joint";
  tree.joints[3].joint.type = fpbm::JointType::kRevolute;
  tree.joints[3].joint.placement.p = {0.0039563, 0.10022, 0.24778};
  tree.joints[3].joint.placement.R = fpbm::Matrix<3, 3, double>{
      {0.9999999801369395, 0.0001993141242808118, -4.173657985855098e-10},
      {-0.00019158999853865024, 0.9612458743694136, -0.27569245963764305},
      {-5.494899997234789e-05, 0.275692454161627, 0.9612458934627217},
  };
  tree.joints[3].joint.axis = {0.0, 1.0, 0.0};
  tree.joints[3].joint.bounds = {-3.0892, 2.6704, 37.0};
  tree.joints[3].joint.bounds.effort = 25.0;
  tree.joints[3].joint.moved = {0.718, {0.0, 0.035892, -0.011628}};
  tree.joints[3].joint.moved.inertia = fpbm::Matrix<3, 3, double>{
      {0.0004291, -9.2e-06, 6.4e-06},
      {-9.2e-06, 0.000453, 2.26e-05},
      {6.4e-06, 2.26e-05, 0.000423},
  };
  tree.joints[3].parent = 3;

  tree.joints[4].joint.name = "left_shoulder_roll_joint";
  tree.joints[4].joint.type = fpbm::JointType::kRevolute;
  tree.joints[4].joint.placement.p = {0.0, 0.038, -0.013831};
  tree.joints[4].joint.placement.R = fpbm::Matrix<3, 3, double>{
      {0.9999999999999999, 0.0, 0.0},
      {0.0, 0.9612624347309333, 0.27563477932793234},
      {0.0, -0.27563477932793234, 0.9612624347309333},
  };
  tree.joints[4].joint.axis = {1.0, 0.0, 0.0};
  tree.joints[4].joint.bounds = {-1.5882, 2.2515, 37.0};
  tree.joints[4].joint.bounds.effort = 25.0;
  tree.joints[4].joint.moved = {0.643, {-0.000227, 0.00727, -0.063243}};
  tree.joints[4].joint.moved.inertia = fpbm::Matrix<3, 3, double>{
      {0.0006177, -1e-06, 8.7e-06},
      {-1e-06, 0.0006912, -5.3e-06},
      {8.7e-06, -5.3e-06, 0.0003894},
  };
  tree.joints[4].parent = 4;

  tree.joints[5].joint.name = "left_shoulder_yaw_joint";
  tree.joints[5].joint.type = fpbm::JointType::kRevolute;
  tree.joints[5].joint.placement.p = {0.0, 0.00624, -0.1032};
  tree.joints[5].joint.axis = {0.0, 0.0, 1.0};
  tree.joints[5].joint.bounds = {-2.618, 2.618, 37.0};
  tree.joints[5].joint.bounds.effort = 25.0;
  tree.joints[5].joint.moved = {0.734, {0.010773, -0.002949, -0.072009}};
  tree.joints[5].joint.moved.inertia = fpbm::Matrix<3, 3, double>{
      {0.0009988, 7.9e-06, 0.0001412},
      {7.9e-06, 0.0010605, -2.86e-05},
      {0.0001412, -2.86e-05, 0.0004354},
  };
  tree.joints[5].parent = 5;

  tree.joints[6].joint.name = "left_elbow_joint";
  tree.joints[6].joint.type = fpbm::JointType::kRevolute;
  tree.joints[6].joint.placement.p = {0.015783, 0.0, -0.080518};
  tree.joints[6].joint.axis = {0.0, 1.0, 0.0};
  tree.joints[6].joint.bounds = {-1.0472, 2.0944, 37.0};
  tree.joints[6].joint.bounds.effort = 25.0;
  tree.joints[6].joint.moved = {0.6, {0.064956, 0.004454, -0.010062}};
  tree.joints[6].joint.moved.inertia = fpbm::Matrix<3, 3, double>{
      {0.0002891, 6.53e-05, 1.72e-05},
      {6.53e-05, 0.0004152, -5.6e-06},
      {1.72e-05, -5.6e-06, 0.0004197},
  };
  tree.joints[6].parent = 6;

  tree.joints[7].joint.name = "left_wrist_roll_joint";
  tree.joints[7].joint.type = fpbm::JointType::kRevolute;
  tree.joints[7].joint.placement.p = {0.1, 0.00188791, -0.01};
  tree.joints[7].joint.axis = {1.0, 0.0, 0.0};
  tree.joints[7].joint.bounds = {-1.972222054, 1.972222054, 37.0};
  tree.joints[7].joint.bounds.effort = 25.0;
  tree.joints[7].joint.moved = {0.08544498, {0.01713944778, 0.00053759094, 4.8864e-07}};
  tree.joints[7].joint.moved.inertia = fpbm::Matrix<3, 3, double>{
      {4.821544023e-05, -4.24511021e-06, 5.10599e-09},
      {-4.24511021e-06, 3.722899093e-05, -1.23525e-09},
      {5.10599e-09, -1.23525e-09, 5.482106541e-05},
  };
  tree.joints[7].parent = 7;

  tree.joints[8].joint.name = "left_wrist_pitch_joint";
  tree.joints[8].joint.type = fpbm::JointType::kRevolute;
  tree.joints[8].joint.placement.p = {0.038, 0.0, 0.0};
  tree.joints[8].joint.axis = {0.0, 1.0, 0.0};
  tree.joints[8].joint.bounds = {-1.614429558, 1.614429558, 22.0};
  tree.joints[8].joint.bounds.effort = 5.0;
  tree.joints[8].joint.moved = {0.48404956, {0.02299989837, -0.00111685314, -0.00111658096}};
  tree.joints[8].joint.moved.inertia = fpbm::Matrix<3, 3, double>{
      {0.00016579646273, -1.231206746e-05, 1.231699194e-05},
      {-1.231206746e-05, 0.0004295405741, 8.1417712e-07},
      {1.231699194e-05, 8.1417712e-07, 0.00042953697654},
  };
  tree.joints[8].parent = 8;

  tree.joints[9].joint.name = "left_wrist_yaw_joint";
  tree.joints[9].joint.type = fpbm::JointType::kRevolute;
  tree.joints[9].joint.placement.p = {0.046, 0.0, 0.0};
  tree.joints[9].joint.axis = {0.0, 0.0, 1.0};
  tree.joints[9].joint.bounds = {-1.614429558, 1.614429558, 22.0};
  tree.joints[9].joint.bounds.effort = 5.0;
  tree.joints[9].joint.moved = {0.25457647, {0.07082443020105138, 0.00019174529120036596, 0.0016174161391889757}};
  tree.joints[9].joint.moved.inertia = fpbm::Matrix<3, 3, double>{
      {0.00015044517917257633, 3.760275409002612e-05, -2.9549415859057686e-06},
      {3.760275409002612e-05, 0.000643113268533374, 3.7754842412915682e-06},
      {-2.9549415859057686e-06, 3.7754842412915682e-06, 0.0005601139475039712},
  };
  tree.joints[9].parent = 9;

  tree.joints[10].joint.name = "right_shoulder_pitch_joint";
  tree.joints[10].joint.type = fpbm::JointType::kRevolute;
  tree.joints[10].joint.placement.p = {0.0039563, -0.10021, 0.24778};
  tree.joints[10].joint.placement.R = fpbm::Matrix<3, 3, double>{
      {0.9999999801369395, -0.0001993141242808118, -4.173657985855098e-10},
      {0.00019158999853865024, 0.9612458743694136, 0.27569245963764305},
      {-5.494899997234789e-05, -0.275692454161627, 0.9612458934627217},
  };
  tree.joints[10].joint.axis = {0.0, 1.0, 0.0};
  tree.joints[10].joint.bounds = {-3.0892, 2.6704, 37.0};
  tree.joints[10].joint.bounds.effort = 25.0;
  tree.joints[10].joint.moved = {0.718, {0.0, -0.035892, -0.011628}};
  tree.joints[10].joint.moved.inertia = fpbm::Matrix<3, 3, double>{
      {0.0004291, 9.2e-06, 6.4e-06},
      {9.2e-06, 0.000453, -2.26e-05},
      {6.4e-06, -2.26e-05, 0.000423},
  };
  tree.joints[10].parent = 3;

  tree.joints[11].joint.name = "right_shoulder_roll_joint";
  tree.joints[11].joint.type = fpbm::JointType::kRevolute;
  tree.joints[11].joint.placement.p = {0.0, -0.038, -0.013831};
  tree.joints[11].joint.placement.R = fpbm::Matrix<3, 3, double>{
      {0.9999999999999999, 0.0, 0.0},
      {0.0, 0.9612624347309333, -0.27563477932793234},
      {0.0, 0.27563477932793234, 0.9612624347309333},
  };
  tree.joints[11].joint.axis = {1.0, 0.0, 0.0};
  tree.joints[11].joint.bounds = {-2.2515, 1.5882, 37.0};
  tree.joints[11].joint.bounds.effort = 25.0;
  tree.joints[11].joint.moved = {0.643, {-0.000227, -0.00727, -0.063243}};
  tree.joints[11].joint.moved.inertia = fpbm::Matrix<3, 3, double>{
      {0.0006177, 1e-06, 8.7e-06},
      {1e-06, 0.0006912, 5.3e-06},
      {8.7e-06, 5.3e-06, 0.0003894},
  };
  tree.joints[11].parent = 11;

  tree.joints[12].joint.name = "right_shoulder_yaw_joint";
  tree.joints[12].joint.type = fpbm::JointType::kRevolute;
  tree.joints[12].joint.placement.p = {0.0, -0.00624, -0.1032};
  tree.joints[12].joint.axis = {0.0, 0.0, 1.0};
  tree.joints[12].joint.bounds = {-2.618, 2.618, 37.0};
  tree.joints[12].joint.bounds.effort = 25.0;
  tree.joints[12].joint.moved = {0.734, {0.010773, 0.002949, -0.072009}};
  tree.joints[12].joint.moved.inertia = fpbm::Matrix<3, 3, double>{
      {0.0009988, -7.9e-06, 0.0001412},
      {-7.9e-06, 0.0010605, 2.86e-05},
      {0.0001412, 2.86e-05, 0.0004354},
  };
  tree.joints[12].parent = 12;

  tree.joints[13].joint.name = "right_elbow_joint";
  tree.joints[13].joint.type = fpbm::JointType::kRevolute;
  tree.joints[13].joint.placement.p = {0.015783, 0.0, -0.080518};
  tree.joints[13].joint.axis = {0.0, 1.0, 0.0};
  tree.joints[13].joint.bounds = {-1.0472, 2.0944, 37.0};
  tree.joints[13].joint.bounds.effort = 25.0;
  tree.joints[13].joint.moved = {0.6, {0.064956, -0.004454, -0.010062}};
  tree.joints[13].joint.moved.inertia = fpbm::Matrix<3, 3, double>{
      {0.0002891, -6.53e-05, 1.72e-05},
      {-6.53e-05, 0.0004152, 5.6e-06},
      {1.72e-05, 5.6e-06, 0.0004197},
  };
  tree.joints[13].parent = 13;

  tree.joints[14].joint.name = "right_wrist_roll_joint";
  tree.joints[14].joint.type = fpbm::JointType::kRevolute;
  tree.joints[14].joint.placement.p = {0.1, -0.00188791, -0.01};
  tree.joints[14].joint.axis = {1.0, 0.0, 0.0};
  tree.joints[14].joint.bounds = {-1.972222054, 1.972222054, 37.0};
  tree.joints[14].joint.bounds.effort = 25.0;
  tree.joints[14].joint.moved = {0.08544498, {0.01713944778, -0.00053759094, 4.8864e-07}};
  tree.joints[14].joint.moved.inertia = fpbm::Matrix<3, 3, double>{
      {4.821544023e-05, 4.24511021e-06, 5.10599e-09},
      {4.24511021e-06, 3.722899093e-05, 1.23525e-09},
      {5.10599e-09, 1.23525e-09, 5.482106541e-05},
  };
  tree.joints[14].parent = 14;

  tree.joints[15].joint.name = "right_wrist_pitch_joint";
  tree.joints[15].joint.type = fpbm::JointType::kRevolute;
  tree.joints[15].joint.placement.p = {0.038, 0.0, 0.0};
  tree.joints[15].joint.axis = {0.0, 1.0, 0.0};
  tree.joints[15].joint.bounds = {-1.614429558, 1.614429558, 22.0};
  tree.joints[15].joint.bounds.effort = 5.0;
  tree.joints[15].joint.moved = {0.48404956, {0.02299989837, 0.00111685314, -0.00111658096}};
  tree.joints[15].joint.moved.inertia = fpbm::Matrix<3, 3, double>{
      {0.00016579646273, 1.231206746e-05, 1.231699194e-05},
      {1.231206746e-05, 0.0004295405741, -8.1417712e-07},
      {1.231699194e-05, -8.1417712e-07, 0.00042953697654},
  };
  tree.joints[15].parent = 15;

  tree.joints[16].joint.name = "right_wrist_yaw_joint";
  tree.joints[16].joint.type = fpbm::JointType::kRevolute;
  tree.joints[16].joint.placement.p = {0.046, 0.0, 0.0};
  tree.joints[16].joint.axis = {0.0, 0.0, 1.0};
  tree.joints[16].joint.bounds = {-1.614429558, 1.614429558, 22.0};
  tree.joints[16].joint.bounds.effort = 5.0;
  tree.joints[16].joint.moved = {0.25457647, {0.07082443020105138, -0.00019174529120036596, 0.0016174161391889757}};
  tree.joints[16].joint.moved.inertia = fpbm::Matrix<3, 3, double>{
      {0.00015044517917257633, -3.760275409002612e-05, -2.9549415859057686e-06},
      {-3.760275409002612e-05, 0.000643113268533374, -3.7754842412915682e-06},
      {-2.9549415859057686e-06, -3.7754842412915682e-06, 0.0005601139475039712},
  };
  tree.joints[16].parent = 16;

  tree.frames[0].name = "left_wrist_yaw_link";
  tree.frames[0].link = 10;

  tree.frames[1].name = "right_wrist_yaw_link";
  tree.frames[1].link = 17;

  return tree;
}

inline fpbm::Robot<kDof, double> robot() {
  return fpbm::Robot<kDof, double>(tree());
}

}  // namespace upper_body
