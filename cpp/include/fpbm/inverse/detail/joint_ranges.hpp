#pragma once

#include <algorithm>
#include <cmath>

#include "fpbm/core/detail/mask.hpp"
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

  /// Posture k.
  [[nodiscard]] Vector<N, Scalar> operator()(const Scalar& k) const noexcept {
    using std::floor;
    return entrywise(from_, [&](Eigen::Index i) {
      const Scalar multiple = (k + offset_) * step_.coeff(i);
      return Scalar(from_.coeff(i) + width_.coeff(i) * (multiple - floor(multiple)));
    });
  }

 private:
  Vector<N, Scalar> from_;
  Vector<N, Scalar> width_;
  Vector<N, Scalar> step_;
  Scalar offset_;
};

}  // namespace fpbm
