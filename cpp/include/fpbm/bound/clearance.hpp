#pragma once

#include <string>
#include <utility>
#include <vector>

#include "fpbm/bound/bounds.hpp"
#include "fpbm/bound/detail/advancement.hpp"
#include "fpbm/bound/detail/away.hpp"
#include "fpbm/bound/detail/motion_away.hpp"
#include "fpbm/bound/detail/pair_rows.hpp"
#include "fpbm/bound/detail/shapes.hpp"
#include "fpbm/bound/detail/too_close.hpp"

namespace fpbm {

/// Bound of a Tracker: all pairs of shapes (Shapes) keep their margin, docs/clearance.md.
///
/// No pair of static shapes comes closer than its margin: a tick is accepted only if all pairs keep their margin until
/// the arm is at rest (Advancement). If the proof fails only for pairs with moving obstacles, the tick is accepted,
/// because the rows bound the motion toward these obstacles.
template <int N, typename Scalar_ = double, int Joints = N>
class Clearance : public Shapes<N, Scalar_, Joints> {
 public:
  using Scalar = Scalar_;
  using Base = Shapes<N, Scalar, Joints>;
  using JointVector = typename Base::JointVector;
  static constexpr int kRows = PairRows<Base, N>::kPairs;
  static constexpr Status kStatus = Status::kBlocked;

  /// source: the Tree or the Chain of the robot. margin: smallest distance of a pair [m]. allowed: names of pairs that
  /// are not checked. Throws the errors of Shapes.
  template <typename Source>
  Clearance(const Source& source, const std::vector<LinkCapsule<Scalar>>& capsules,
            const std::vector<Obstacle<Scalar>>& obstacles, Scalar margin,
            const std::vector<std::pair<std::string, std::string>>& allowed = {})
      : Base(source, capsules, obstacles, margin, allowed), near_(*this), advancement_(*this), rows_(*this) {}

  /// Enables null-space motion away from shapes. Throws std::invalid_argument if a number is out of range.
  void keep_away(const Away<Scalar>& away) {
    validation::require_non_negative("away.gain", away.gain);
    validation::require_positive("away.range", away.range);
    away_ = away;
  }

  [[nodiscard]] bool empty() const noexcept { return this->pairs().empty(); }

  /// Throws std::invalid_argument with the names of the pair if a pair is closer than the margin.
  void require(const JointVector& q) {
    validation::require_size("joints of the clearance", this->robot().dof(), q.size());
    near_.set_posture(*this, q);
    const auto [pair, distance] = this->nearest_pair(near_.here());
    if (!(distance >= this->margin())) {
      reject_close(this->names(this->pairs()[pair]), static_cast<double>(distance),
                   static_cast<double>(this->margin()));
    }
  }

  template <Level kLevel, int P>
  void rows(const NextMotion<kLevel, N, Scalar>& next, Rows<N, P, Scalar>& rows) noexcept {
    near_.set_posture(*this, next.state.q);
    rows_.add(*this, near_, next, rows);
  }

  template <Level kLevel>
  [[nodiscard]] bool accepts(const Limits<kLevel, N, Scalar>&, const State<N, Scalar>&,
                             const Stop<kLevel, N, Scalar>& stop) noexcept {
    if (advancement_.keeps_margins(*this, near_, stop.displacement, stop.time)) return true;
    return this->moves() && advancement_.keeps_margins(*this, near_, stop.displacement, stop.time, Pairs::kStatic);
  }

  /// Calls f(gap, gradient) for each pair whose gap, the distance minus the margin, is below the range in the posture q
  /// [m]. gradient: of the gap with respect to the drives.
  template <typename F>
  void gaps(const JointVector& q, Scalar range, const F& f) noexcept {
    near_.set_posture(*this, q);
    const auto& placed = near_.here();
    for (const ShapePair& pair : this->pairs()) {
      if (this->distance_lower_bound(placed, pair) >= this->margin() + range) continue;
      const Nearest<Scalar> found = this->nearest_of(placed, pair);
      const Scalar gap = found.distance - this->margin();
      if (gap < range) {
        f(gap, this->robot().drives().by_drive(Separation<Base>(*this, placed, pair, found).of_distance()));
      }
    }
  }

  /// Sum of the distances of the pairs that rows() found near [m]. While the arm is at rest, the sum changes only if
  /// obstacles move.
  [[nodiscard]] Scalar near_distance_sum() const noexcept { return rows_.distance_sum(); }

  /// Whether null-space motion away from shapes is enabled.
  [[nodiscard]] bool moves_away() const noexcept { return away_.gain > Scalar(0) && !empty(); }
  /// Null-space motion away from shapes in the posture q.
  [[nodiscard]] JointVector away(const JointVector& q) noexcept {
    near_.set_posture(*this, q);
    return motion_away<Base>(*this, near_.here(), away_);
  }

 private:
  NearPairs<Base> near_;  ///< At the state of rows().
  Advancement<Base> advancement_;
  PairRows<Base, N> rows_;
  Away<Scalar> away_;
};

}  // namespace fpbm
