#pragma once

#include <cmath>

#include "fpbm/core/level.hpp"
#include "fpbm/core/types.hpp"

namespace fpbm {

/// Bound on a joint's velocity toward one end of its range: −offset + √(2 deceleration |end − q|).
///
/// With a small offset it is the speed from which the joint can still stop before the end. With a maker's numbers it is
/// a bound on velocity that depends on position (for Franka's "−0.30 + √(12 (2.75010 − q))": {2.75010, 0.30, 6}).
template <typename Scalar = double>
struct VelocityEnvelope {
  Scalar end;           ///< [rad] or [m]
  Scalar offset;        ///< [rad/s] or [m/s]
  Scalar deceleration;  ///< [rad/s²] or [m/s²]
};

/// Envelopes of all joints toward one end of their ranges, in coordinates that grow toward it.
template <Level kLevel, int N, typename Scalar>
class VelocityEnvelopes {
 public:
  void resize(Eigen::Index n) {
    for (JointVector* row : {&end_, &offset_, &deceleration_, &rest_}) row->resize(n);
  }

  /// rest: position where the envelope is zero; the joint goes no farther.
  void set(Eigen::Index i, const VelocityEnvelope<Scalar>& envelope, Scalar rest) noexcept {
    end_(i) = envelope.end;
    offset_(i) = envelope.offset;
    deceleration_(i) = envelope.deceleration;
    rest_(i) = rest;
  }

  [[nodiscard]] bool allows(Eigen::Index i, Scalar q, Scalar qd) const noexcept {
    const Scalar p = qd + offset_(i);
    // At rest the envelope holds wherever q is; computed, end − q may have lost the digits that say so.
    return q <= rest_(i) && (qd <= Scalar(0) || p * p <= Scalar(2) * deceleration_(i) * (end_(i) - q));
  }

  /// Largest velocity w⁺ after a tick of length h that the envelope allows at the position q⁺ reached by then: the root
  /// of (w⁺ + c)² = 2d (end − q⁺), where q⁺ = q + h (w + w⁺)/2, or q + h w⁺ at velocity level.
  [[nodiscard]] Scalar furthest(Eigen::Index i, Scalar q, [[maybe_unused]] Scalar w, Scalar h) const noexcept {
    using std::sqrt;
    const Scalar c = offset_(i);
    const Scalar d = deceleration_(i);
    const Scalar way = end_(i) - q;
    Scalar lag = d * h;
    Scalar square = Scalar(2) * d * (way + h * c);
    if constexpr (kLevel == Level::kAcceleration) {
      lag = d * h / Scalar(2);
      square = d * (Scalar(2) * way + h * (c - w));
    }
    square += lag * lag;
    return sqrt(square > Scalar(0) ? square : Scalar(0)) - lag - c;
  }

 private:
  using JointVector = Vector<N, Scalar>;

  JointVector end_;
  JointVector offset_;
  JointVector deceleration_;
  JointVector rest_;
};

}  // namespace fpbm
