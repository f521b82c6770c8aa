#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "fpbm/fpbm.hpp"
#include "support/random.hpp"

/// Arms with shapes, and obstacles around them.
namespace fpbm::test {

/// A capsule along each link, from its joint to the next joint or to a frame.
[[nodiscard]] inline std::vector<LinkCapsule<>> sticks(const Tree<>& tree, double radius) {
  std::vector<LinkCapsule<>> capsules;
  const auto add = [&](int link, const Vector<3>& end, bool is_last) {
    if (link == 0 || (!is_last && !(end.norm() > 0.01))) return;
    capsules.push_back({link, {Vector<3>::Zero(), end, radius}, "link" + std::to_string(link)});
  };
  for (const auto& [joint, parent] : tree.joints) add(parent, joint.placement.p, false);
  for (const auto& [name, link, offset] : tree.frames) add(link, offset.p, true);
  return capsules;
}
[[nodiscard]] inline std::vector<LinkCapsule<>> sticks(const Chain<>& chain, double radius) {
  return sticks(tree_of(chain), radius);
}

/// Two Pandas, on a torso that leans and rotates, or side by side.
[[nodiscard]] inline Tree<> two_pandas(bool with_torso) {
  if (!with_torso) return presets::two_pandas();
  Tree<> tree;
  Chain<> torso;
  torso.joints.resize(2);
  torso.joints[0].axis = {0.0, 1.0, 0.0};
  torso.joints[1].placement.p = {0.0, 0.0, 0.4};
  for (auto& joint : torso.joints) joint.bounds = {-0.7, 0.7, 1.0, 5.0};
  const int chest = add_arm(tree, torso, "torso");
  Transform<> place;
  for (const char* name : {"right", "left"}) {
    place.p(1) = tree.joints.size() == 2 ? -0.4 : 0.4;
    add_arm(tree, presets::panda(), name, chest, place);
  }
  return tree;
}

[[nodiscard]] inline Vector<3> random_direction(Random& random) {
  return Vector<3>(random.uniform(3, -1.0, 1.0)).normalized();
}

/// A wall, a box or a post near an arm of some length.
[[nodiscard]] inline Obstacle<> random_obstacle(Random& random, double length, int kind) {
  const Vector<3> place = length * random.uniform(3, -1.0, 1.0);
  const std::string name = "obstacle" + std::to_string(kind);
  if (kind % 3 == 0) return {name, HalfSpace<>{random_direction(random), -length * random.uniform(0.1, 0.8)}};
  if (kind % 3 == 1) {
    const Vector<3> turn = 3.0 * random_direction(random);
    const Vector<3> half = length * random.uniform(3, 0.02, 0.4);
    return {name, Cuboid<>{{place, rotation(turn)}, half}};
  }
  const Vector<3> along = length * random.uniform(0.0, 1.0) * random_direction(random);
  return {name, Capsule<>{place, place + along, length * random.uniform(0.02, 0.1)}};
}

}  // namespace fpbm::test
