#pragma once

#include <algorithm>

#include "fpbm/bound/detail/displacement_bounds.hpp"
#include "fpbm/bound/detail/gap_rows.hpp"
#include "fpbm/bound/detail/near_pairs.hpp"
#include "fpbm/bound/detail/separation.hpp"

namespace fpbm {

/// Rows on the next motion, for the pairs of shapes that are near enough to need rows (GapRows).
template <typename Shapes, int N>
class PairRows {
 public:
  /// Largest number of rows. Bounds.avoids_posts_from_all_sides, in which more rows apply, passes.
  static constexpr int kPairs = 16;
  using Scalar = typename Shapes::Scalar;
  using JointVector = Vector<N, Scalar>;

  explicit PairRows(const Shapes& shapes) : bounds_(shapes), middle_(shapes.placement()), end_(shapes.placement()) {}

  /// Adds the rows for the next motion. near: the near pairs in the posture of next.state.
  template <Level kLevel, int P>
  void add(const Shapes& shapes, NearPairs<Shapes>& near, const NextMotion<kLevel, N, Scalar>& next,
           Rows<N, P, Scalar>& rows) noexcept {
    const auto& drives = shapes.robot().drives();
    const Motion motion(drives, next);
    // A pair that is farther apart than the displacements in the time T needs no row. The deviation bound c₀ + c₁ + c₂
    // is at most Σ_k r_k x_k Σ_j x_j, with the largest displacements x of the stop and the levers r_k.
    const AllJoints fastest = drives.rates(GapsOf::fastest(next, motion)).cwiseAbs() + motion.stop.deviation;
    const AllJoints x = motion.stop.line.cwiseAbs() + motion.stop.deviation;
    near.set_displacements(shapes, fastest + x.sum() * x + motion.tick / Scalar(2) * motion.speed.cwiseAbs(),
                           motion.time());
    const JointVector middle = motion.middle(next.state);
    bool is_placed = false;
    bounds_.begin();
    gaps_.begin(rows.count);
    distance_sum_ = Scalar(0);
    const Eigen::Index before = rows.count;
    const auto needs = [&](const ShapePair& pair) noexcept {
      return shapes.margin() + near.displacement_of(shapes, pair);
    };
    near.each(shapes, needs, [&](std::size_t number, const Nearest<Scalar>&) noexcept {
      const ShapePair& pair = shapes.pairs()[number];
      if (!is_placed) shapes.place(middle, middle_);
      is_placed = true;
      const Nearest<Scalar> found = shapes.nearest_of(middle_, pair);
      const DisplacementBound<Scalar> bound = bounds_.of(shapes, pair, motion.stop);
      const Scalar deviation = bound.c0 + bound.c1 + bound.c2;
      const Scalar range = deviation + near.obstacle_displacement(pair) + displacement_of(shapes, pair, fastest);
      if (found.distance >= shapes.margin() + range) return;
      distance_sum_ += found.distance;
      add(shapes, pair, found, bound, motion, rows);
    });
    if (rows.count == before) return;
    shapes.place(JointVector(middle + motion.line), end_);
    gaps_.finish(next, motion, rows,
                 [&](const ShapePair* pair) noexcept { return distance_at_end(shapes, *pair, motion); });
  }

  /// Sum of the distances of the pairs that add() found near [m].
  [[nodiscard]] Scalar distance_sum() const noexcept { return distance_sum_; }

 private:
  static constexpr int kJoints = Shapes::kJoints;
  using AllJoints = typename Shapes::AllJoints;
  using GapsOf = GapRows<kPairs, N, kJoints, Scalar, const ShapePair*>;
  using Motion = GapMotion<N, kJoints, Scalar>;

  /// Part of the displacement of a moving obstacle, in the time by which bounds on jerk delay the arm, that the rows
  /// keep beyond the margin. In Bounds.keeps_the_margin_of_a_moving_obstacle with bounds on jerk J = 20 A, the arm
  /// comes closer by at most 0.005 of this displacement without this reserve.
  static constexpr Scalar kLagging = Scalar(0.01);

  /// Adds the row of a pair, or the rows of both ends of its first capsule. bound: displacement bounds of the stop.
  template <int P>
  void add(const Shapes& shapes, const ShapePair& pair, const Nearest<Scalar>& found,
           const DisplacementBound<Scalar>& bound, const Motion& motion, Rows<N, P, Scalar>& rows) noexcept {
    const Separation<Shapes> plane(shapes, middle_, pair, found);
    const Scalar at = plane.at();
    const bool between = Scalar(0) < at && at < Scalar(1);
    const AllJoints nearest = plane.of_distance();
    const Scalar reserve = kLagging * motion.lag * obstacle_velocity(shapes, pair).norm();
    for (int e = 0; e < (between ? 1 : 2); ++e) {
      const AllJoints gradient = between ? nearest : plane.gradient_of(e);
      const Scalar moved = motion.tick / Scalar(2) * plane.closing;  // Of the obstacle, until the middle of the tick.
      const Scalar gap = (between ? plane.distance : plane.gap(e)) - moved - shapes.margin();
      const Scalar end = plane.distance + nearest.dot(motion.stop.line) - plane.closing * motion.coasting_time;
      gaps_.add({gap, GapsOf::slack_of(gap, gradient, bound, motion) - reserve, end, plane.closing, kUnbounded},
                shapes.robot().drives().by_drive(gradient), &pair, motion, rows);
    }
  }

  /// Velocity of the second shape of a pair, 0 for a body [m/s].
  [[nodiscard]] static Vector<3, Scalar> obstacle_velocity(const Shapes& shapes, const ShapePair& pair) noexcept {
    return pair.world ? shapes.obstacles()[pair.second].velocity : Vector<3, Scalar>(Vector<3, Scalar>::Zero());
  }

  /// Distance of a pair at the end of the stop [m]. A moving obstacle moves for the coasting time.
  [[nodiscard]] Scalar distance_at_end(const Shapes& shapes, const ShapePair& pair,
                                       const Motion& motion) const noexcept {
    const Vector<3, Scalar> moved = motion.coasting_time * obstacle_velocity(shapes, pair);
    if (moved.isZero(Scalar(0))) return shapes.nearest_of(end_, pair).distance;
    Capsule<Scalar> relative = end_.bodies[pair.first];
    relative.a -= moved;
    relative.b -= moved;
    return shapes.obstacles()[pair.second].nearest_to(relative).distance;
  }

  /// Bound on the change of the distance of a pair if joint k moves by at most most(k): Σ_k r_k most(k), over the
  /// joints that move one shape only [m].
  [[nodiscard]] static Scalar displacement_of(const Shapes& shapes, const ShapePair& pair,
                                              const AllJoints& most) noexcept {
    Scalar sum(0);
    const auto add = [&](std::size_t body, JointBits joints) noexcept {
      each_joint(joints, [&](Eigen::Index k) noexcept { sum += shapes.bodies()[body].levers(k) * most(k); });
    };
    add(pair.first, pair.by_first);
    if (pair.by_second != 0) add(pair.second, pair.by_second);
    return sum;
  }

  static constexpr Scalar kUnbounded = std::numeric_limits<Scalar>::infinity();

  DisplacementBounds<Shapes> bounds_;
  typename Shapes::Placement middle_;  ///< In the middle of the tick.
  typename Shapes::Placement end_;     ///< At the end of the stop.
  GapsOf gaps_;
  Scalar distance_sum_ = Scalar(0);
};

}  // namespace fpbm
