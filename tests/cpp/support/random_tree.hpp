#pragma once

#include <string>
#include <vector>

#include "fpbm/model/dynamics.hpp"
#include "support/random.hpp"

namespace fpbm::test {

[[nodiscard]] inline Transform<> random_placement(Random& random) {
  return {random.uniform(3, -0.4, 0.4), rotation(Vector<3>(random.uniform(3, -1.5, 1.5)))};
}

/// Inertia of eight random point masses.
[[nodiscard]] inline LinkInertia<> random_inertia(Random& random) {
  LinkInertia<> link;
  for (int i = 0; i < 8; ++i) {
    const Vector<3> at = random.uniform(3, -0.3, 0.3);
    link = joined(link, {random.uniform(0.05, 0.5), at});
  }
  return link;
}

/// Probabilities of a joint of a random tree: to begin a branch, to be prismatic, and to follow another joint.
struct Kind {
  double branching = 0.0;
  double sliding = 0.0;
  double following = 0.0;
};

/// A tree with inertias, rotors and friction.
[[nodiscard]] inline Tree<> random_tree(Random& random, int joints, const Kind& kind) {
  Tree<> tree;
  const auto chance = [&](double p) { return random.uniform(0.0, 1.0) < p; };
  const auto below = [&](int end) { return static_cast<int>(random.uniform(0.0, end - 1e-3)); };
  std::vector<int> drives;
  for (int i = 0; i < joints; ++i) {
    TreeJoint<> each;
    auto& joint = each.joint;
    joint.type = chance(kind.sliding) ? JointType::kPrismatic : JointType::kRevolute;
    joint.placement = random_placement(random);
    joint.axis = random.uniform(3, -1.0, 1.0);
    joint.name = "j" + std::to_string(i);
    joint.moved = random_inertia(random);
    joint.drive = {random.uniform(0.0, 0.1), random.uniform(0.0, 0.5), random.uniform(0.0, 0.5)};
    each.parent = chance(kind.branching) ? below(i + 1) : i;
    if (!drives.empty() && chance(kind.following)) {
      const int leader = drives[static_cast<std::size_t>(below(static_cast<int>(drives.size())))];
      joint.mimic = {leader, random.uniform(-1.0, 1.0), random.uniform(-0.2, 0.2)};
    } else {
      drives.push_back(i);
    }
    tree.joints.push_back(each);
  }
  return tree;
}

}  // namespace fpbm::test
