#pragma once

#include "fpbm/geometry/rotation.hpp"
#include "fpbm/model/tree.hpp"

namespace bench {

/// Waist and arms of the Unitree G1, 17 joints, with the frames left_hand and right_hand. The numbers are from
/// example-robot-data's g1_29dof_rev_1_0.urdf, which bounds positions and velocities only.
[[nodiscard]] inline fpbm::Tree<> g1_upper_body() {
  struct Row {
    const char* name;
    int parent;
    fpbm::Vector<3> xyz;
    fpbm::Vector<3> rpy;
    char axis;
    double lower, upper, velocity;
  };
  const auto placed = [](const fpbm::Vector<3>& xyz, const fpbm::Vector<3>& rpy) -> fpbm::Transform<> {
    const auto about = [](int axis, double angle) {
      return fpbm::rotation<double>(fpbm::Vector<3>(angle * fpbm::Vector<3>::Unit(axis)));
    };
    return {xyz, about(2, rpy(2)) * about(1, rpy(1)) * about(0, rpy(0))};
  };
  const Row rows[] = {
      // clang-format off
      {"waist_yaw", 0, {0, 0, 0}, {0, 0, 0}, 'z', -2.618, 2.618, 32},
      {"waist_roll", 1, {-0.0039635, 0, 0.044}, {0, 0, 0}, 'x', -0.52, 0.52, 30},
      {"waist_pitch", 2, {0, 0, 0}, {0, 0, 0}, 'y', -0.52, 0.52, 30},
      {"left_shoulder_pitch", 3, {0.0039563, 0.10022, 0.24778}, {0.27931, 5.4949e-5, -0.00019159}, 'y', -3.0892, 2.6704, 37},
      {"left_shoulder_roll", 4, {0, 0.038, -0.013831}, {-0.27925, 0, 0}, 'x', -1.5882, 2.2515, 37},
      {"left_shoulder_yaw", 5, {0, 0.00624, -0.1032}, {0, 0, 0}, 'z', -2.618, 2.618, 37},
      {"left_elbow", 6, {0.015783, 0, -0.080518}, {0, 0, 0}, 'y', -1.0472, 2.0944, 37},
      {"left_wrist_roll", 7, {0.100, 0.00188791, -0.010}, {0, 0, 0}, 'x', -1.972222054, 1.972222054, 37},
      {"left_wrist_pitch", 8, {0.038, 0, 0}, {0, 0, 0}, 'y', -1.614429558, 1.614429558, 22},
      {"left_wrist_yaw", 9, {0.046, 0, 0}, {0, 0, 0}, 'z', -1.614429558, 1.614429558, 22},
      {"right_shoulder_pitch", 3, {0.0039563, -0.10021, 0.24778}, {-0.27931, 5.4949e-5, 0.00019159}, 'y', -3.0892, 2.6704, 37},
      {"right_shoulder_roll", 11, {0, -0.038, -0.013831}, {0.27925, 0, 0}, 'x', -2.2515, 1.5882, 37},
      {"right_shoulder_yaw", 12, {0, -0.00624, -0.1032}, {0, 0, 0}, 'z', -2.618, 2.618, 37},
      {"right_elbow", 13, {0.015783, 0, -0.080518}, {0, 0, 0}, 'y', -1.0472, 2.0944, 37},
      {"right_wrist_roll", 14, {0.100, -0.00188791, -0.010}, {0, 0, 0}, 'x', -1.972222054, 1.972222054, 37},
      {"right_wrist_pitch", 15, {0.038, 0, 0}, {0, 0, 0}, 'y', -1.614429558, 1.614429558, 22},
      {"right_wrist_yaw", 16, {0.046, 0, 0}, {0, 0, 0}, 'z', -1.614429558, 1.614429558, 22},
      // clang-format on
  };
  fpbm::Tree<> tree;
  for (const auto& [name, parent, xyz, rpy, axis, lower, upper, velocity] : rows) {
    const fpbm::JointBounds<> bounds{lower, upper, velocity};
    tree.joints.push_back(
        {{fpbm::JointType::kRevolute, placed(xyz, rpy), fpbm::Vector<3>::Unit(axis - 'x'), bounds, name}, parent});
  }
  tree.frames.push_back({"left_hand", 10, placed({0.0415, 0.003, 0.0}, {0, 0, 0})});
  tree.frames.push_back({"right_hand", 17, placed({0.0415, -0.003, 0.0}, {0, 0, 0})});
  return tree;
}

}  // namespace bench
