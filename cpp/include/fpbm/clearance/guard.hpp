#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "fpbm/clearance/advancement.hpp"
#include "fpbm/clearance/motion_away.hpp"
#include "fpbm/clearance/speed_bound.hpp"
#include "fpbm/clearance/too_close.hpp"
#include "fpbm/limits/rows.hpp"

namespace fpbm {

/// Keeps an arm clear of itself and its surroundings, tick by tick.
///
/// A tick is taken only if from its end the arm can stop with all pairs keeping their margin all the way
/// (keeps_apart()); else the arm goes on with the stop that was found for the tick before. So no pair that does not
/// move by itself ever comes nearer than its margin, by induction from the start. rows() are bounds on the next motion
/// that leave room for that: they make the arm slide along a surface rather than stop before it.
/// Joints: that of the Clearance.
template <Level kLevel, int N, typename Scalar = double, int Joints = N>
class Guard {
 public:
  using Clearance = fpbm::Clearance<N, Scalar, Joints>;
  static constexpr int kPairs = 16;         ///< Rows for pairs, at most: of more, those with least to spare.
  static constexpr int kRows = kPairs + 2;  ///< The last ones for speeds.
  using JointVector = Vector<N, Scalar>;
  using JointState = State<N, Scalar>;
  using JointLimits = Limits<kLevel, N, Scalar>;

  explicit Guard(const Clearance& clearance)
      : clearance_(clearance),
        near_pairs_(clearance),
        advancement_(clearance),
        of_plan_(clearance),
        of_fastest_(clearance),
        middle_(clearance.placement()),
        ahead_(clearance.placement()),
        plan_(clearance.robot().dof()),
        sweep_(plan_.sweep()) {}

  /// Starts from a state after a tick of acceleration last. Throws std::invalid_argument, with the pair's names, where
  /// the arm is not clear of all, or cannot stop clear of it.
  void require_clear(const JointLimits& limits, const JointState& start, const JointVector& last) {
    validation::require_size("clearance's joints", clearance_.robot().dof(), start.q.size());
    if (empty()) return;
    near_pairs_.go_to(clearance_, start.q);
    const auto [pair, distance] = clearance_.nearest_pair(near_pairs_.here(), 0, clearance_.shape_pairs());
    if (!(distance >= clearance_.margin())) {
      const ShapePair& close = clearance_.pairs()[pair];
      reject_close(clearance_.names(close), static_cast<double>(distance), static_cast<double>(clearance_.margin()));
    }
    const auto [bound, room] =
        clearance_.nearest_pair(near_pairs_.here(), clearance_.shape_pairs(), clearance_.pairs().size());
    if (!(room >= clearance_.margin())) {
      validation::reject("q0", ": is beyond the bound '" + clearance_.names(clearance_.pairs()[bound]).first +
                                   "': must be within the task bounds");
    }
    plan_ = {limits, start, last};
    sweep_ = plan_.sweep(limits, start, start);
    if (!advancement_.keeps_apart(clearance_, near_pairs_, sweep_, time(limits), Pairs::kAtRest)) {
      validation::reject("qd0", ": is too fast: must be slow enough for the arm to stop before all shapes");
    }
  }

  /// Whether there is nothing to keep clear of.
  [[nodiscard]] bool empty() const noexcept { return clearance_.pairs().empty(); }
  /// To move obstacles, or to set away(). Bounds that are added after the construction have no effect.
  [[nodiscard]] Clearance& clearance() noexcept { return clearance_; }
  [[nodiscard]] const Clearance& clearance() const noexcept { return clearance_; }

  /// Bounds on the next tick's motion from a state, for the pairs that are near enough to need them.
  ///
  /// A gap s that closes at w must not close faster than w T ≤ κ (s − c), where T is the time that the plan's stop
  /// takes on average, with an offset, and c is what the plan's way takes beyond its slope. So the arm comes to rest at
  /// the margin without a jolt, and slides along a surface. κ < 1 leaves room for keeps_apart().
  [[nodiscard]] Rows<N, kRows, Scalar> rows(const JointLimits& limits, const JointState& state) noexcept {
    Rows<N, kRows, Scalar> rows;
    rows.g.resize(state.q.size(), kRows);
    room_ = Scalar(0);
    near_ = 0;
    if (empty()) return rows;
    const Scalar h = limits.tick();
    near_pairs_.go_to(clearance_, state.q);
    const auto& drives = clearance_.robot().drives();
    // Without the steps that whole ticks make, which would be felt as jerks.
    const Scalar ticks = Scalar(1) + plan_.smooth_average(limits);
    const Scalar average = h * ticks;
    const Scalar time = average + kSoft;
    // Velocity at the tick's end, after letting go of the acceleration: qd + late h u.
    const Scalar late = plan_.latency(limits);
    JointSweep<Clearance> sweep(clearance_, sweep_);
    const JointVector way = ticks / (Scalar(1) + plan_.average()) * sweep_.way;
    sweep.way = drives.rates(way);
    JointSweep<Clearance> fastest = sweep;
    fastest.way = (time / kShare) * drives.rates(fastest_of(limits, state, late));
    // No pair whose distance exceeds a reach of fastest needs a row; bend takes no more than its reach times all turns.
    const auto most = (sweep.way.cwiseAbs() + sweep.rest).eval();
    const Scalar turned = most.sum();
    const auto speed = drives.rates(state.qd);
    near_pairs_.set_displacements(clearance_,
                                  fastest.way + sweep.rest + turned * most + h / Scalar(2) * speed.cwiseAbs(), time);
    // The rows are those of the tick's middle, as the task's J is: at its start they differ by h/2 d(∇s)/dt.
    const JointVector middle = state.q + h / Scalar(2) * state.qd;
    bool is_placed = false;
    of_plan_.begin();
    of_fastest_.begin();
    const ShapePair* pairs[kPairs];
    Scalar slack[kPairs];
    Scalar closing[kPairs];
    Scalar gaps[kPairs];  // Of rows of bounds with a deceleration.
    std::uint32_t gentle_rows = 0;
    Scalar spares[kPairs];  // By how much gaps close slower than they may.
    // A bound with its own deceleration may need more distance than the quickest stop.
    const auto is_gentle = [&](const ShapePair& pair) noexcept {
      return &pair >= clearance_.pairs().data() + clearance_.shape_pairs() &&
             std::isfinite(clearance_.bodies()[pair.first].deceleration);
    };
    const auto needs = [&](const ShapePair& pair) noexcept {
      return is_gentle(pair) ? std::numeric_limits<Scalar>::infinity()
                             : clearance_.margin() + near_pairs_.displacement_of(pair);
    };
    near_pairs_.each(clearance_, needs, [&](std::size_t number, const Nearest<Scalar>&) noexcept {
      const ShapePair& pair = clearance_.pairs()[number];
      const bool gentle = is_gentle(pair);
      if (!is_placed) clearance_.place(middle, middle_);
      is_placed = true;
      const Nearest<Scalar> found = clearance_.nearest_of(middle_, pair);
      const DisplacementBound<Scalar> bound = of_plan_.of(clearance_, pair, sweep);
      const Scalar taken = clearance_.margin() + bound.c0 + bound.c1 / kSteps + bound.c2 / (kSteps * kSteps);
      const Scalar far = clearance_.margin() + bound.c0 + bound.c1 + bound.c2 + near_pairs_.moves(pair) +
                         of_fastest_.of(clearance_, pair, fastest).displacement(Scalar(1));
      if (!gentle && found.distance >= far) return;
      room_ += found.distance;
      const Separation<Clearance> plane(clearance_, middle_, pair, found);
      const Scalar at = plane.at();
      const bool between = Scalar(0) < at && at < Scalar(1);
      const auto nearest = plane.of_distance();
      for (int e = 0; e < (between ? 1 : 2); ++e) {
        const Scalar gap = between ? plane.distance : plane.gap(e);
        const auto gradient = between ? nearest : plane.gradient_of(e);
        const JointVector g = drives.by_drive(gradient);
        const Scalar left = gap - kReserve - taken - beyond_slope(sweep, speed, gradient, average);
        Scalar allowed = kShare * left / time;
        if (gentle) allowed = most_closing(gap - clearance_.margin(), allowed, clearance_.bodies()[pair.first], h);
        const Scalar spare = allowed - plane.closing + g.dot(state.qd);
        const Eigen::Index k = row_for(spare, spares, rows.count);
        if (k == kPairs) continue;
        spares[k] = spare;
        pairs[k] = &pair;
        slack[k] = plane.distance + nearest.dot(sweep.way);  // At the way's end, without what bends it.
        closing[k] = plane.closing;
        gentle_rows &= ~(std::uint32_t(1) << k);
        if (gentle) {
          gentle_rows |= std::uint32_t(1) << k;
          gaps[k] = gap - clearance_.margin();
        }
        rows.b(k) = left;
        rows.g.col(k) = g;
      }
    });
    near_ = rows.count;
    if (near_ == 0) return rows;
    clearance_.place(JointVector(middle + way), ahead_);
    for (Eigen::Index k = 0; k < rows.count; ++k) {
      const Scalar bent = slack[k] - clearance_.nearest_of(ahead_, *pairs[k]).distance;
      const Scalar left = rows.b(k) - std::max(bent, Scalar(0));
      const Scalar now = rows.g.col(k).dot(state.qd);
      Scalar allowed = left > Scalar(0) ? kShare * left / time : left / (kShare * average);
      if ((gentle_rows >> k & 1U) != 0) {
        allowed = most_closing(gaps[k], allowed, clearance_.bodies()[pairs[k]->first], h);
      }
      rows.b(k) = allowed - closing[k];  // −g·q̇
      rows.b(k) += kLevel == Level::kAcceleration ? now : (Scalar(1) - late) * now;
      rows.g.col(k) *= kLevel == Level::kAcceleration ? -late * h : -late;
    }
    return rows;
  }

  /// Adds rows for the speeds that a tick's motion would exceed.
  void bound_speeds(const JointLimits& limits, const JointState& state, const JointVector& u,
                    Rows<N, kRows, Scalar>& rows) noexcept {
    fpbm::bound_speeds(clearance_, ahead_, limits, state, plan_.latency(limits), u, rows);
  }

  /// Whether some of the rows that bound a motion are those of pairs; bit k is for row k.
  [[nodiscard]] bool is_near(std::uint32_t rows) const noexcept {
    return (rows & ((std::uint32_t(1) << near_) - std::uint32_t(1))) != 0;
  }

  /// Sum of the distances of pairs that rows() found near. While the arm rests, it changes only where shapes move.
  [[nodiscard]] Scalar room() const noexcept { return room_; }

  /// Motion away from shapes, for the null space, where it was asked for.
  [[nodiscard]] bool draws_away() const noexcept { return clearance_.away().gain > Scalar(0) && !empty(); }
  /// At the state of rows().
  [[nodiscard]] JointVector away() const noexcept { return motion_away(clearance_, near_pairs_.here()); }

  /// Whether the arm may move from the state of rows() to another in a tick; if so, a stop from there is the plan. If
  /// no stop is sure to be clear of shapes that move, the rows bound the motion toward them.
  [[nodiscard]] bool accepts(const JointLimits& limits, const JointState& from, const JointState& to) noexcept {
    const StopPlan<kLevel, N, Scalar> plan(limits, to, (to.qd - from.qd) / limits.tick());
    const Sweep<N, Scalar> sweep = plan.sweep(limits, from, to);
    const Scalar time = limits.tick() * (Scalar(1) + plan.ticks_left());
    if (!advancement_.keeps_apart(clearance_, near_pairs_, sweep, time)) {
      if (!clearance_.moves()) return false;
      if (!advancement_.keeps_apart(clearance_, near_pairs_, sweep, time, Pairs::kAtRest)) return false;
    }
    plan_ = plan;
    sweep_ = sweep;
    return true;
  }

  /// Accelerations of the next tick of the plan.
  [[nodiscard]] JointVector stop(const JointLimits& limits, const JointState& state, const JointVector& last) noexcept {
    return plan_.next(limits, state, last);
  }

 private:
  /// Most speed v at which a gap s may close. A body with a deceleration a brakes by a, v²/2a + v h ≤ s − s₀/2, until
  /// s₀ = a τ², from where v = s/τ decelerates by less.
  [[nodiscard]] static Scalar most_closing(Scalar gap, Scalar hard, const typename Clearance::Body& body,
                                           Scalar h) noexcept {
    const Scalar a = body.deceleration;
    const Scalar last = a * kTail * kTail;
    if (!(gap > last)) return std::min(hard, std::max(gap, Scalar(0)) / kTail);
    return std::min(hard, std::sqrt(a * (a * h * h + Scalar(2) * gap - last)) - a * h);
  }

  /// No joint can be faster at a tick's end, once its acceleration has been let go.
  [[nodiscard]] static JointVector fastest_of(const JointLimits& limits, const JointState& state,
                                              Scalar late) noexcept {
    JointVector speed = state.qd.cwiseAbs() + late * limits.tick() * limits.bounds().acceleration;
    return speed.cwiseMin(limits.bounds().velocity);
  }

  /// Where a row with so much to spare goes: behind those that are there, in place of the one with most of all, or
  /// nowhere, at kPairs.
  [[nodiscard]] static Eigen::Index row_for(Scalar spare, const Scalar* spares, Eigen::Index& count) noexcept {
    if (count < kPairs) return count++;
    const Scalar* most = std::max_element(spares, spares + kPairs);
    return spare < *most ? most - spares : kPairs;
  }

  [[nodiscard]] Scalar time(const JointLimits& limits) const noexcept {
    return limits.tick() * (Scalar(1) + plan_.ticks_left());
  }

  /// What an arm at rest keeps beyond the margin, so that it can move on: more than a tick from rest may bend.
  static constexpr Scalar kReserve = Scalar(1e-6);
  static constexpr Scalar kSoft = Scalar(0.05);  ///< Offset of the envelope over its deceleration [s].
  static constexpr Scalar kTail = Scalar(0.2);   ///< τ [s], above the usual T/κ (TaskBounds.stop_gently*).
  static constexpr Scalar kShare = Scalar(0.8);  ///< κ
  static constexpr Scalar kSteps = Scalar(4);    ///< Advances that a stop along a surface may take.

  Clearance clearance_;
  NearPairs<Clearance> near_pairs_;  ///< At the state of rows().
  Advancement<Clearance> advancement_;
  DisplacementBounds<Clearance> of_plan_;
  DisplacementBounds<Clearance> of_fastest_;
  typename Clearance::Placement middle_;  ///< In the middle of the tick.
  typename Clearance::Placement ahead_;   ///< At the end of the stop.
  StopPlan<kLevel, N, Scalar> plan_;
  Sweep<N, Scalar> sweep_;  ///< Of the plan and the tick before it.
  Scalar room_ = Scalar(0);
  Eigen::Index near_ = 0;  ///< Rows of pairs.
};

}  // namespace fpbm
