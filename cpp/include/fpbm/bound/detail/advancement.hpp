#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "fpbm/bound/detail/displacement_bound.hpp"
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
template <typename Clearance>
class Advancement {
 public:
  using Scalar = typename Clearance::Scalar;
  using JointVector = typename Clearance::JointVector;
  using AllJoints = typename Clearance::AllJoints;
  using Placement = typename Clearance::Placement;

  explicit Advancement(const Clearance& clearance)
      : bounds_(clearance), ahead_(clearance.placement()), unproved_(clearance.pairs().size()) {}

  /// Whether all pairs are proved to keep their margin along the trajectory `stop` from the posture of the near pairs.
  /// A pair that is closer than its margin at the start, because an obstacle has moved, must not come closer.
  /// time: duration of the trajectory, during which moving obstacles continue to move [s].
  template <int N>
  [[nodiscard]] bool keeps_margins(const Clearance& clearance, NearPairs<Clearance>& near,
                                   const StopDisplacement<N, Scalar>& stop, Scalar time,
                                   Pairs pairs = Pairs::kAll) noexcept {
    const auto sum = [&](Eigen::Index i) {
      return stop.line.coeff(i) + stop.ramp_correction.coeff(i) + stop.low.coeff(i) + stop.high.coeff(i);
    };
    if (!is_finite(entrywise(stop.line, sum))) return false;
    const Motion motion{JointDisplacement<Clearance>(clearance, stop),
                        clearance.robot().drives().rates(stop.start_velocity), time};
    near.set_displacements(clearance, motion.displacement.line.cwiseAbs() + motion.displacement.deviation, time);
    const auto needs = [&](const ShapePair& pair) noexcept {
      const bool skipped = pairs == Pairs::kStatic && near.obstacle_displacement(pair) > Scalar(0);
      return skipped ? -std::numeric_limits<Scalar>::infinity() : clearance.margin() + near.displacement_of(pair);
    };
    bounds_.begin();
    Scalar remaining(1);
    Scalar step = remaining;
    std::size_t count = 0;
    near.each(clearance, needs, [&](std::size_t i, const Nearest<Scalar>& found) noexcept {
      const ShapePair& pair = clearance.pairs()[i];
      Unproved& open = unproved_[count];
      open = {i, remaining, bounds_.of(clearance, pair, motion.displacement)};
      open.until = proved_fraction(clearance, near.here(), pair, found, motion, open.bound,
                                   near.obstacle_displacement(pair), remaining);
      step = std::min(open.until, step);
      if (!(open.until == remaining)) ++count;
    });
    for (int advance = 1; advance < kAdvances; ++advance) {
      if (!(step > Scalar(0))) return false;
      if (step == remaining) return true;
      remaining -= step;
      const Scalar done = Scalar(1) - remaining;
      clearance.place(JointVector(near.here().state.q + done * stop.line), ahead_);
      step = remaining;
      std::size_t kept = 0;
      for (std::size_t k = 0; k < count; ++k) {
        Unproved open = unproved_[k];
        if (!(open.until - done > kProven * remaining)) {
          const ShapePair& pair = clearance.pairs()[open.pair];
          if (clearance.distance_lower_bound(ahead_, pair) >= needs(pair)) continue;
          const Nearest<Scalar> found = clearance.nearest_of(ahead_, pair);
          const Scalar proved = proved_fraction(clearance, ahead_, pair, found, motion, open.bound,
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
  // Largest number of steps. In random motions among 26 near pairs, 16 steps accept 48,019 stopping trajectories, and
  // 8 steps accept 48,002 of these trajectories. With 8 steps, the longest tick of a clearance executes 25 % fewer
  // instructions (bench/README.md, "The longest ticks"). With 2 steps, rejected ticks increase the jerk in
  // Guard.slides_along_a_wall by a factor of 960.
  static constexpr int kAdvances = 8;
  /// A pair that is proved for this fraction of the remaining trajectory is not checked in the next step
  /// (bench/README.md, "The longest ticks").
  static constexpr Scalar kProven = Scalar(0.75);
  /// A distance that is smaller than the margin by at most this value [m] is treated as round-off error: in double
  /// 4.5e6 ε, and in float 84 ε, for distances of 1 m. In double, Guard.moves_away_from_a_shape_that_jumped passes with
  /// 0 to 1e-6, and fails with 1e-3.
  static constexpr Scalar kIntrusion = std::numeric_limits<Scalar>::digits > 24 ? Scalar(1e-9) : Scalar(1e-5);

  struct Motion {
    JointDisplacement<Clearance> displacement;
    AllJoints start_velocity;  ///< Velocities of all joints at the start of the trajectory.
    Scalar time;               ///< Duration of the trajectory [s].
  };

  /// A pair that is not proved to keep its margin to the end of the trajectory.
  struct Unproved {
    std::size_t pair;
    Scalar until;  ///< Fraction of the trajectory in which the pair is proved to keep its margin.
    DisplacementBound<Scalar> bound;
  };

  /// Fraction of the trajectory, at most the fraction `remaining`, in which the pair is proved to keep its margin: the
  /// smallest root of the lower bounds on its gaps (docs/clearance_proof.md, "Proof"). If no fraction is proved, the
  /// result is not positive. obstacle: displacement bound of the second shape if it is a moving obstacle [m].
  [[nodiscard]] static Scalar proved_fraction(const Clearance& clearance, const Placement& placed,
                                              const ShapePair& pair, const Nearest<Scalar>& nearest,
                                              const Motion& motion, const DisplacementBound<Scalar>& bound,
                                              Scalar obstacle, Scalar remaining) noexcept {
    const JointDisplacement<Clearance>& p = motion.displacement;
    const bool at_start = remaining == Scalar(1);
    if (nearest.distance >= clearance.margin() + obstacle + bound.displacement(remaining)) return remaining;
    const Separation<Clearance> plane(clearance, placed, pair, nearest);
    if (nearest.distance < clearance.margin() - kIntrusion && at_start) {
      const auto gradient = plane.of_distance();
      return gradient.dot(p.line) + p.least(gradient) >= Scalar(0) ? remaining : Scalar(0);
    }
    Scalar proved = remaining;
    for (int k = 0; k < 2 * plane.seconds; ++k) {
      const auto g = plane.gradient_of(k % 2, k / 2);
      const Scalar gap =
          plane.gap(k % 2, k / 2) - clearance.margin() - bound.c0 - motion.time * std::max(plane.closing, Scalar(0));
      const Scalar slope = bound.c1 - std::min(g.dot(p.line), Scalar(0));
      Scalar fraction = largest_fraction(gap + p.least(g), slope, bound.c2, remaining);
      if (fraction < remaining && at_start && p.opens(g, motion.start_velocity)) {
        fraction =
            std::max(largest_fraction(gap + p.least_of_single_stops(g), bound.c1, bound.c2, remaining), fraction);
      }
      proved = std::min(fraction, proved);
    }
    return proved;
  }

  /// Largest t ≤ remaining with gap − slope t − curvature t² ≥ 0; −1 if the gap is negative, or a number is NaN. The
  /// form of the root avoids cancellation.
  [[nodiscard]] static Scalar largest_fraction(Scalar gap, Scalar slope, Scalar curvature, Scalar remaining) noexcept {
    using std::sqrt;
    if (!(gap >= Scalar(0))) return Scalar(-1);
    if (gap >= remaining * (slope + remaining * curvature)) return remaining;
    const Scalar t = Scalar(2) * gap / (slope + sqrt(slope * slope + Scalar(4) * curvature * gap));
    return t >= Scalar(0) ? t : Scalar(-1);
  }

  DisplacementBounds<Clearance> bounds_;
  Placement ahead_;
  std::vector<Unproved> unproved_;
};

}  // namespace fpbm
