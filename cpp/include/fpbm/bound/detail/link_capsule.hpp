#pragma once

#include <string>

#include "fpbm/bound/detail/shape.hpp"
#include "fpbm/core/detail/validation.hpp"

namespace fpbm {

/// A capsule on a link of a robot. Link 0 is the base, and joint i moves link i. The capsule is given in the frame of
/// joint i after the motion of the joint, or in the base frame for link 0.
template <typename Scalar = double>
struct LinkCapsule {
  int link;
  Capsule<Scalar> capsule;
  std::string name = {};

  /// Throws std::invalid_argument if a number is out of range, or the link does not exist.
  void require_sound(const validation::Argument& argument, Eigen::Index links) const {
    if (link < 0 || link > links) validation::fail(argument + ".link", link, "a link of the arm, from 0 to ", links);
    validation::require_finite(argument + ".a", capsule.a);
    validation::require_finite(argument + ".b", capsule.b);
    validation::require_non_negative(argument + ".radius", capsule.radius);
  }
};

/// Two shapes that must keep the margin: a capsule of the robot, and another capsule of the robot or an obstacle.
struct ShapePair {
  std::size_t first;
  std::size_t second;
  bool world;
  JointBits by_first;   ///< Joints that move the first shape only.
  JointBits by_second;  ///< Joints that move the second shape only. Empty for a chain, in which
                        ///< the second link is nearer to the base.
};

}  // namespace fpbm
