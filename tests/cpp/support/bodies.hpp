#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "fpbm/fpbm.hpp"
#include "support/random.hpp"

/// Arms with shapes, and surroundings for them.
namespace fpbm::test {

/// A capsule along each link, from its joint to the next.
[[nodiscard]] inline std::vector<LinkCapsule<>> sticks(const Chain<>& chain, double radius) {
  std::vector<LinkCapsule<>> capsules;
  for (std::size_t i = 0; i < chain.joints.size(); ++i) {
    const Vector<3> end = i + 1 < chain.joints.size() ? chain.joints[i + 1].placement.p : chain.tip.p;
    if (i + 1 < chain.joints.size() && !(end.norm() > 0.01)) continue;
    capsules.push_back({static_cast<int>(i) + 1, {Vector<3>::Zero(), end, radius}, "link" + std::to_string(i + 1)});
  }
  return capsules;
}

[[nodiscard]] inline Vector<3> random_direction(Random& random) {
  return Vector<3>(random.uniform(3, -1.0, 1.0)).normalized();
}

/// A wall, a box or a post somewhere around an arm of some length.
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
