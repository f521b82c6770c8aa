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
  kAtRest,  ///< All but those with a shape that moves by itself.
};

/// Checks by conservative advancement whether all pairs keep their margin along a sweep.
///
/// A step along the sweep is as large as the gap of the nearest pair, its slope and a bound on its bend surely allow. A
/// pair that surely keeps its margin to the sweep's end is not checked again.
template <typename Clearance>
class Advancement {
 public:
  using Scalar = typename Clearance::Scalar;
  using JointVector = typename Clearance::JointVector;
  using AllJoints = typename Clearance::AllJoints;
  using Placement = typename Clearance::Placement;

  explicit Advancement(const Clearance& clearance)
      : bounds_(clearance), ahead_(clearance.placement()), open_(clearance.pairs().size()) {}

  /// Whether all pairs surely keep their margin along a sweep from the posture of the near pairs. If a pair is closer
  /// than its margin at the start, because a shape has moved, it must not come closer. time: that of the sweep, in
  /// which moving shapes continue [s].
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
      step = std::min(sure, step);  // In this order NaN stays.
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
  // Of 48,019 stops of random motions among 26 near pairs that 16 advances accept, 8 accept 48,002. The worst tick of a
  // clearance takes 25 % fewer instructions with 8 (bench/README.md, "The longest ticks").
  static constexpr int kAdvances = 8;
  /// A pair that is proved for this part of the remaining sweep is not checked in the next advance (bench/README.md,
  /// "The longest ticks").
  static constexpr Scalar kProven = Scalar(0.75);
  static constexpr Scalar kIntrusion = std::numeric_limits<Scalar>::digits > 24 ? Scalar(1e-9) : Scalar(1e-5);  // [m]

  struct Motion {
    JointSweep<Clearance> sweep;
    AllJoints begun;  ///< Velocities at the sweep's start.
    Scalar time;      ///< [s]
  };

  /// A pair that is not sure to keep its margin to the sweep's end.
  struct Open {
    std::size_t pair;
    Scalar until;  ///< Part of the sweep in which the pair surely keeps its margin.
    DisplacementBound<Scalar> bound;
  };

  /// The part of the sweep, up to `whole`, the rest of it, in which a pair surely keeps its margin; not positive if
  /// there is none. moves: how far the second shape may move by itself [m].
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
      sure = std::min(far, sure);  // In this order NaN stays.
    }
    return sure;
  }

  DisplacementBounds<Clearance> bounds_;
  Placement ahead_;
  std::vector<Open> open_;
};

}  // namespace fpbm
