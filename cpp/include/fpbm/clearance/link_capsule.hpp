#pragma once

#include <string>

#include "fpbm/clearance/shape.hpp"
#include "fpbm/core/validation.hpp"

namespace fpbm {

/// A capsule on a link of an arm: link 0 is the base, link i what joint i of the chain moves. The capsule is given in
/// the frame of that joint after its motion, or in the base frame.
template <typename Scalar = double>
struct LinkCapsule {
  int link;
  Capsule<Scalar> capsule;
  std::string name = {};

  /// Throws std::invalid_argument where a number is out of range, or the arm has no such link.
  void require_sound(const validation::Argument& argument, Eigen::Index links) const {
    if (link < 0 || link > links) validation::fail(argument + ".link", link, "a link of the arm");
    validation::require_finite(argument + ".a", capsule.a);
    validation::require_finite(argument + ".b", capsule.b);
    validation::require_non_negative(argument + ".radius", capsule.radius);
  }
};

/// Two shapes that must not come near one another: a capsule of the arm, and another of a link before it or a shape of
/// the world.
struct ShapePair {
  std::size_t first;
  std::size_t second;
  bool world;
};

}  // namespace fpbm
