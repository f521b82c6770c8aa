#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "fpbm/bound/detail/shapes.hpp"

namespace fpbm {

/// Near pairs of a clearance: the pairs that a motion can bring closer than the margin (docs/clearance_proof.md, "Near
/// pairs").
///
/// A lower bound on the distance of each pair is kept from tick to tick. From one posture to the next, this bound
/// decreases by the displacement bounds of two bodies, each at most Σ_k r_k |Δq_k| with the largest levers r_k of any
/// body. A distance is computed again only if its lower bound is too small.
template <typename Shapes>
class NearPairs {
 public:
  using Scalar = typename Shapes::Scalar;
  using JointVector = typename Shapes::JointVector;
  using AllJoints = typename Shapes::AllJoints;
  using Placement = typename Shapes::Placement;

  explicit NearPairs(const Shapes& shapes)
      : here_(shapes.placement()),
        lower_bound_(shapes.pairs().size(), -kUnbounded),
        nearest_(shapes.pairs().size()),
        is_known_(shapes.pairs().size(), 0),
        levers_(filled<AllJoints>(shapes.robot().joints())),
        most_(levers_),
        obstacle_displacement_(shapes.obstacles().size(), Scalar(0)),
        obstacle_moves_(shapes.obstacles().size(), 0) {
    here_.state.q = filled<JointVector>(shapes.robot().dof());
    for (const auto& body : shapes.bodies()) levers_ = levers_.cwiseMax(body.levers);
  }

  /// The bodies in the posture of set_posture().
  [[nodiscard]] const Placement& here() const noexcept { return here_; }

  /// Computes the bodies in a posture, which need not be near the previous posture.
  void set_posture(const Shapes& shapes, const JointVector& q) noexcept {
    const AllJoints moved = shapes.robot().drives().rates(JointVector(q - here_.state.q)).cwiseAbs();
    const Scalar change = Scalar(2) * levers_.dot(moved);
    // The sum over n joints has a relative error of at most (n/2) ε, and each addition a relative error of ε/2: 4 ε for
    // 7 joints. NearPairs.are_those_of_the_distances_in_float compares the near pairs with the pairs found by distances
    // alone.
    constexpr Scalar kRoundOff = Scalar(4) * std::numeric_limits<Scalar>::epsilon();
    const Scalar most = change + kRoundOff * change;
    for (Scalar& bound : lower_bound_) bound -= most + kRoundOff * std::abs(bound);
    std::fill(is_known_.begin(), is_known_.end(), 0);
    for (std::size_t k = 0; k < obstacle_moves_.size(); ++k) {
      if (shapes.obstacles()[k].moves == obstacle_moves_[k]) continue;
      obstacle_moves_[k] = shapes.obstacles()[k].moves;
      for (std::size_t i = 0; i < lower_bound_.size(); ++i) {
        const ShapePair& pair = shapes.pairs()[i];
        if (pair.world && pair.second == k) lower_bound_[i] = -kUnbounded;
      }
    }
    shapes.place(q, here_);
  }

  /// Sets the displacements of joints and obstacles. Joint k moves by at most most(k) [rad or m]. Obstacles move
  /// with their velocities for `time` [s].
  void set_displacements(const Shapes& shapes, const AllJoints& most, Scalar time = Scalar(0)) noexcept {
    most_ = most;
    const Scalar by_joints = levers_.dot(most);
    largest_ = Scalar(2) * by_joints;
    for (std::size_t i = 0; i < obstacle_displacement_.size(); ++i) {
      const auto& velocity = shapes.obstacles()[i].velocity;
      obstacle_displacement_[i] = velocity.isZero(Scalar(0)) ? Scalar(0) : time * velocity.norm();
      largest_ = std::max(largest_, by_joints + obstacle_displacement_[i]);
    }
  }
  /// Sum of the displacement bounds of both shapes of a pair [m].
  [[nodiscard]] Scalar displacement_of(const Shapes& shapes, const ShapePair& pair) const noexcept {
    const Scalar second = pair.world            ? obstacle_displacement_[pair.second]
                          : pair.by_second != 0 ? shapes.bodies()[pair.second].levers.dot(most_)
                                                : 0;
    return shapes.bodies()[pair.first].levers.dot(most_) + second;
  }
  /// Displacement of the second shape of a pair if it is a moving obstacle, otherwise 0 [m].
  [[nodiscard]] Scalar obstacle_displacement(const ShapePair& pair) const noexcept {
    return pair.world ? obstacle_displacement_[pair.second] : Scalar(0);
  }

  /// Calls f(i, nearest) for each pair i that is closer than needs(pair) in the posture of set_posture(). needs() must
  /// be at most the margin plus displacement_of().
  template <typename Needs, typename F>
  [[gnu::always_inline]] void each(const Shapes& shapes, const Needs& needs, const F& f) noexcept {
    const Scalar most = shapes.margin() + largest_;
    const Scalar* const bounds = lower_bound_.data();
    const std::size_t count = lower_bound_.size();
    for (std::size_t i = 0; i < count; ++i) {
      if (bounds[i] >= most) continue;
      const ShapePair& pair = shapes.pairs()[i];
      const Scalar needed = needs(pair);
      if (bounds[i] >= needed) continue;
      if (is_known_[i] == 0) {
        const Scalar rough = shapes.distance_lower_bound(here_, pair);
        if (rough >= needed) {
          lower_bound_[i] = rough;
          continue;
        }
        nearest_[i] = shapes.nearest_of(here_, pair);
        lower_bound_[i] = nearest_[i].distance;
        is_known_[i] = 1;
      }
      if (!(nearest_[i].distance >= needed)) f(i, nearest_[i]);
    }
  }

 private:
  static constexpr Scalar kUnbounded = std::numeric_limits<Scalar>::infinity();

  Placement here_;
  std::vector<Scalar> lower_bound_;            ///< Lower bound on the distance of each pair [m].
  std::vector<Nearest<Scalar>> nearest_;       ///< Nearest points of each pair with is_known_.
  std::vector<unsigned char> is_known_;        ///< Whether nearest_ is computed for the present posture.
  AllJoints levers_;                           ///< Largest lever of any body, for each joint [m/rad or 1].
  AllJoints most_;                             ///< Largest displacement of each joint [rad or m].
  std::vector<Scalar> obstacle_displacement_;  ///< Displacement of each obstacle [m].
  std::vector<std::size_t> obstacle_moves_;    ///< Obstacle::moves at the last set_posture().
  Scalar largest_ = Scalar(0);                 ///< Upper bound on displacement_of() of all pairs [m].
};

}  // namespace fpbm
