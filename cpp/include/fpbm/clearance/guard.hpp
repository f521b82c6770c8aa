#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "fpbm/clearance/advancement.hpp"
#include "fpbm/clearance/motion_away.hpp"
#include "fpbm/clearance/speed_bound.hpp"
#include "fpbm/clearance/too_close.hpp"
#include "fpbm/limits/rows.hpp"

namespace fpbm {

/// Keeps the margin of all pairs of a clearance, tick by tick: docs/clearance.md.
///
/// A tick is executed only if the arm can stop from its end, and all pairs keep their margin until the arm is at rest
/// (Advancement). Otherwise the arm continues the stopping trajectory of the previous tick. By induction from the
/// start, no pair of static shapes comes closer than its margin. The bounds of rows() on the next motion leave slack
/// for this check, so that the arm slides along a surface instead of stopping before it. Joints: as in Clearance.
template <Level kLevel, int N, typename Scalar = double, int Joints = N>
class Guard {
 public:
  using Clearance = fpbm::Clearance<N, Scalar, Joints>;
  static constexpr int kPairs = 16;         ///< Largest number of rows for pairs: those with the smallest slack.
  static constexpr int kRows = kPairs + 2;  ///< The last rows are for speeds.
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

  /// Starts from a state after a tick with the acceleration `last`. Throws std::invalid_argument with the names of the
  /// pair if a pair is closer than the margin, or if the arm cannot stop with all margins kept.
  void require_clear(const JointLimits& limits, const JointState& start, const JointVector& last) {
    validation::require_size("clearance's joints", clearance_.robot().dof(), start.q.size());
    late_ = plan_.latency(limits);
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

  /// Whether there are no pairs.
  [[nodiscard]] bool empty() const noexcept { return clearance_.pairs().empty(); }
  /// To move obstacles, or to set away(). Bounds that are added after the construction of the guard have no effect.
  [[nodiscard]] Clearance& clearance() noexcept { return clearance_; }
  [[nodiscard]] const Clearance& clearance() const noexcept { return clearance_; }

  /// Bounds on the next motion, for the pairs that are near enough to need them (docs/clearance.md, "Rows").
  ///
  /// Let s be the gap of a pair, g its gradient with respect to the drives, n the normal from the second shape to the
  /// first, and v the velocity of an obstacle. After the tick, the gap must satisfy
  ///
  ///   −ṡ T ≤ κ (s − c),        ṡ = gᵀq̇ − nᵀv.
  ///
  /// T is the stopping distance of the planned stop divided by the velocity, plus kSoft. c is the margin plus the part
  /// of the gap that the stop needs beyond the first-order term gᵀp, where p is the displacement of the stop. The arm
  /// therefore stops smoothly at the margin, and slides along a surface. κ < 1 leaves slack for the check by
  /// Advancement. If s < c, the gap must open:
  /// ṡ ≥ (c − s)/(κ (T − kSoft)).
  ///
  /// 1. Bound the joint displacements until rest, and with them the distance within which a pair needs a row.
  /// 2. For each pair within this distance, compute s − c and g. Keep the kPairs rows with the smallest slack.
  /// 3. Subtract the second-order change of the distance at the end of the stop, and write the rows gᵀu ≤ b.
  [[nodiscard]] Rows<N, kRows, Scalar> rows(const JointLimits& limits, const JointState& state) noexcept {
    Rows<N, kRows, Scalar> rows;
    rows.g.resize(state.q.size(), kRows);
    room_ = Scalar(0);
    near_ = 0;
    if (empty()) return rows;
    const Scalar h = limits.tick();
    near_pairs_.go_to(clearance_, state.q);
    const auto& drives = clearance_.robot().drives();
    // Not rounded to whole ticks: the steps of a rounded number would cause jerks.
    const Scalar ticks = Scalar(1) + plan_.smooth_average(limits);
    const Scalar average = h * ticks;
    const Scalar time = average + kSoft;
    // After the acceleration u of this tick is reduced to zero, the velocity is q̇ + late h u.
    const Scalar late = late_;
    JointSweep<Clearance> sweep(clearance_, sweep_);
    const JointVector way = ticks / (Scalar(1) + plan_.average()) * sweep_.way;
    sweep.way = drives.rates(way);
    JointSweep<Clearance> fastest = sweep;
    fastest.way = (time / kShare) * drives.rates(fastest_of(limits, state, late));
    // A pair that is farther apart than the displacement bound of `fastest` needs no row. The deviation bound c₀ + c₁ +
    // c₂ is at most Σ_k r_k x_k Σ_j x_j, with x = most and the levers r_k.
    const auto most = (sweep.way.cwiseAbs() + sweep.rest).eval();
    const Scalar turned = most.sum();
    const auto speed = drives.rates(state.qd);
    near_pairs_.set_displacements(clearance_,
                                  fastest.way + sweep.rest + turned * most + h / Scalar(2) * speed.cwiseAbs(), time);
    // The rows are evaluated in the middle of the tick, like J of the task. At the start of the tick, they would differ
    // by h/2 d(∇s)/dt.
    const JointVector middle = state.q + h / Scalar(2) * state.qd;
    bool is_placed = false;
    of_plan_.begin();
    of_fastest_.begin();
    const ShapePair* pairs[kPairs];
    Scalar slack[kPairs];
    Scalar closing[kPairs];
    Scalar gaps[kPairs];  // For bounds with a deceleration: n·x − offset.
    std::uint32_t gentle_rows = 0;
    Scalar spares[kPairs];  // Slack of each row [m/s]: permitted minus current closing speed.
    // A bound with its own deceleration may need more distance than the shortest stop.
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
        // s − c, without the second-order change of the distance.
        const Scalar left = gap - kReserve - taken - beyond_slope(sweep, speed, gradient, average);
        Scalar allowed = kShare * left / time;
        if (gentle) allowed = most_closing(gap - clearance_.margin(), allowed, clearance_.bodies()[pair.first], h);
        const Scalar spare = allowed - plane.closing + g.dot(state.qd);
        const Eigen::Index k = row_for(spare, spares, rows.count);
        if (k == kPairs) continue;
        spares[k] = spare;
        pairs[k] = &pair;
        slack[k] = plane.distance + nearest.dot(sweep.way);  // Distance at the end of the stop, to first order.
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
      rows.b(k) = allowed - closing[k];  // Bound on −gᵀq̇ after the tick.
      rows.b(k) += kLevel == Level::kAcceleration ? now : (Scalar(1) - late) * now;
      rows.g.col(k) *= kLevel == Level::kAcceleration ? -late * h : -late;
    }
    return rows;
  }

  /// Adds rows for the bounds on speeds that the motion u would exceed.
  void bound_speeds(const JointLimits& limits, const JointState& state, const JointVector& u,
                    Rows<N, kRows, Scalar>& rows) noexcept {
    fpbm::bound_speeds(clearance_, ahead_, limits, state, late_, u, rows);
  }

  /// Whether any active row is the row of a pair. rows: bit k is set if row k is active.
  [[nodiscard]] bool is_near(std::uint32_t rows) const noexcept {
    return (rows & ((std::uint32_t(1) << near_) - std::uint32_t(1))) != 0;
  }

  /// Sum of the distances of the pairs that rows() found near [m]. While the arm is at rest, the sum changes only if
  /// obstacles move.
  [[nodiscard]] Scalar room() const noexcept { return room_; }

  /// Whether null-space motion away from shapes is enabled.
  [[nodiscard]] bool draws_away() const noexcept { return clearance_.away().gain > Scalar(0) && !empty(); }
  /// Null-space motion away from shapes, at the state of rows().
  [[nodiscard]] JointVector away() const noexcept { return motion_away(clearance_, near_pairs_.here()); }

  /// Whether the arm may move in a tick from the state of rows() to the state `to`. If so, the stopping trajectory from
  /// `to` becomes the plan. If the proof fails only for pairs with moving obstacles, the tick is accepted, because the
  /// rows bound the motion toward these obstacles.
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

  /// Accelerations of the next tick of the planned stop.
  [[nodiscard]] JointVector stop(const JointLimits& limits, const JointState& state, const JointVector& last) noexcept {
    return plan_.next(limits, state, last);
  }

 private:
  /// Largest speed v at which a gap s may close. A body with the deceleration a brakes along v²/(2a) + v h = s − s₀/2.
  /// For s ≤ s₀ = a τ², the bound is v = s/τ, which decelerates by less than a. hard: bound of the shortest stop.
  [[nodiscard]] static Scalar most_closing(Scalar gap, Scalar hard, const typename Clearance::Body& body,
                                           Scalar h) noexcept {
    const Scalar a = body.deceleration;
    const Scalar last = a * kTail * kTail;
    if (!(gap > last)) return std::min(hard, std::max(gap, Scalar(0)) / kTail);
    return std::min(hard, std::sqrt(a * (a * h * h + Scalar(2) * gap - last)) - a * h);
  }

  /// Bound on the joint speeds at the end of a tick, after the acceleration is reduced to zero.
  [[nodiscard]] static JointVector fastest_of(const JointLimits& limits, const JointState& state,
                                              Scalar late) noexcept {
    JointVector speed = state.qd.cwiseAbs() + late * limits.tick() * limits.bounds().acceleration;
    return speed.cwiseMin(limits.bounds().velocity);
  }

  /// Index for a row with this slack: the next index if there is one, otherwise the index of the row with the largest
  /// slack, or kPairs if no row has more slack.
  [[nodiscard]] static Eigen::Index row_for(Scalar spare, const Scalar* spares, Eigen::Index& count) noexcept {
    if (count < kPairs) return count++;
    const Scalar* most = std::max_element(spares, spares + kPairs);
    return spare < *most ? most - spares : kPairs;
  }

  [[nodiscard]] Scalar time(const JointLimits& limits) const noexcept {
    return limits.tick() * (Scalar(1) + plan_.ticks_left());
  }

  /// Distance that the rows keep beyond the margin, so that an arm at rest can move along a surface. It is larger than
  /// the second-order displacement of a tick from rest [m].
  static constexpr Scalar kReserve = Scalar(1e-6);
  static constexpr Scalar kSoft = Scalar(0.05);  ///< Part of T beyond the stopping time [s].
  static constexpr Scalar kTail = Scalar(0.2);   ///< τ [s], larger than the usual T/κ (TaskBounds.stop_gently*).
  static constexpr Scalar kShare = Scalar(0.8);  ///< κ
  static constexpr Scalar kSteps = Scalar(4);    ///< Steps of the advancement, for the deviation bound of one step.

  Clearance clearance_;
  NearPairs<Clearance> near_pairs_;  ///< At the state of rows().
  Advancement<Clearance> advancement_;
  DisplacementBounds<Clearance> of_plan_;
  DisplacementBounds<Clearance> of_fastest_;
  typename Clearance::Placement middle_;  ///< In the middle of the tick.
  typename Clearance::Placement ahead_;   ///< At the end of the stop.
  StopPlan<kLevel, N, Scalar> plan_;
  Sweep<N, Scalar> sweep_;   ///< Of the tick that leads to the plan, and of the plan.
  Scalar late_ = Scalar(1);  ///< StopPlan::latency() [ticks].
  Scalar room_ = Scalar(0);
  Eigen::Index near_ = 0;  ///< Number of rows for pairs.
};

}  // namespace fpbm
