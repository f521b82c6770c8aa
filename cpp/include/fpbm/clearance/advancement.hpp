#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

#include "fpbm/clearance/displacement_bound.hpp"
#include "fpbm/clearance/near_pairs.hpp"
#include "fpbm/clearance/separation.hpp"

namespace fpbm {

/// Pairs that Advancement checks.
enum class Pairs : unsigned char {
  kAll,
  kAtRest,  ///< All pairs except pairs with a moving obstacle.
};

/// Checks by conservative advancement (Mirtich 1996) whether all pairs keep their margin along a stopping trajectory:
/// docs/clearance.md, "Proof".
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
      : bounds_(clearance), ahead_(clearance.placement()), open_(clearance.pairs().size()) {}

  /// Whether all pairs are proved to keep their margin along the trajectory `drives` from the posture of the near
  /// pairs. A pair that is closer than its margin at the start, because an obstacle has moved, must not come closer.
  /// time: duration of the trajectory, during which moving obstacles continue [s].
  template <int N>
  [[nodiscard]] bool keeps_apart(const Clearance& clearance, NearPairs<Clearance>& near, const Sweep<N, Scalar>& drives,
                                 Scalar time, Pairs pairs = Pairs::kAll) noexcept {
    const auto all = [&](Eigen::Index i) {
      return drives.way.coeff(i) + drives.tick.coeff(i) + drives.low.coeff(i) + drives.high.coeff(i);
    };
    if (!is_finite(entrywise(drives.way, all))) return false;
    const Motion motion{JointSweep<Clearance>(clearance, drives), clearance.robot().drives().rates(drives.begun), time};
    near.set_displacements(clearance, motion.sweep.way.cwiseAbs() + motion.sweep.rest, time);
    const auto needs = [&](const ShapePair& pair) noexcept {
      if (pairs == Pairs::kAtRest && near.moves(pair) > Scalar(0)) return -std::numeric_limits<Scalar>::infinity();
      return clearance.margin() + near.displacement_of(pair);
    };
    bounds_.begin();
    Scalar whole(1);
    Scalar step = whole;
    std::size_t count = 0;
    near.each(clearance, needs, [&](std::size_t i, const Nearest<Scalar>& found) noexcept {
      const ShapePair& pair = clearance.pairs()[i];
      Open& open = open_[count];
      open = {i, whole, bounds_.of(clearance, pair, motion.sweep)};
      const Scalar sure = sure_step(clearance, near.here(), pair, found, motion, open.bound, near.moves(pair), whole);
      open.until = sure;
      if (!(sure == whole)) ++count;
      step = std::min(sure, step);
    });
    for (int advance = 1; advance < kAdvances; ++advance) {
      if (!(step > Scalar(0))) return false;
      if (step == whole) return true;
      whole -= step;
      const Scalar done = Scalar(1) - whole;
      clearance.place(JointVector(near.here().state.q + done * drives.way), ahead_);
      step = whole;
      std::size_t left = 0;
      for (std::size_t k = 0; k < count; ++k) {
        Open open = open_[k];
        if (!(open.until - done > kProven * whole)) {
          const ShapePair& pair = clearance.pairs()[open.pair];
          if (clearance.roughly(ahead_, pair) >= needs(pair)) continue;
          const Nearest<Scalar> found = clearance.nearest_of(ahead_, pair);
          const Scalar sure = sure_step(clearance, ahead_, pair, found, motion, open.bound, near.moves(pair), whole);
          if (sure == whole) continue;
          open.until = done + sure;
        }
        step = std::min(open.until - done, step);
        open_[left++] = open;
      }
      count = left;
    }
    return step == whole;
  }

 private:
  // Of 48,019 stopping trajectories of random motions among 26 near pairs that 16 steps accept, 8 steps accept 48,002.
  // With 8 steps, the longest tick of a clearance executes 25 % fewer instructions (bench/README.md, "The longest
  // ticks").
  static constexpr int kAdvances = 8;
  /// A pair that is proved for this fraction of the remaining trajectory is not checked in the next step
  /// (bench/README.md, "The longest ticks").
  static constexpr Scalar kProven = Scalar(0.75);
  static constexpr Scalar kIntrusion = std::numeric_limits<Scalar>::digits > 24 ? Scalar(1e-9) : Scalar(1e-5);  // [m]

  struct Motion {
    JointSweep<Clearance> sweep;
    AllJoints begun;  ///< Joint velocities at the start of the trajectory.
    Scalar time;      ///< Duration of the trajectory [s].
  };

  /// A pair that is not proved to keep its margin to the end of the trajectory.
  struct Open {
    std::size_t pair;
    Scalar until;  ///< Fraction of the trajectory in which the pair is proved to keep its margin.
    DisplacementBound<Scalar> bound;
  };

  /// Fraction of the trajectory, at most the remaining fraction `whole`, in which the pair is proved to keep its
  /// margin: the smallest root of the lower bounds on its gaps (docs/clearance.md, "Proof"). Not positive if there is
  /// none. moves: displacement bound of the second shape if it is a moving obstacle [m].
  [[nodiscard]] static Scalar sure_step(const Clearance& clearance, const Placement& placed, const ShapePair& pair,
                                        const Nearest<Scalar>& nearest, const Motion& motion,
                                        const DisplacementBound<Scalar>& bound, Scalar moves, Scalar whole) noexcept {
    const JointSweep<Clearance>& sweep = motion.sweep;
    const bool at_start = whole == Scalar(1);
    if (nearest.distance >= clearance.margin() + moves + bound.displacement(whole)) return whole;
    const Separation<Clearance> plane(clearance, placed, pair, nearest);
    if (nearest.distance < clearance.margin() - kIntrusion && at_start) {
      const auto gradient = plane.of_distance();
      return gradient.dot(sweep.way) + sweep.least(gradient) >= Scalar(0) ? whole : Scalar(0);
    }
    Scalar sure = whole;
    for (int k = 0; k < 2 * plane.seconds; ++k) {
      const auto g = plane.gradient_of(k % 2, k / 2);
      const Scalar gap =
          plane.gap(k % 2, k / 2) - clearance.margin() - bound.c0 - motion.time * std::max(plane.closing, Scalar(0));
      const Scalar slope = bound.c1 - std::min(g.dot(sweep.way), Scalar(0));
      Scalar far = furthest(gap + sweep.least(g), slope, bound.c2, whole);
      if (far < whole && at_start && sweep.opens(g, motion.begun)) {
        far = std::max(furthest(gap + sweep.least_of_own(g), bound.c1, bound.c2, whole), far);
      }
      sure = std::min(far, sure);
    }
    return sure;
  }

  DisplacementBounds<Clearance> bounds_;
  Placement ahead_;
  std::vector<Open> open_;
};

}  // namespace fpbm
