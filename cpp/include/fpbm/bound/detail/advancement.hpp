#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "fpbm/bound/detail/displacement_bounds.hpp"
#include "fpbm/bound/detail/kept_fraction.hpp"
#include "fpbm/bound/detail/near_pairs.hpp"
#include "fpbm/bound/detail/separation.hpp"

namespace fpbm {

/// Pairs that Advancement checks.
enum class Pairs : unsigned char {
  kAll,
  kStatic,  ///< All pairs except pairs with a moving obstacle.
};

/// Checks by conservative advancement (Mirtich 1996) whether all pairs keep their margin along a stopping trajectory:
/// docs/clearance_proof.md, "Proof".
///
/// Each step along the trajectory has the length that the lower bounds on all gaps allow. A pair whose lower bound
/// keeps the margin to the end of the trajectory is not checked again.
template <typename Shapes>
class Advancement {
 public:
  using Scalar = typename Shapes::Scalar;
  using JointVector = typename Shapes::JointVector;
  using AllJoints = typename Shapes::AllJoints;
  using Placement = typename Shapes::Placement;
  using Motion = StoppingMotion<Shapes::kJoints, Scalar>;

  explicit Advancement(const Shapes& shapes)
      : bounds_(shapes), ahead_(shapes.placement()), unproved_(shapes.pairs().size()) {}

  /// Whether all pairs are proved to keep their margin along the trajectory `stop` from the posture of the near pairs.
  /// A pair that is closer than its margin at the start, because an obstacle has moved, must not come closer.
  /// time: duration of the trajectory, during which moving obstacles continue to move [s].
  template <int N>
  [[nodiscard]] bool keeps_margins(const Shapes& shapes, NearPairs<Shapes>& near,
                                   const StopDisplacement<N, Scalar>& stop, Scalar time,
                                   Pairs pairs = Pairs::kAll) noexcept {
    const auto sum = [&](Eigen::Index i) {
      return stop.line.coeff(i) + stop.ramp_correction.coeff(i) + stop.low.coeff(i) + stop.high.coeff(i);
    };
    if (!is_finite(entrywise(stop.line, sum))) return false;
    const Motion motion(shapes.robot().drives(), stop, time);
    near.set_displacements(shapes, motion.displacement.line.cwiseAbs() + motion.displacement.deviation, time);
    const auto needs = [&](const ShapePair& pair) noexcept {
      const bool skipped = pairs == Pairs::kStatic && near.obstacle_displacement(pair) > Scalar(0);
      return skipped ? -std::numeric_limits<Scalar>::infinity() : shapes.margin() + near.displacement_of(shapes, pair);
    };
    bounds_.begin();
    Scalar remaining(1);
    Scalar step = remaining;
    std::size_t count = 0;
    near.each(shapes, needs, [&](std::size_t i, const Nearest<Scalar>& found) noexcept {
      const ShapePair& pair = shapes.pairs()[i];
      Unproved& open = unproved_[count];
      open = {i, remaining, bounds_.of(shapes, pair, motion.displacement)};
      open.until = proved_fraction(shapes, near.here(), pair, found, motion, open.bound,
                                   near.obstacle_displacement(pair), remaining);
      step = std::min(open.until, step);
      if (!(open.until == remaining)) ++count;
    });
    for (int advance = 1; advance < kAdvances; ++advance) {
      if (!(step > Scalar(0))) return false;
      if (step == remaining) return true;
      remaining -= step;
      const Scalar done = Scalar(1) - remaining;
      shapes.place(JointVector(near.here().state.q + done * stop.line), ahead_);
      step = remaining;
      std::size_t kept = 0;
      for (std::size_t k = 0; k < count; ++k) {
        Unproved open = unproved_[k];
        if (!(open.until - done > kProven * remaining)) {
          const ShapePair& pair = shapes.pairs()[open.pair];
          if (shapes.distance_lower_bound(ahead_, pair) >= needs(pair)) continue;
          const Nearest<Scalar> found = shapes.nearest_of(ahead_, pair);
          const Scalar proved = proved_fraction(shapes, ahead_, pair, found, motion, open.bound,
                                                near.obstacle_displacement(pair), remaining);
          if (proved == remaining) continue;
          open.until = done + proved;
        }
        step = std::min(open.until - done, step);
        unproved_[kept++] = open;
      }
      count = kept;
    }
    return step == remaining;
  }

 private:
  /// A pair that is proved for this fraction of the remaining trajectory is not checked in the next step
  /// (bench/README.md, "The longest ticks").
  static constexpr Scalar kProven = Scalar(0.75);
  /// A pair that is not proved to keep its margin to the end of the trajectory.
  struct Unproved {
    std::size_t pair;
    Scalar until;  ///< Fraction of the trajectory in which the pair is proved to keep its margin.
    DisplacementBound<Scalar> bound;
  };

  /// Fraction of the trajectory, at most the fraction `remaining`, in which the pair is proved to keep its margin: the
  /// smallest root of the lower bounds on its gaps (docs/clearance_proof.md, "Proof"). If no fraction is proved, the
  /// result is not positive. obstacle: displacement bound of the second shape if it is a moving obstacle [m].
  [[nodiscard]] static Scalar proved_fraction(const Shapes& shapes, const Placement& placed, const ShapePair& pair,
                                              const Nearest<Scalar>& nearest, const Motion& motion,
                                              const DisplacementBound<Scalar>& bound, Scalar obstacle,
                                              Scalar remaining) noexcept {
    const bool at_start = remaining == Scalar(1);
    if (nearest.distance >= shapes.margin() + obstacle + bound.displacement(remaining)) return remaining;
    const Separation<Shapes> plane(shapes, placed, pair, nearest);
    if (nearest.distance < shapes.margin() - kIntrusion<Scalar> && at_start) {
      const auto gradient = plane.of_distance();
      const auto& p = motion.displacement;
      return gradient.dot(p.line) + p.least(gradient) >= Scalar(0) ? remaining : Scalar(0);
    }
    Scalar proved = remaining;
    for (int k = 0; k < 2 * plane.seconds; ++k) {
      const Scalar gap = plane.gap(k % 2, k / 2) - shapes.margin() - motion.time * std::max(plane.closing, Scalar(0));
      proved = std::min(kept_fraction(gap, plane.gradient_of(k % 2, k / 2), bound, motion, remaining), proved);
    }
    return proved;
  }

  DisplacementBounds<Shapes> bounds_;
  Placement ahead_;
  std::vector<Unproved> unproved_;
};

}  // namespace fpbm
