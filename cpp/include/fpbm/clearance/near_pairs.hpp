#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "fpbm/clearance/clearance.hpp"

namespace fpbm {

/// The pairs of a clearance that a motion can bring closer than the margin, from tick to tick.
///
/// A lower bound on the distance of each pair is kept: from one posture to the next, a distance decreases by at most
/// the displacements of both shapes, Σ lever_k |Δq_k|. Distances are computed anew only of pairs whose bound is too
/// low.
template <typename Clearance>
class NearPairs {
 public:
  using Scalar = typename Clearance::Scalar;
  using JointVector = typename Clearance::JointVector;
  using AllJoints = typename Clearance::AllJoints;
  using Placement = typename Clearance::Placement;

  explicit NearPairs(const Clearance& clearance)
      : here_(clearance.placement()),
        least_(clearance.pairs().size(), -kUnbounded),
        nearest_(clearance.pairs().size()),
        is_known_(clearance.pairs().size(), 0),
        displacement_(clearance.bodies().size(), Scalar(0)),
        by_obstacle_(clearance.obstacles().size(), Scalar(0)) {
    here_.state.q = filled<JointVector>(clearance.robot().dof());
  }

  /// The bodies in the posture of go_to().
  [[nodiscard]] const Placement& here() const noexcept { return here_; }

  /// Places the bodies in a posture, from the one before or any other.
  void go_to(Clearance& clearance, const JointVector& q) noexcept {
    set_displacements(clearance, clearance.robot().drives().rates(JointVector(q - here_.state.q)).cwiseAbs());
    constexpr Scalar kRoundOff = Scalar(4) * std::numeric_limits<Scalar>::epsilon();
    for (std::size_t i = 0; i < least_.size(); ++i) {
      const ShapePair& pair = clearance.pairs()[i];
      const Scalar change = displacement_[pair.first] + (pair.world ? Scalar(0) : displacement_[pair.second]);
      least_[i] -= change + kRoundOff * (std::abs(least_[i]) + change);
      if (pair.world && clearance.obstacles()[pair.second].moved) least_[i] = -kUnbounded;
      is_known_[i] = 0;
    }
    clearance.read_obstacles();
    clearance.place(q, here_);
  }

  /// Sets how far shapes may be displaced: bodies by joints that move by at most `most`, obstacles by their velocities
  /// in a time.
  void set_displacements(const Clearance& clearance, const AllJoints& most, Scalar time = Scalar(0)) noexcept {
    Scalar by_joints(0);
    for (std::size_t i = 0; i < displacement_.size(); ++i) {
      displacement_[i] = clearance.bodies()[i].levers.dot(most);
      by_joints = std::max(by_joints, displacement_[i]);
    }
    largest_ = Scalar(2) * by_joints;
    for (std::size_t i = 0; i < by_obstacle_.size(); ++i) {
      const auto& velocity = clearance.obstacles()[i].velocity;
      by_obstacle_[i] = velocity.isZero(Scalar(0)) ? Scalar(0) : time * velocity.norm();
      largest_ = std::max(largest_, by_joints + by_obstacle_[i]);
    }
  }
  /// How far the shapes of a pair may be displaced toward one another.
  [[nodiscard]] Scalar displacement_of(const ShapePair& pair) const noexcept {
    const Scalar second = pair.world ? by_obstacle_[pair.second] : pair.by_second != 0 ? displacement_[pair.second] : 0;
    return displacement_[pair.first] + second;
  }
  /// How far the second shape of a pair may move by itself.
  [[nodiscard]] Scalar moves(const ShapePair& pair) const noexcept {
    return pair.world ? by_obstacle_[pair.second] : Scalar(0);
  }

  /// Calls f(i, nearest) for each pair i closer than needs(pair) in the posture of go_to(). Of a pair of shapes,
  /// needs() is at most the margin and displacement_of().
  template <typename Needs, typename F>
  [[gnu::always_inline]] void each(const Clearance& clearance, const Needs& needs, const F& f) noexcept {
    const Scalar most = clearance.margin() + largest_;
    for (std::size_t i = 0; i < least_.size(); ++i) {
      if (i < clearance.shape_pairs() && least_[i] >= most) continue;
      const ShapePair& pair = clearance.pairs()[i];
      const Scalar needed = needs(pair);
      if (least_[i] >= needed) continue;
      if (is_known_[i] == 0) {
        const Scalar rough = clearance.roughly(here_, pair);
        if (rough >= needed) {
          least_[i] = rough;
          continue;
        }
        nearest_[i] = clearance.nearest_of(here_, pair);
        least_[i] = nearest_[i].distance;
        is_known_[i] = 1;
      }
      if (!(nearest_[i].distance >= needed)) f(i, nearest_[i]);
    }
  }

 private:
  static constexpr Scalar kUnbounded = std::numeric_limits<Scalar>::infinity();

  Placement here_;
  std::vector<Scalar> least_;             ///< Lower bound on the distance of each pair [m].
  std::vector<Nearest<Scalar>> nearest_;  ///< Of pairs that are known.
  std::vector<unsigned char> is_known_;   ///< Whether nearest_ is that of the posture.
  std::vector<Scalar> displacement_;      ///< Of each body.
  std::vector<Scalar> by_obstacle_;       ///< Of each obstacle.
  Scalar largest_ = Scalar(0);            ///< Of any pair.
};

}  // namespace fpbm
