#pragma once

#include <cmath>

#include "fpbm/core/level.hpp"
#include "fpbm/core/quickest_stop.hpp"
#include "fpbm/core/types.hpp"

namespace fpbm {

/// Bound on a joint's velocity toward one end of its range, −c + √(2d (end − q)) with an offset c and a deceleration d,
/// in coordinates that grow toward that end. It is zero at r = end − c²/2d.
///
/// With a small offset it is the speed from which the joint can still stop before r. With a maker's numbers it is a
/// bound on velocity that depends on position (Franka's "−0.30 + √(12 (2.75010 − q))").
///
/// In this form, (w + c)² ≤ 2d (end − q) is w (w/d + 2c/d) ≤ 2 (r − q): r − q keeps its digits near r, and no number
/// overflows where d is huge.
template <Level kLevel, typename Scalar>
struct VelocityEnvelope {
  Scalar rest;      ///< r, beyond which the joint does not go [rad] or [m]; infinite where there is no end.
  Scalar delay;     ///< c/d [s]
  Scalar softness;  ///< 1/d [s²/rad] or [s²/m]

  [[nodiscard]] bool allows(Scalar q, Scalar qd) const noexcept {
    return q <= rest && (qd <= Scalar(0) || qd * (qd * softness + Scalar(2) * delay) <= Scalar(2) * (rest - q));
  }

  /// Whether it allows all of a stop from a velocity v ≥ 0 at a constant deceleration b.
  ///
  /// With e = 2 (r − q) at the stop's end, v (v/d + 2c/d) ≤ 2 (r − q) is v² (1/b − 1/d) − 2 v c/d + e ≥ 0 all the way:
  /// at its start, and where the left side is least, at v = (c/d) / (1/b − 1/d), if the stop comes by there.
  [[nodiscard]] bool allows_stop(Scalar q, Scalar v, Scalar b) const noexcept {
    if (!(v > Scalar(0))) return q <= rest;
    const Scalar left = Scalar(2) * (rest - q) - v * v / b;  // e
    const Scalar bend = Scalar(1) / b - softness;
    return left >= Scalar(0) && allows(q, v) && (!(v * bend > delay) || left * bend >= delay * delay);
  }

  /// Largest velocity w⁺ after a tick of length h that the envelope allows at the position q⁺ reached by then: the root
  /// of w⁺ (w⁺/d + 2c/d) = 2 (r − q⁺), where q⁺ = q + h (w + w⁺)/2, or q + h w⁺ at velocity level.
  ///
  /// Its mirror image where that is negative, beyond r: there the joint has to return at the speed from which it can
  /// still stop at r. Not a number where there is no end.
  [[nodiscard]] Scalar furthest(Scalar q, [[maybe_unused]] Scalar w, Scalar h) const noexcept {
    using std::abs;
    using std::sqrt;
    Scalar way = Scalar(2) * (rest - q);
    Scalar late = delay + h;
    if constexpr (kLevel == Level::kAcceleration) {
      way -= h * w;
      late = delay + h / Scalar(2);
    }
    return way / (sqrt(late * late + abs(way) * softness) + late);
  }

  /// Greatest q̇²/2d + q̇ c/d + q − r, which the envelope keeps below 0, of a stop with jerk −J.
  ///
  /// from: a state's q − r, q̇ and acceleration. The greatest one is where the acceleration has come to −b = −d q̇/(q̇ +
  /// c): found by iteration, which contracts where J ≥ d²/c, and whose error counts in second order.
  [[nodiscard]] Scalar excess(Scalar jerk, const AxisState<Scalar>& from) const noexcept {
    const auto value = [this](const AxisState<Scalar>& at) {
      return at.v > Scalar(0) ? at.q + at.v * (delay + at.v * softness / Scalar(2)) : at.q;
    };
    const Scalar until = from.a / jerk;  // No acceleration is left.
    const Scalar top = from.v + from.a * until / Scalar(2);
    Scalar v = top;
    Scalar b = Scalar(0);
    for (int i = 0; i < 3 && v > Scalar(0); ++i) {
      b = v / (v * softness + delay);
      v = top - b * b / (Scalar(2) * jerk);
    }
    return from.a <= -b ? value(from) : value(from.ahead(until + b / jerk, -jerk));
  }
};

/// Envelopes of all joints toward one end of their ranges, in coordinates that grow toward it.
template <Level kLevel, int N, typename Scalar>
class VelocityEnvelopes {
 public:
  void resize(Eigen::Index n) {
    for (JointVector* row : {&rest_, &delay_, &softness_}) row->resize(n);
  }

  [[nodiscard]] VelocityEnvelope<kLevel, Scalar> operator[](Eigen::Index i) const noexcept {
    return {rest_.coeff(i), delay_.coeff(i), softness_.coeff(i)};
  }

  /// delay: c/d [s]. Infinite d: as hard as need be.
  void set(Eigen::Index i, Scalar rest, Scalar delay, Scalar deceleration) noexcept {
    rest_(i) = rest;
    delay_(i) = delay;
    softness_(i) = Scalar(1) / deceleration;
  }

 private:
  using JointVector = Vector<N, Scalar>;

  // A row for each number, so that vector code computes several joints at once.
  JointVector rest_;
  JointVector delay_;
  JointVector softness_;
};

}  // namespace fpbm
