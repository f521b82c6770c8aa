#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "fpbm/core/detail/mask.hpp"
#include "fpbm/core/detail/validation.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/geometry/space.hpp"
#include "fpbm/linalg/detail/entrywise.hpp"
#include "fpbm/model/detail/spread_posture.hpp"
#include "fpbm/model/joint.hpp"

namespace fpbm {

/// Ranges of the joints for a search of postures.
template <int N, typename Scalar>
struct JointRanges {
  Vector<N, Scalar> lower;
  Vector<N, Scalar> upper;
  JointBits periodic = 0;  ///< Bits of the joints whose turn by 2π changes no task.
  JointBits idle = 0;      ///< Bits of the joints that move no task.

  /// Finds periodic and idle joints: joints whose displacement changes no point of the tasks, up to round-off, in a few
  /// postures. difference(q, moved): distance of the points in two postures, in characteristic lengths and radians.
  template <typename Difference>
  void examine(const Difference& difference) noexcept;

  /// Throws std::invalid_argument if the ranges are not for dof joints, or a joint has no range.
  void require_sound(Eigen::Index dof) const {
    validation::require_size("limits", lower.size(), dof);
    for (Eigen::Index i = 0; i < dof; ++i) {
      if (!(lower(i) <= upper(i))) {
        validation::fail(validation::element("limits.lower", i), lower(i), "at most upper = ", upper(i));
      }
    }
  }

  /// The ranges that bound a search: a periodic joint with a range of at least one turn has no ends, since every
  /// position is equal to a position in the range.
  [[nodiscard]] JointRanges of_search() const noexcept {
    constexpr Scalar kRoundOff = Scalar(64) * std::numeric_limits<Scalar>::epsilon();
    JointRanges ranges = *this;
    each_joint(periodic, [&](Eigen::Index i) noexcept {
      if (!(upper.coeff(i) - lower.coeff(i) >= static_cast<Scalar>(kTwoPi) * (Scalar(1) - kRoundOff))) return;
      ranges.lower.coeffRef(i) = -std::numeric_limits<Scalar>::infinity();
      ranges.upper.coeffRef(i) = std::numeric_limits<Scalar>::infinity();
    });
    return ranges;
  }

  [[nodiscard]] Vector<N, Scalar> clamp(const Vector<N, Scalar>& q) const noexcept {
    return entrywise(q, [&](Eigen::Index i) { return std::min(std::max(q.coeff(i), lower.coeff(i)), upper.coeff(i)); });
  }

  /// The posture whose periodic joints are as near to the start as turns by 2π within the ranges allow.
  [[nodiscard]] Vector<N, Scalar> near(const Vector<N, Scalar>& q, const Vector<N, Scalar>& start) const noexcept {
    Vector<N, Scalar> result = q;
    each_joint(periodic, [&](Eigen::Index i) noexcept {
      constexpr auto kTurn = static_cast<Scalar>(kTwoPi);
      const Scalar least = std::ceil((lower.coeff(i) - q.coeff(i)) / kTurn);
      const Scalar most = std::floor((upper.coeff(i) - q.coeff(i)) / kTurn);
      const Scalar turns = std::round((start.coeff(i) - q.coeff(i)) / kTurn);
      result.coeffRef(i) = q.coeff(i) + kTurn * std::min(std::max(turns, least), most);
    });
    return clamp(result);
  }
};

/// Postures that fill the ranges of the joints evenly: Weyl's sequence, as spread_posture(). Scalar: one posture, or
/// one posture for each lane.
template <int N, typename Scalar>
class SpreadPostures {
 public:
  /// Joints without an end, and periodic joints with a longer range, have a range of one turn: around the start, or in
  /// the middle of the range. Idle joints stay at the start. offset: shifts the sequence.
  template <typename Ranges, typename Start>
  SpreadPostures(const Ranges& ranges, const Start& start, Number<Scalar> offset) noexcept
      : from_(filled<Vector<N, Scalar>>(start.size())), width_(from_), step_(from_), offset_(offset) {
    using One = Number<Scalar>;
    constexpr auto kTurn = static_cast<One>(kTwoPi);
    for (Eigen::Index i = 0; i < start.size(); ++i) {
      const One lower = ranges.lower.coeff(i);
      const One upper = ranges.upper.coeff(i);
      const bool idle = (ranges.idle & joint_bit(i)) != 0;
      const bool has_ends = std::isfinite(lower) && std::isfinite(upper);
      const bool turns = !has_ends || ((ranges.periodic & joint_bit(i)) != 0 && upper - lower > kTurn);
      const One width = idle ? One(0) : turns ? kTurn : upper - lower;
      const One middle = has_ends && !idle ? (lower + upper) / One(2) : start.coeff(i);
      width_.coeffRef(i) = Scalar(width);
      from_.coeffRef(i) = Scalar(std::max(std::min(middle - width / One(2), upper - width), lower));
      step_.coeffRef(i) = Scalar(std::sqrt(static_cast<One>(kPrimes[i])));
    }
  }

  /// The posture nearest to the target of kCandidates postures, the group with number k. Search: TipSearch.
  template <typename Search>
  [[nodiscard]] Vector<N, Scalar> nearest(const Search& search, const Scalar& k) const noexcept {
    const Scalar first = Scalar(Number<Scalar>(kCandidates)) * k;
    Vector<N, Scalar> best = (*this)(first);
    Scalar least = search.cost(best);
    for (int i = 1; i < kCandidates; ++i) {
      const Vector<N, Scalar> q = (*this)(first + Scalar(Number<Scalar>(i)));
      const Scalar cost = search.cost(q);
      const Mask<Scalar> better = cost < least;
      least = select(better, cost, least);
      best = entrywise(q, [&](Eigen::Index j) { return select(better, q.coeff(j), best.coeff(j)); });
    }
    return best;
  }

  /// Posture k.
  [[nodiscard]] Vector<N, Scalar> operator()(const Scalar& k) const noexcept {
    using std::floor;
    return entrywise(from_, [&](Eigen::Index i) {
      const Scalar multiple = (k + offset_) * step_.coeff(i);
      return Scalar(from_.coeff(i) + width_.coeff(i) * (multiple - floor(multiple)));
    });
  }

 private:
  static constexpr int kCandidates = 4;  ///< Range: 2 to 8, as for the values of Attempts.

  Vector<N, Scalar> from_;
  Vector<N, Scalar> width_;
  Vector<N, Scalar> step_;
  Scalar offset_;
};

template <int N, typename Scalar>
template <typename Difference>
void JointRanges<N, Scalar>::examine(const Difference& difference) noexcept {
  constexpr int kPostures = 3;
  constexpr Scalar kRoundOff = Scalar(1e3) * std::numeric_limits<Scalar>::epsilon();
  const auto origin = filled<Vector<N, Scalar>>(lower.size());
  const SpreadPostures<N, Scalar> spread(*this, origin, Scalar(0));
  for (Eigen::Index i = 0; i < origin.size(); ++i) {
    const auto changes_nothing = [&](Scalar displacement) noexcept {
      for (int k = 1; k <= kPostures; ++k) {
        const Vector<N, Scalar> q = spread(Scalar(k));
        Vector<N, Scalar> moved = q;
        moved.coeffRef(i) += displacement;
        if (!(difference(q, moved) <= kRoundOff)) return false;
      }
      return true;
    };
    if (changes_nothing(static_cast<Scalar>(kTwoPi))) periodic |= joint_bit(i);
    if (changes_nothing(Scalar(1))) idle |= joint_bit(i);
  }
}

}  // namespace fpbm
