#pragma once

#include <string>

#include "fpbm/clearance/shape.hpp"
#include "fpbm/core/validation.hpp"

namespace fpbm {

/// A capsule on a link of a robot: link 0 is the base, link i what joint i moves. The capsule is given in
/// the frame of that joint after its motion, or in the base frame.
template <typename Scalar = double>
struct LinkCapsule {
  int link;
  Capsule<Scalar> capsule;
  std::string name = {};

  /// Throws std::invalid_argument where a number is out of range, or the robot has no such link.
  void require_sound(const validation::Argument& argument, Eigen::Index links) const {
    if (link < 0 || link > links) validation::fail(argument + ".link", link, "a link of the arm");
    validation::require_finite(argument + ".a", capsule.a);
    validation::require_finite(argument + ".b", capsule.b);
    validation::require_non_negative(argument + ".radius", capsule.radius);
  }
};

/// Two shapes that must not come near one another: a capsule of the robot, and another one or a shape of the world.
struct ShapePair {
  std::size_t first;
  std::size_t second;
  bool world;
  JointBits by_first;   ///< Joints that move the first one alone.
  JointBits by_second;  ///< Joints that move the second one alone: none of a chain, whose second is on a link before.
};

/// Calls f(k) for each joint whose bit is set, from the base on.
template <typename F>
[[gnu::always_inline]] inline void each_joint(JointBits bits, const F& f) noexcept {
  for (Eigen::Index k = 0; bits != 0; ++k, bits >>= 1U) {
    if ((bits & 1U) != 0) f(k);
  }
}

}  // namespace fpbm
