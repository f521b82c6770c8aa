#pragma once

#include <cstdint>
#include <string>

#include "fpbm/bound/detail/advancement.hpp"
#include "fpbm/bound/detail/motion_away.hpp"
#include "fpbm/bound/detail/pair_rows.hpp"
#include "fpbm/bound/detail/speed_bound.hpp"
#include "fpbm/bound/detail/too_close.hpp"

namespace fpbm {

/// Keeps the margin of all pairs of a clearance, tick by tick: docs/clearance.md.
///
/// A tick is executed only if the arm can stop after the tick, and all pairs keep their margin until the arm is at rest
/// (Advancement). Otherwise the arm continues the stopping trajectory of the previous tick. By induction from the
/// start, no pair of static shapes comes closer than its margin. The bounds of rows() on the next motion leave slack
/// for the check by Advancement, so that the arm slides along a surface instead of stopping before it. Joints: as in
/// Clearance.
template <Level kLevel, int N, typename Scalar = double, int Joints = N>
class Guard {
 public:
  using Clearance = fpbm::Clearance<N, Scalar, Joints>;
  /// Largest number of rows: the rows of pairs, and two for speeds.
  static constexpr int kRows = PairRows<kLevel, Clearance, N>::kPairs + 2;
  using JointVector = Vector<N, Scalar>;
  using JointState = State<N, Scalar>;
  using JointLimits = Limits<kLevel, N, Scalar>;

  explicit Guard(const Clearance& clearance)
      : clearance_(clearance),
        near_pairs_(clearance),
        advancement_(clearance),
        pair_rows_(clearance),
        placed_(clearance.placement()),
        plan_(clearance.robot().dof()),
        displacement_(StopDisplacement<N, Scalar>::none(clearance.robot().dof())) {}

  /// Starts from a state after a tick with the acceleration `last`. Throws std::invalid_argument with the names of the
  /// pair if a pair is closer than the margin, or if the arm cannot stop with all margins kept.
  void require_clear(const JointLimits& limits, const JointState& start, const JointVector& last) {
    validation::require_size("joints of the clearance", clearance_.robot().dof(), start.q.size());
    acting_ticks_ = plan_.acting_ticks(limits);
    if (empty()) return;
    for (Eigen::Index i = 0; i < start.q.size() && !limits.is_viable(start, last); ++i) {
      // Only from rest does the stop of a joint outside its range have the bounds that the stopping trajectory assumes.
      if (start.qd(i) == Scalar(0) && last(i) == Scalar(0)) continue;
      validation::fail(validation::element("qd0", i), start.qd(i),
                       "0 before a start outside the bounds with a clearance or task bounds: stop the arm first");
    }
    near_pairs_.set_posture(clearance_, start.q);
    const auto [pair, distance] = clearance_.nearest_pair(near_pairs_.here(), 0, clearance_.shape_pairs());
    if (!(distance >= clearance_.margin())) {
      const ShapePair& close = clearance_.pairs()[pair];
      reject_close(clearance_.names(close), static_cast<double>(distance), static_cast<double>(clearance_.margin()));
    }
    const auto [bound, slack] =
        clearance_.nearest_pair(near_pairs_.here(), clearance_.shape_pairs(), clearance_.pairs().size());
    if (!(slack >= clearance_.margin())) {
      validation::reject("q0", ": is beyond the bound '" + clearance_.names(clearance_.pairs()[bound]).first +
                                   "': must be within the task bounds");
    }
    plan_ = {limits, start, last};
    displacement_ = plan_.displacement(limits, start, start);
    if (!advancement_.keeps_margins(clearance_, near_pairs_, displacement_, time(limits), Pairs::kStatic)) {
      validation::reject("qd0", ": is too fast: must be slow enough for the arm to stop with all margins kept");
    }
  }

  /// Whether there are no pairs.
  [[nodiscard]] bool empty() const noexcept { return clearance_.pairs().empty(); }
  /// Use this reference for Clearance::move() and Clearance::keep_away(). Bounds that are added after the construction
  /// of the guard have no effect.
  [[nodiscard]] Clearance& clearance() noexcept { return clearance_; }
  [[nodiscard]] const Clearance& clearance() const noexcept { return clearance_; }

  /// Bounds on the next motion from `state`, for the pairs that are near enough to need bounds (PairRows).
  [[nodiscard]] Rows<N, kRows, Scalar> rows(const JointLimits& limits, const JointState& state) noexcept {
    Rows<N, kRows, Scalar> rows;
    rows.g.resize(state.q.size(), kRows);
    pair_rows_.begin();
    if (!empty()) {
      near_pairs_.set_posture(clearance_, state.q);
      pair_rows_.write(clearance_, near_pairs_, limits, state, plan_, displacement_, acting_ticks_, rows);
    }
    pair_count_ = rows.count;
    return rows;
  }

  /// Adds rows for the bounds on speeds that the motion u would exceed.
  void bound_speeds(const JointLimits& limits, const JointState& state, const JointVector& u,
                    Rows<N, kRows, Scalar>& rows) noexcept {
    fpbm::bound_speeds(clearance_, placed_, limits, state, acting_ticks_, u, rows);
  }

  /// Whether any active row is the row of a pair. rows: bit k is set if row k is active.
  [[nodiscard]] bool is_near(std::uint32_t rows) const noexcept {
    return (rows & ((std::uint32_t(1) << pair_count_) - std::uint32_t(1))) != 0;
  }

  /// Sum of the distances of the pairs that rows() found near [m]. While the arm is at rest, the sum changes only if
  /// obstacles move.
  [[nodiscard]] Scalar near_distance_sum() const noexcept { return pair_rows_.distance_sum(); }

  /// Whether null-space motion away from shapes is enabled.
  [[nodiscard]] bool moves_away() const noexcept { return clearance_.away().gain > Scalar(0) && !empty(); }
  /// Null-space motion away from shapes, at the state of rows().
  [[nodiscard]] JointVector away() const noexcept { return motion_away(clearance_, near_pairs_.here()); }

  /// Whether the arm may move in a tick from the state of rows() to the state `to`. If the result is true, the stopping
  /// trajectory from `to` becomes the plan. If the proof fails only for pairs with moving obstacles, the tick is
  /// accepted, because the rows bound the motion toward these obstacles.
  [[nodiscard]] bool accepts(const JointLimits& limits, const JointState& from, const JointState& to) noexcept {
    const StopPlan<kLevel, N, Scalar> plan(limits, to, (to.qd - from.qd) / limits.tick());
    const StopDisplacement<N, Scalar> displacement = plan.displacement(limits, from, to);
    const Scalar time = limits.tick() * (Scalar(1) + plan.ticks_left());
    if (!advancement_.keeps_margins(clearance_, near_pairs_, displacement, time)) {
      if (!clearance_.moves()) return false;
      if (!advancement_.keeps_margins(clearance_, near_pairs_, displacement, time, Pairs::kStatic)) return false;
    }
    plan_ = plan;
    displacement_ = displacement;
    return true;
  }

  /// Accelerations of the next tick of the planned stop.
  [[nodiscard]] JointVector stop(const JointLimits& limits, const JointState& state, const JointVector& last) noexcept {
    return plan_.next(limits, state, last);
  }

 private:
  [[nodiscard]] Scalar time(const JointLimits& limits) const noexcept {
    return limits.tick() * (Scalar(1) + plan_.ticks_left());
  }

  Clearance clearance_;
  NearPairs<Clearance> near_pairs_;  ///< At the state of rows().
  Advancement<Clearance> advancement_;
  PairRows<kLevel, Clearance, N> pair_rows_;
  typename Clearance::Placement placed_;  ///< Memory of bound_speeds().
  StopPlan<kLevel, N, Scalar> plan_;
  StopDisplacement<N, Scalar> displacement_;  ///< Displacement in the tick before the plan, and in the plan.
  Scalar acting_ticks_ = Scalar(1);           ///< StopPlan::acting_ticks().
  Eigen::Index pair_count_ = 0;               ///< Number of rows for pairs.
};

}  // namespace fpbm
