#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "fpbm/bound/detail/gap_motion.hpp"
#include "fpbm/limits/detail/rows.hpp"

namespace fpbm {

/// A gap between two shapes, or between a coordinate and its bound, for a row.
template <typename Scalar>
struct Gap {
  Scalar gap;           ///< Gap minus the margin [m].
  Scalar gap_slack;     ///< s − c without the second-order change of the gap [m].
  Scalar end;           ///< Gap at the end of the stop, to first order [m].
  Scalar closing;       ///< n·v [m/s]
  Scalar deceleration;  ///< Largest deceleration toward the bound, or infinity [m/s²].
};

/// Rows on the next motion for gaps (docs/clearance_proof.md, "Rows").
///
/// Let s be a gap, g its gradient with respect to the drives, n the normal from the second shape to the first, and v
/// the velocity of an obstacle. After the tick, the gap must satisfy
///
///   −ṡ T ≤ κ (s − c),        ṡ = gᵀq̇ − nᵀv.
///
/// T is the stopping distance of the planned stop divided by the velocity, plus kSoft. c is the margin plus the part
/// of the gap that the stop needs beyond the first-order term gᵀp, where p is the displacement of the stop. The arm
/// therefore stops smoothly at the margin, and slides along a surface. κ < 1 leaves slack for the certificate. If
/// s < c, the gap must open: ṡ ≥ (c − s)/(κ (T − kSoft)).
///
/// add() stores a gap with its gradient. The kMost gaps with the smallest slack are kept. finish() subtracts the
/// second-order change of each gap at the end of the stop, and writes the rows gᵀu ≤ b. Tag: data of the caller, for
/// the gap at the end of the stop.
template <int kMost, int N, int Joints, typename Scalar, typename Tag>
class GapRows {
 public:
  using JointVector = Vector<N, Scalar>;
  using AllJoints = Vector<Joints, Scalar>;
  using Motion = GapMotion<N, Joints, Scalar>;

  /// Bound on the joint displacements in the time T/κ, at the largest speeds after the next tick.
  template <Level kLevel>
  [[nodiscard]] static JointVector fastest(const NextMotion<kLevel, N, Scalar>& next, const Motion& motion) noexcept {
    const auto& bounds = next.limits.bounds();
    const JointVector speed = next.state.qd.cwiseAbs() + next.acting_ticks * next.limits.tick() * bounds.acceleration;
    return motion.time() / kClosing * speed.cwiseMin(bounds.velocity);
  }

  /// Call before the first add(). first: number of rows that exist.
  void begin(Eigen::Index first) noexcept { first_ = first; }

  /// s − c of a gap with the given gradient with respect to all joints. bound: on the displacement of the points of the
  /// gap in the stop.
  template <typename DisplacementBound>
  [[nodiscard]] static Scalar slack_of(const Scalar& gap, const AllJoints& gradient, const DisplacementBound& bound,
                                       const Motion& motion) noexcept {
    const Scalar part = std::max(Scalar(1) / kSteps, motion.tick / motion.coasting_time);
    const Scalar deviation = bound.c0 + part * (bound.c1 + part * bound.c2);
    return gap - kReserve - deviation - decrease_by_single_stops(motion, gradient);
  }

  /// g: gradient of the gap with respect to the drives.
  template <int P>
  void add(const Gap<Scalar>& gap, const JointVector& g, const Tag& tag, const Motion& motion,
           Rows<N, P, Scalar>& rows) noexcept {
    const Scalar slack = closing_speed(gap, gap.gap_slack, motion) - gap.closing + g.dot(motion.qd);
    const Eigen::Index k = index_for(slack, rows.count);
    if (k == kMost) return;
    candidates_[k] = {gap, slack, tag};
    rows.g.col(first_ + k) = g;
  }

  /// Writes the bounds of the rows. end(tag): gap at the end of the stop [m].
  template <Level kLevel, int P, typename End>
  void finish(const NextMotion<kLevel, N, Scalar>& next, const Motion& motion, Rows<N, P, Scalar>& rows,
              const End& end) const noexcept {
    for (Eigen::Index row = first_; row < rows.count; ++row) {
      const auto& [gap, slack, tag] = candidates_[row - first_];
      const Scalar gap_slack = gap.gap_slack - std::max(gap.end - end(tag), Scalar(0));
      const Scalar now = rows.g.col(row).dot(motion.qd);
      // Bound on −gᵀq̇ after the acceleration u of this tick is reduced to zero, where q̇ has changed by
      // acting_ticks h u.
      rows.b(row) = closing_speed(gap, gap_slack, motion) - gap.closing;
      rows.b(row) += kLevel == Level::kAcceleration ? now : (Scalar(1) - next.acting_ticks) * now;
      rows.g.col(row) *= kLevel == Level::kAcceleration ? -next.acting_ticks * motion.tick : -next.acting_ticks;
    }
  }

 private:
  // `fpbm_tests --gtest_filter='Bounds.slides*:Bounds.returns*:Bounds.moves*'` passes with the ranges below, and prints
  // the error along a wall and the jerk.

  /// Distance that the rows keep beyond the margin [m], so that an arm at rest can move along a surface. The
  /// second-order displacement of a tick from rest is smaller: at most 49 (A h²)² = 1.1e-8 m for seven joints with
  /// levers of 1 m, A = 15 rad/s² and h = 1 ms. Range: 0 to 1e-4.
  static constexpr Scalar kReserve = Scalar(1e-6);
  /// τ [s] of closing_speed(), larger than the usual T/κ. TaskBounds.stop_gently_before_a_wall prints the deceleration
  /// before a wall. The test passes with 0.2 and 0.4. With 0.1, the deceleration is twice its bound; with 1, the arm is
  /// too slow.
  static constexpr Scalar kTail = Scalar(0.2);
  /// κ. Range: 0.4 to 1. With 0.2, the error along a wall is 2.2 mm, not 0.2 mm. With 0.4, T/κ exceeds τ, as with
  /// GapMotion::kSoft = 0.2.
  static constexpr Scalar kClosing = Scalar(0.8);
  /// The rows use the deviation bound after the fraction t = 1/kSteps of the stop, as for one of kSteps equal steps of
  /// the certificate, but at least after the tick. Range: 2 to 16. With 1, the jerk is 1.7 times larger.
  static constexpr Scalar kSteps = Scalar(4);

  /// A row before finish().
  struct Candidate {
    Gap<Scalar> gap;
    Scalar slack;  ///< Permitted minus current closing speed [m/s].
    Tag tag;
  };

  /// Largest permitted closing speed −ṡ of a gap [m/s].
  ///
  /// A body with the deceleration a brakes along v²/(2a) + v h = s − s₀/2, where s is the gap beyond the margin, and
  /// s₀ = a τ². For s ≤ s₀, the speed is v = s/τ, and the deceleration is less than a.
  [[nodiscard]] static Scalar closing_speed(const Gap<Scalar>& gap, Scalar gap_slack, const Motion& motion) noexcept {
    const Scalar shortest_stop =
        gap_slack > Scalar(0) ? kClosing * gap_slack / motion.time() : gap_slack / (kClosing * motion.coasting_time);
    const Scalar a = gap.deceleration;
    if (!std::isfinite(a)) return shortest_stop;
    const Scalar h = motion.tick;
    const Scalar last = a * kTail * kTail;
    if (!(gap.gap > last)) return std::min(shortest_stop, std::max(gap.gap, Scalar(0)) / kTail);
    return std::min(shortest_stop, std::sqrt(a * (a * h * h + Scalar(2) * gap.gap - last)) - a * h);
  }

  /// Decrease of a gap by joints that follow their own shortest stop, beyond the decrease at constant velocity for the
  /// coasting time t: Σ_k max(min(g_k q̇_k t, 0) − min(g_k low_k, g_k high_k), 0) [m]. gradient: g.
  [[nodiscard]] static Scalar decrease_by_single_stops(const Motion& motion, const AllJoints& gradient) noexcept {
    Scalar decrease(0);
    for (Eigen::Index k = 0; k < gradient.size(); ++k) {
      const Scalar least = std::min(gradient(k) * motion.stop.low(k), gradient(k) * motion.stop.high(k));
      const Scalar coasting = std::min(gradient(k) * motion.speed(k) * motion.coasting_time, Scalar(0));
      decrease += std::max(coasting - least, Scalar(0));
    }
    return decrease;
  }

  /// Index for a gap with the given slack. If fewer than kMost gaps are stored, the next index. Otherwise, the index of
  /// the gap with the largest slack, or kMost if no gap has more slack.
  [[nodiscard]] Eigen::Index index_for(Scalar slack, Eigen::Index& count) const noexcept {
    if (count - first_ < kMost) return count++ - first_;
    const Candidate* most = std::max_element(candidates_, candidates_ + kMost,
                                             [](const auto& a, const auto& b) { return a.slack < b.slack; });
    return slack < most->slack ? most - candidates_ : kMost;
  }

  Eigen::Index first_ = 0;
  Candidate candidates_[kMost];
};

}  // namespace fpbm
