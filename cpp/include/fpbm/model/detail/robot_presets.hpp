#pragma once

#include <string>

#include "fpbm/geometry/rotation.hpp"
#include "fpbm/model/detail/preset_parts.hpp"
#include "fpbm/model/presets.hpp"
#include "fpbm/model/tree.hpp"

namespace fpbm::presets {

/// Half of the distance between the bases of the two Pandas, along y [m]. The value is a choice.
inline constexpr double kPandaOffset = 0.4;

/// Two Pandas at a table, 0.8 m apart along y: "right" and "left", with the frames right_tip and left_tip.
[[nodiscard]] inline Tree<> two_pandas() {
  Tree<> tree;
  Transform<> place;
  for (const char* name : {"right", "left"}) {
    place.p(1) = tree.joints.empty() ? -kPandaOffset : kPandaOffset;
    add_arm(tree, panda(), name, 0, place);
  }
  return tree;
}

namespace humanoids {

/// Joint in the form of a URDF file.
struct Row {
  const char* name;
  Vector<3> origin;  ///< [m]
  Vector<3> turn;    ///< Roll, pitch, yaw [rad].
  Vector<3> axis;
  double lower;     ///< [rad]
  double upper;     ///< [rad]
  double velocity;  ///< [rad/s]
  double effort;    ///< [Nm]
};

/// Adds a joint and its link to a tree. A joint of the right arm is the mirror image of the joint of the left arm.
inline void add(Tree<>& tree, const Row& row, const arms::Body& link, int parent, const std::string& side = "") {
  const bool mirrored = side == "right_";
  const double sign = mirrored ? -1.0 : 1.0;
  const auto mirror = [&](const Vector<3>& point) { return Vector<3>(point(0), sign * point(1), point(2)); };
  const bool opposite = mirrored && row.axis(1) == 0.0;  // Rotations about x and z change their sign.
  TreeJoint<> each;
  each.joint.name = side + row.name + "_joint";
  each.joint.placement = arms::placed(mirror(row.origin), {sign * row.turn(0), row.turn(1), sign * row.turn(2)});
  each.joint.axis = row.axis;
  each.joint.bounds = {opposite ? -row.upper : row.lower, opposite ? -row.lower : row.upper, row.velocity, 20.0};
  each.joint.bounds.effort = row.effort;
  each.parent = parent;
  const auto& [mass, centre, xx, xy, xz, yy, yz, zz] = link;
  each.joint.moved = arms::Body{mass, mirror(centre), xx, sign * xy, xz, yy, sign * yz, zz}.in({});
  tree.joints.push_back(each);
}

}  // namespace humanoids

/// Upper body of a Unitree G1 (29 joints): waist and arms, 17 joints, with the frames left_wrist_yaw_link and
/// right_wrist_yaw_link. The pelvis is the base. The mass of the pelvis includes the legs, which are held straight.
///
/// Source: g1_29dof_rev_1_0.urdf of Unitree's unitree_ros (BSD-3-Clause). The velocities in the URDF file are the
/// no-load velocities of the motors. Bounds on acceleration are not published: 20 rad/s² is a choice. Masses are
/// rounded to 1 mg, their centres to 1 µm, and inertias to 6 digits. Inertias are xx, xy, xz, yy, yz, zz [kg m²].
[[nodiscard]] inline Tree<> g1_upper_body() {
  using humanoids::Row;
  const Vector<3> x(1.0, 0.0, 0.0);
  const Vector<3> y(0.0, 1.0, 0.0);
  const Vector<3> z(0.0, 0.0, 1.0);
  const Vector<3> none(0.0, 0.0, 0.0);
  const Vector<3> tilt(0.27931, 5.4949e-05, -0.00019159);
  const Row waist[] = {
      // ..., [rad], [rad], [rad/s], [Nm]
      {"waist_yaw", none, none, z, -2.618, 2.618, 32, 88},
      {"waist_roll", {-0.0039635, 0, 0.044}, none, x, -0.52, 0.52, 30, 35},
      {"waist_pitch", none, none, y, -0.52, 0.52, 30, 35},
  };
  const arms::Body waist_links[] = {
      // [kg], [m], xx, xy, xz, yy, yz, zz [kg m²]
      {0.214, {0.003494, 0.000233, 0.018034}, 0.00010673, 2.703e-6, -7.631e-6, 0.00010422, -2.01e-7, 0.0001625},
      {0.086, {0, 0.000023, 0}, 7.079e-6, 0, 0, 6.339e-6, 0, 8.245e-6},
      {7.817, {0.002031, 0.00034, 0.184597}, 0.121647, 3.1e-5, -0.003743, 0.109773, -1.5e-5, 0.027522},
  };
  const Vector<3> shoulder(0.0039563, 0.10022, 0.24778);
  const Vector<3> roll(0.0, 0.038, -0.013831);
  const Vector<3> back(-0.27925, 0.0, 0.0);
  const Vector<3> wrist(0.1, 0.00188791, -0.01);
  const Row arm[] = {
      {"shoulder_pitch", shoulder, tilt, y, -3.0892, 2.6704, 37, 25},
      {"shoulder_roll", roll, back, x, -1.5882, 2.2515, 37, 25},
      {"shoulder_yaw", {0, 0.00624, -0.1032}, none, z, -2.618, 2.618, 37, 25},
      {"elbow", {0.015783, 0, -0.080518}, none, y, -1.0472, 2.0944, 37, 25},
      {"wrist_roll", wrist, none, x, -1.972222054, 1.972222054, 37, 25},
      {"wrist_pitch", {0.038, 0, 0}, none, y, -1.614429558, 1.614429558, 22, 5},
      {"wrist_yaw", {0.046, 0, 0}, none, z, -1.614429558, 1.614429558, 22, 5},
  };
  const arms::Body arm_links[] = {
      {0.718, {0, 0.035892, -0.011628}, 0.0004291, -9.2e-6, 6.4e-6, 0.000453, 2.26e-5, 0.000423},
      {0.643, {-0.000227, 0.00727, -0.063243}, 0.0006177, -1e-6, 8.7e-6, 0.0006912, -5.3e-6, 0.0003894},
      {0.734, {0.010773, -0.002949, -0.072009}, 0.0009988, 7.9e-6, 0.0001412, 0.0010605, -2.86e-5, 0.0004354},
      {0.6, {0.064956, 0.004454, -0.010062}, 0.0002891, 6.53e-5, 1.72e-5, 0.0004152, -5.6e-6, 0.0004197},
      {0.085445, {0.017139, 0.000538, 0}, 4.82154e-5, -4.2451e-6, 5.1e-9, 3.7229e-5, -1.2e-9, 5.48211e-5},
      {0.48405, {0.023, -0.001117, -0.001117}, 0.000165796, -1.2312e-5, 1.2317e-5, 0.000429541, 8.14e-7, 0.000429537},
      {0.254576, {0.070824, 0.000192, 0.001617}, 0.000150445, 3.7603e-5, -2.955e-6, 0.000643113, 3.775e-6, 0.000560114},
  };
  Tree<> tree;
  tree.base = {18.186, {0.013669, 0.0, -0.324213}};
  for (int i = 0; i < 3; ++i) humanoids::add(tree, waist[i], waist_links[i], i);
  for (const std::string side : {"left_", "right_"}) {
    int link = 3;
    for (int i = 0; i < 7; ++i) {
      humanoids::add(tree, arm[i], arm_links[i], link, side);
      link = static_cast<int>(tree.joints.size());
    }
    tree.frames.push_back({side + "wrist_yaw_link", link, {}});
  }
  tree.joints[10].joint.placement.p(1) = -0.10021;  // The URDF file is not symmetric here.
  return tree;
}

/// Preset with its name, for programs that read the name at run time.
struct RobotPreset {
  const char* name;
  Tree<> (*tree)();
};
inline constexpr RobotPreset kRobots[] = {{"two_pandas", two_pandas}, {"g1_upper_body", g1_upper_body}};

}  // namespace fpbm::presets
