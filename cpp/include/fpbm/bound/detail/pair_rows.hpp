#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "fpbm/bound/detail/displacement_bound.hpp"
#include "fpbm/bound/detail/near_pairs.hpp"
#include "fpbm/bound/detail/separation.hpp"
#include "fpbm/limits/detail/rows.hpp"
#include "fpbm/limits/detail/stop_plan.hpp"

namespace fpbm {

/// Bounds on the next motion, for the pairs that are near enough to need bounds (docs/clearance_proof.md, "Rows").
///
/// Let s be the gap of a pair, g its gradient with respect to the drives, n the normal from the second shape to the
/// first, and v the velocity of an obstacle. After the tick, the gap must satisfy
///
///   −ṡ T ≤ κ (s − c),        ṡ = gᵀq̇ − nᵀv.
///
/// T is the stopping distance of the planned stop divided by the velocity, plus kSoft. c is the margin plus the part
/// of the gap that the stop needs beyond the first-order term gᵀp, where p is the displacement of the stop. The arm
/// therefore stops smoothly at the margin, and slides along a surface. κ < 1 leaves slack for the check by
/// Advancement. If s < c, the gap must open: ṡ ≥ (c − s)/(κ (T − kSoft)).
///
/// For each near pair, add() computes s − c and g. The kPairs rows with the smallest slack are kept. finish() subtracts
/// the second-order change of the distance at the end of the stop, and writes the row gᵀu ≤ b.
template <Level kLevel, typename Clearance, int N>
class PairRows {
 public:
  /// Largest number of rows. Guard.avoids_posts_from_all_sides, in which more rows apply, passes.
  static constexpr int kPairs = 16;
  using Scalar = typename Clearance::Scalar;
  using JointVector = Vector<N, Scalar>;
  using JointState = State<N, Scalar>;
  using JointLimits = Limits<kLevel, N, Scalar>;

  explicit PairRows(const Clearance& clearance)
      : bounds_(clearance), middle_(clearance.placement()), end_(clearance.placement()) {}

  /// Writes the rows for a motion from `state` to `rows`. near: the near pairs in the posture of the state. plan, stop:
  /// the planned stop and its displacement. acting_ticks: StopPlan::acting_ticks().
  template <int P>
  void write(const Clearance& clearance, NearPairs<Clearance>& near, const JointLimits& limits, const JointState& state,
             const StopPlan<kLevel, N, Scalar>& plan, const StopDisplacement<N, Scalar>& stop, Scalar acting_ticks,
             Rows<N, P, Scalar>& rows) noexcept {
    static_assert(P >= kPairs, "rows must have a column for each pair");
    const Scalar h = limits.tick();
    const auto& drives = clearance.robot().drives();
    // Not rounded to whole ticks: the steps of a rounded number would cause jerks.
    const Scalar ticks = Scalar(1) + plan.smooth_coasting_ticks(limits);
    const JointVector line = ticks / (Scalar(1) + plan.coasting_ticks()) * stop.line;
    Motion motion{JointDisplacement<Clearance>(clearance, stop),
                  state.qd,
                  drives.rates(state.qd),
                  h * ticks,
                  h,
                  (acting_ticks - Scalar(1)) * h};
    AllJoints& p = motion.stop.line;
    p = drives.rates(line);
    const Scalar time = motion.time();
    // A pair that is farther apart than the displacements in the time T needs no row. The deviation bound c₀ + c₁ + c₂
    // is at most Σ_k r_k x_k Σ_j x_j, with the largest displacements x of the stop and the levers r_k.
    const AllJoints fastest = (time / kClosing * drives.rates(largest_speeds(limits, state, acting_ticks))).cwiseAbs() +
                              motion.stop.deviation;
    const AllJoints x = p.cwiseAbs() + motion.stop.deviation;
    near.set_displacements(clearance, fastest + x.sum() * x + h / Scalar(2) * motion.speed.cwiseAbs(), time);
    // The rows are evaluated in the middle of the tick, like J of the task. At the start of the tick, the rows would
    // differ by h/2 d(∇s)/dt.
    const JointVector middle = state.q + h / Scalar(2) * state.qd;
    bool is_placed = false;
    bounds_.begin();
    const auto needs = [&](const ShapePair& pair) noexcept {
      return has_deceleration(clearance, pair) ? std::numeric_limits<Scalar>::infinity()
                                               : clearance.margin() + near.displacement_of(pair);
    };
    near.each(clearance, needs, [&](std::size_t number, const Nearest<Scalar>&) noexcept {
      const ShapePair& pair = clearance.pairs()[number];
      if (!is_placed) clearance.place(middle, middle_);
      is_placed = true;
      const Nearest<Scalar> found = clearance.nearest_of(middle_, pair);
      const DisplacementBound<Scalar> bound = bounds_.of(clearance, pair, motion.stop);
      const Scalar deviation = bound.c0 + bound.c1 + bound.c2;
      const Scalar range = deviation + near.obstacle_displacement(pair) + displacement_of(clearance, pair, fastest);
      if (!has_deceleration(clearance, pair) && found.distance >= clearance.margin() + range) return;
      distance_sum_ += found.distance;
      add(clearance, pair, found, bound, motion, rows);
    });
    if (rows.count > 0) finish(clearance, JointVector(middle + line), motion, acting_ticks, rows);
  }

  /// Sum of the distances of the pairs that write() found near since begin() [m].
  [[nodiscard]] Scalar distance_sum() const noexcept { return distance_sum_; }
  void begin() noexcept { distance_sum_ = Scalar(0); }

 private:
  using AllJoints = typename Clearance::AllJoints;
  using Body = typename Clearance::Body;

  // `fpbm_tests --gtest_filter='Guard.slides*:Guard.returns*:Guard.moves*'` passes with the ranges below, and prints
  // the error along a wall and the jerk.

  /// Distance that the rows keep beyond the margin [m], so that an arm at rest can move along a surface. The
  /// second-order displacement of a tick from rest is smaller: at most 49 (A h²)² = 1.1e-8 m for seven joints with
  /// levers of 1 m, A = 15 rad/s² and h = 1 ms. Range: 0 to 1e-4.
  static constexpr Scalar kReserve = Scalar(1e-6);
  /// Part of the displacement of a moving obstacle, in the time by which bounds on jerk delay the arm, that the rows
  /// keep beyond the margin. In Guard.keeps_the_margin_of_a_moving_obstacle with bounds on jerk J = 20 A, the arm comes
  /// closer by at most 0.005 of this displacement without this reserve.
  static constexpr Scalar kLagging = Scalar(0.01);
  /// Part of T beyond the coasting time [s]. Range: 0.025 to 0.2. With 0.0125 and with 1,
  /// Guard.returns_when_a_shape_leaves fails. With 0.2, T/κ exceeds τ: the tests above pass, but
  /// TaskBounds.stop_gently_before_a_wall fails.
  static constexpr Scalar kSoft = Scalar(0.05);
  /// τ [s] of closing_speed(), larger than the usual T/κ. TaskBounds.stop_gently_before_a_wall prints the deceleration
  /// before a wall. The test passes with 0.2 and 0.4. With 0.1, the deceleration is twice its bound; with 1, the arm is
  /// too slow.
  static constexpr Scalar kTail = Scalar(0.2);
  /// κ. Range: 0.4 to 1. With 0.2, the error along a wall is 2.2 mm, not 0.2 mm. With 0.4, T/κ exceeds τ, as with
  /// kSoft = 0.2.
  static constexpr Scalar kClosing = Scalar(0.8);
  /// The rows use the deviation bound after the fraction t = 1/kSteps of the stop, as for one of kSteps equal steps of
  /// Advancement, but at least after the tick. Range: 2 to 16. With 1, the jerk is 1.7 times larger.
  static constexpr Scalar kSteps = Scalar(4);

  /// The stop, and the motion from which it starts.
  struct Motion {
    JointDisplacement<Clearance> stop;
    const JointVector& qd;
    AllJoints speed;       ///< Velocities of all joints.
    Scalar coasting_time;  ///< Stopping distance divided by the velocity, T − kSoft [s].
    Scalar tick;           ///< h [s]
    Scalar lag;            ///< Delay by bounds on jerk: change of the velocity after the tick, divided by u [s].

    [[nodiscard]] Scalar time() const noexcept { return coasting_time + kSoft; }
  };

  /// A row before finish().
  struct Candidate {
    const ShapePair* pair;
    Scalar gap;           ///< Gap minus the margin [m].
    Scalar gap_slack;     ///< s − c without the second-order change of the distance [m].
    Scalar end_distance;  ///< Distance at the end of the stop, to first order [m].
    Scalar closing;       ///< n·v [m/s]
    Scalar slack;         ///< Permitted minus current closing speed [m/s].
  };

  /// Adds the row of a pair, or the rows of both ends of its first capsule. bound: displacement bounds of the stop.
  template <int P>
  void add(const Clearance& clearance, const ShapePair& pair, const Nearest<Scalar>& found,
           const DisplacementBound<Scalar>& bound, const Motion& motion, Rows<N, P, Scalar>& rows) noexcept {
    const Separation<Clearance> plane(clearance, middle_, pair, found);
    const Scalar at = plane.at();
    const bool between = Scalar(0) < at && at < Scalar(1);
    const AllJoints nearest = plane.of_distance();
    const Scalar part = std::max(Scalar(1) / kSteps, motion.tick / motion.coasting_time);
    const Scalar deviation = bound.c0 + part * (bound.c1 + part * bound.c2);
    const Scalar reserve = kReserve + kLagging * motion.lag * obstacle_velocity(clearance, pair).norm();
    for (int e = 0; e < (between ? 1 : 2); ++e) {
      const AllJoints gradient = between ? nearest : plane.gradient_of(e);
      const JointVector g = clearance.robot().drives().by_drive(gradient);
      const Scalar moved = motion.tick / Scalar(2) * plane.closing;  // Of the obstacle, until the middle of the tick.
      const Scalar gap = (between ? plane.distance : plane.gap(e)) - moved - clearance.margin();
      const Scalar gap_slack = gap - reserve - deviation - decrease_by_single_stops(motion, gradient);
      const Scalar end_distance = plane.distance + nearest.dot(motion.stop.line) - plane.closing * motion.coasting_time;
      Candidate row{&pair, gap, gap_slack, end_distance, plane.closing, Scalar(0)};
      row.slack = closing_speed(clearance, row, row.gap_slack, motion) - plane.closing + g.dot(motion.qd);
      const Eigen::Index k = index_for(row.slack, rows.count);
      if (k == kPairs) continue;
      candidates_[k] = row;
      rows.g.col(k) = g;
    }
  }

  /// Writes the bounds of the rows. end: posture at the end of the stop.
  template <int P>
  void finish(const Clearance& clearance, const JointVector& end, const Motion& motion, Scalar acting_ticks,
              Rows<N, P, Scalar>& rows) noexcept {
    clearance.place(end, end_);
    for (Eigen::Index k = 0; k < rows.count; ++k) {
      const Candidate& row = candidates_[k];
      const Scalar gap_slack =
          row.gap_slack - std::max(row.end_distance - distance_at_end(clearance, *row.pair, motion), Scalar(0));
      const Scalar now = rows.g.col(k).dot(motion.qd);
      // Bound on −gᵀq̇ after the acceleration u of this tick is reduced to zero, where q̇ has changed by
      // acting_ticks h u.
      rows.b(k) = closing_speed(clearance, row, gap_slack, motion) - row.closing;
      rows.b(k) += kLevel == Level::kAcceleration ? now : (Scalar(1) - acting_ticks) * now;
      rows.g.col(k) *= kLevel == Level::kAcceleration ? -acting_ticks * motion.tick : -acting_ticks;
    }
  }

  /// Velocity of the second shape of a pair, 0 for a body [m/s].
  [[nodiscard]] static Vector<3, Scalar> obstacle_velocity(const Clearance& clearance, const ShapePair& pair) noexcept {
    return pair.world ? clearance.obstacles()[pair.second].velocity : Vector<3, Scalar>(Vector<3, Scalar>::Zero());
  }

  /// Distance of a pair at the end of the stop [m]. A moving obstacle moves for the coasting time.
  [[nodiscard]] Scalar distance_at_end(const Clearance& clearance, const ShapePair& pair,
                                       const Motion& motion) const noexcept {
    const Vector<3, Scalar> moved = motion.coasting_time * obstacle_velocity(clearance, pair);
    if (moved.isZero(Scalar(0))) return clearance.nearest_of(end_, pair).distance;
    Capsule<Scalar> relative = end_.bodies[pair.first];
    relative.a -= moved;
    relative.b -= moved;
    return clearance.obstacles()[pair.second].nearest_to(relative).distance;
  }

  /// Largest permitted closing speed −ṡ of a pair [m/s].
  ///
  /// A body with the deceleration a brakes along v²/(2a) + v h = s − s₀/2, where s is the gap beyond the margin, and
  /// s₀ = a τ². For s ≤ s₀, the speed is v = s/τ, and the deceleration is less than a.
  [[nodiscard]] static Scalar closing_speed(const Clearance& clearance, const Candidate& row, Scalar gap_slack,
                                            const Motion& motion) noexcept {
    const Scalar shortest_stop =
        gap_slack > Scalar(0) ? kClosing * gap_slack / motion.time() : gap_slack / (kClosing * motion.coasting_time);
    if (!has_deceleration(clearance, *row.pair)) return shortest_stop;
    const Scalar a = clearance.bodies()[row.pair->first].deceleration;
    const Scalar h = motion.tick;
    const Scalar last = a * kTail * kTail;
    if (!(row.gap > last)) return std::min(shortest_stop, std::max(row.gap, Scalar(0)) / kTail);
    return std::min(shortest_stop, std::sqrt(a * (a * h * h + Scalar(2) * row.gap - last)) - a * h);
  }

  /// Whether a pair is a bound of a task with a finite deceleration. A stop at the deceleration of the bound may need
  /// more distance than the shortest stop.
  [[nodiscard]] static bool has_deceleration(const Clearance& clearance, const ShapePair& pair) noexcept {
    return &pair >= clearance.pairs().data() + clearance.shape_pairs() &&
           std::isfinite(clearance.bodies()[pair.first].deceleration);
  }

  /// Bound on the joint speeds at the end of a tick, after the acceleration is reduced to zero.
  [[nodiscard]] static JointVector largest_speeds(const JointLimits& limits, const JointState& state,
                                                  Scalar acting_ticks) noexcept {
    const JointVector speed = state.qd.cwiseAbs() + acting_ticks * limits.tick() * limits.bounds().acceleration;
    return speed.cwiseMin(limits.bounds().velocity);
  }

  /// Bound on the change of the distance of a pair if joint k moves by at most most(k): Σ_k r_k most(k), over the
  /// joints that move one shape only [m].
  [[nodiscard]] static Scalar displacement_of(const Clearance& clearance, const ShapePair& pair,
                                              const AllJoints& most) noexcept {
    Scalar sum(0);
    const auto add = [&](std::size_t body, JointBits joints) noexcept {
      each_joint(joints, [&](Eigen::Index k) noexcept { sum += clearance.bodies()[body].levers(k) * most(k); });
    };
    add(pair.first, pair.by_first);
    if (pair.by_second != 0) add(pair.second, pair.by_second);
    return sum;
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

  /// Index for a row with the given slack. If fewer than kPairs rows are stored, the next index. Otherwise, the index
  /// of the row with the largest slack, or kPairs if no row has more slack.
  [[nodiscard]] Eigen::Index index_for(Scalar slack, Eigen::Index& count) const noexcept {
    if (count < kPairs) return count++;
    const Candidate* most = std::max_element(candidates_, candidates_ + kPairs,
                                             [](const auto& a, const auto& b) { return a.slack < b.slack; });
    return slack < most->slack ? most - candidates_ : kPairs;
  }

  DisplacementBounds<Clearance> bounds_;
  typename Clearance::Placement middle_;  ///< In the middle of the tick.
  typename Clearance::Placement end_;     ///< At the end of the stop.
  Candidate candidates_[kPairs];
  Scalar distance_sum_ = Scalar(0);
};

}  // namespace fpbm
