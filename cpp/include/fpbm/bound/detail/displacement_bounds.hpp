#pragma once

#include <vector>

#include "fpbm/bound/detail/displacement_bound.hpp"
#include "fpbm/bound/detail/link_capsule.hpp"

namespace fpbm {

/// Displacement bounds of pairs of shapes along one stopping trajectory. The bound of a body and an obstacle
/// is computed once for each body.
template <typename Shapes>
class DisplacementBounds {
 public:
  using Bound = DisplacementBound<typename Shapes::Scalar>;
  using Displacement = JointDisplacement<Shapes::kJoints, typename Shapes::Scalar>;

  explicit DisplacementBounds(const Shapes& shapes)
      : by_body_(shapes.bodies().size()), is_known_(shapes.bodies().size(), 0) {}

  /// Discards the bounds of the previous trajectory.
  void begin() noexcept { is_known_.assign(is_known_.size(), 0); }

  /// Sum of the bounds of both shapes of a pair. displacement: the same trajectory in all calls after begin().
  [[nodiscard]] Bound of(const Shapes& shapes, const ShapePair& pair, const Displacement& displacement) noexcept {
    const auto& first = shapes.bodies()[pair.first];
    if (!pair.world) {
      Bound bound;
      bound.add(shapes.robot(), first.levers, pair.by_first, displacement);
      if (pair.by_second != 0) {
        bound.add(shapes.robot(), shapes.bodies()[pair.second].levers, pair.by_second, displacement);
      }
      return bound;
    }
    if (is_known_[pair.first] == 0) {
      by_body_[pair.first] = {};
      by_body_[pair.first].add(shapes.robot(), first.levers, pair.by_first, displacement);
      is_known_[pair.first] = 1;
    }
    return by_body_[pair.first];
  }

 private:
  std::vector<Bound> by_body_;
  std::vector<unsigned char> is_known_;
};

}  // namespace fpbm
