#pragma once

#include <cmath>
#include <limits>

#include "fpbm/core/detail/quickest_stop.hpp"
#include "fpbm/core/types.hpp"

namespace fpbm {

/// Braking envelope: bound on a joint's velocity toward one end of its range, −c + √(2d (end − q)) with an offset c and
/// a deceleration d, in coordinates that increase toward this end. The envelope is zero at r = end − c²/2d
/// (docs/tick.md, Position, velocity and acceleration).
///
/// With a small offset, the envelope is the velocity from which the joint can still stop before r. An envelope of a
/// manufacturer is a bound on velocity that depends on position (Franka's "−0.30 + √(12 (2.75010 − q))").
///
/// The code uses (w + c)² ≤ 2d (end − q) in the form w (w/d + 2c/d) ≤ 2 (r − q): r − q keeps its digits near r, and no
/// number overflows if d is very large.
template <Level kLevel, typename Scalar>
struct VelocityEnvelope {
  Scalar stop_position;  ///< r, largest admissible position [rad] or [m]; infinite if there is no end.
  Scalar delay;          ///< c/d [s]
  Scalar softness;       ///< 1/d [s²/rad] or [s²/m]

  [[nodiscard]] bool allows(Scalar q, Scalar qd) const noexcept {
    return q <= stop_position &&
           (qd <= Scalar(0) || qd * (qd * softness + Scalar(2) * delay) <= Scalar(2) * (stop_position - q));
  }

  /// Whether the envelope admits the whole stop from a velocity v ≥ 0 at a constant deceleration b.
  ///
  /// With e = 2 (r − q) at the end of the stop, v (v/d + 2c/d) ≤ 2 (r − q) is v² (1/b − 1/d) − 2 v c/d + e ≥ 0. This
  /// inequality holds for all velocities of the stop under two conditions: it holds at the start of the stop, and at
  /// the minimum of the left side, v = (c/d)/(1/b − 1/d), if the stop passes this velocity.
  [[nodiscard]] bool allows_stop(Scalar q, Scalar v, Scalar b) const noexcept {
    if (!(v > Scalar(0))) return q <= stop_position;
    const Scalar left = Scalar(2) * (stop_position - q) - v * v / b;  // e
    const Scalar extra_softness = Scalar(1) / b - softness;
    return left >= Scalar(0) && allows(q, v) &&
           (!(v * extra_softness > delay) || left * extra_softness >= delay * delay);
  }

  /// Largest velocity w⁺ after a tick of length h that the envelope admits at the position q⁺ after the tick: the root
  /// of w⁺ (w⁺/d + 2c/d) = 2 (r − q⁺), where q⁺ = q + h (w + w⁺)/2, or q + h w⁺ at velocity level (docs/tick.md,
  /// Position, velocity and acceleration).
  ///
  /// Beyond r, the mirrored law applies: w⁺ is negative, and −w⁺ is the velocity from which the joint can still stop at
  /// r. NaN if there is no end.
  [[nodiscard]] Scalar largest_velocity(Scalar q, [[maybe_unused]] Scalar w, Scalar h) const noexcept {
    using std::abs;
    using std::sqrt;
    Scalar twice_distance = Scalar(2) * (stop_position - q);
    Scalar lag = delay + h;
    if constexpr (kLevel == Level::kAcceleration) {
      twice_distance -= h * w;
      lag = delay + h / Scalar(2);
    }
    return twice_distance / (sqrt(lag * lag + abs(twice_distance) * softness) + lag);
  }

  /// Largest G = q̇²/2d + q̇ c/d + q − r of a stop with the jerk −J (docs/tick.md, Bounds on jerk). G ≤ 0 within the
  /// envelope.
  ///
  /// from: q − r, q̇ and the acceleration of a state. G is largest at the acceleration −b = −d q̇/(q̇ + c). If J ≥ d²/c,
  /// each iteration divides the error of b by 27/4 or more, since d²c q̇/(J (q̇ + c)³) ≤ 4/27. An error of b changes G in
  /// second order only. Therefore, G is too small by at most 3.4e-7 c²/d after kIterations.
  [[nodiscard]] Scalar excess(Scalar jerk, const AxisState<Scalar>& from) const noexcept {
    const auto value = [this](const AxisState<Scalar>& at) {
      return at.v > Scalar(0) ? at.q + at.v * (delay + at.v * softness / Scalar(2)) : at.q;
    };
    const Scalar until = from.a / jerk;  // Time until the acceleration is zero.
    const Scalar top = from.v + from.a * until / Scalar(2);
    Scalar v = top;
    Scalar b = Scalar(0);
    constexpr int kIterations = 3;
    for (int i = 0; i < kIterations && v > Scalar(0); ++i) {
      b = v / (v * softness + delay);
      v = top - b * b / (Scalar(2) * jerk);
    }
    return from.a <= -b ? value(from) : value(from.ahead(until + b / jerk, -jerk));
  }

  /// Upper bound on the excess that a stop adds to q − r [rad] or [m]: v (t + c/d + v/2d) for velocities up to
  /// v = fastest [rad/s], if G is largest within the time t = longest [s].
  [[nodiscard]] Scalar excess_bound(Scalar fastest, Scalar longest) const noexcept {
    return fastest * (longest + delay + fastest * softness / Scalar(2));
  }

  /// Round-off error of G at the position q [rad] or [m]. The distance to the end has an error of at most ε (|q| +
  /// |r|). The factor 8 also covers the other terms of G.
  [[nodiscard]] Scalar round_off(Scalar q) const noexcept {
    return std::isfinite(stop_position)
               ? Scalar(8) * std::numeric_limits<Scalar>::epsilon() * (std::abs(q) + std::abs(stop_position))
               : Scalar(0);
  }
};

/// Envelopes of all joints toward one end of their ranges, in coordinates that increase toward this end.
template <Level kLevel, int N, typename Scalar>
class VelocityEnvelopes {
 public:
  void resize(Eigen::Index n) {
    for (JointVector* row : {&stop_position_, &delay_, &softness_}) row->resize(n);
  }

  [[nodiscard]] VelocityEnvelope<kLevel, Scalar> operator[](Eigen::Index i) const noexcept {
    return {stop_position_.coeff(i), delay_.coeff(i), softness_.coeff(i)};
  }

  /// delay: c/d [s]. Infinite deceleration: the deceleration is not limited.
  void set(Eigen::Index i, Scalar stop_position, Scalar delay, Scalar deceleration) noexcept {
    stop_position_(i) = stop_position;
    delay_(i) = delay;
    softness_(i) = Scalar(1) / deceleration;
  }

 private:
  using JointVector = Vector<N, Scalar>;

  // A vector for each member, so that the compiler vectorises over the joints.
  JointVector stop_position_;
  JointVector delay_;
  JointVector softness_;
};

}  // namespace fpbm
