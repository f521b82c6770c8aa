#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "fpbm/core/detail/quickest_stop.hpp"
#include "fpbm/core/detail/validation.hpp"
#include "fpbm/core/types.hpp"

namespace fpbm {

/// Checks whether a state is viable up to round-off, for Limits. last: accelerations of the last tick.
template <typename Limits_, int N, typename Scalar>
struct StateCheck {
  const Limits_& limits;
  const State<N, Scalar>& state;
  const Vector<N, Scalar>& last;

  [[nodiscard]] bool is_viable() const noexcept {
    for (Eigen::Index i = 0; i < state.q.size(); ++i) {
      if (violation(i) != Violation::kNone) return false;
    }
    return true;
  }

  /// Throws std::invalid_argument if an acceleration exceeds its bound.
  void require_accelerations() const {
    for (Eigen::Index i = 0; i < state.q.size(); ++i) {
      const Scalar most = limits.bounds().acceleration(i);
      if (!(std::abs(last(i)) <= most + velocity_rounding(i) / limits.tick())) {
        validation::fail(validation::element("qdd0", i), last(i), "within the joint's bound of ", most);
      }
    }
  }

  /// Throws std::invalid_argument if the state is not viable.
  void require_viable() const {
    require_accelerations();
    for (Eigen::Index i = 0; i < state.q.size(); ++i) {
      const Violation found = violation(i);
      const Scalar lower = limits.bounds().lower(i);
      const Scalar upper = limits.bounds().upper(i);
      if (found == Violation::kPosition) {
        validation::fail(
            validation::element("q0", i), state.q(i), "within the joint's range, from ", lower, " to ", upper,
            std::isfinite(limits.bounds().deceleration(i)) ? ", where the bound on velocity is positive" : "",
            degrees(state.q(i), lower, upper), kRecover);
      }
      if (found == Violation::kVelocity) {
        validation::fail(validation::element("qd0", i), state.qd(i),
                         "slow enough for the joint to stop within its bounds", kRecover);
      }
    }
  }

 private:
  enum class Violation { kNone, kPosition, kVelocity };

  /// First condition of a viable state that joint i violates.
  [[nodiscard]] Violation violation(Eigen::Index i) const noexcept {
    const Scalar q = inside(i);
    const Scalar slack = position_rounding(i);
    if (!(std::abs(state.q(i) - q) <= slack)) return Violation::kPosition;
    const Scalar qd = state.qd(i);
    const Scalar margin = velocity_rounding(i);
    // `last` is a difference of velocities over a tick, with the error of a velocity divided by h.
    const Scalar of_velocity = margin - slack / limits.tick();
    const AxisState<Scalar> error{slack, of_velocity, of_velocity / limits.tick()};
    const bool good = limits.bounds_jerk(i) ? limits.jerk_limited(i).viable({q, qd, last(i)}, error)
                                            : limits.allows(i, q, qd - std::clamp(qd, -margin, margin));
    return good ? Violation::kNone : Violation::kVelocity;
  }

  /// Position of joint i, moved into its range.
  [[nodiscard]] Scalar inside(Eigen::Index i) const noexcept {
    return std::clamp(state.q(i), limits.bounds().lower(i), limits.bounds().upper(i));
  }

  /// Round-off error of the position of joint i and of its distances to the ends of its range [rad] or [m]. A distance
  /// has an error of at most ε (|q| + |end|). The factor 16 also covers the updates of q and of the envelopes
  /// (SlowJoints.let_a_tracker_start_from_the_state_of_another).
  [[nodiscard]] Scalar position_rounding(Eigen::Index i) const noexcept {
    Scalar size = std::abs(inside(i));
    for (const Scalar end : {limits.bounds().lower(i), limits.bounds().upper(i)}) {
      if (std::isfinite(end)) size += std::abs(end);
    }
    return Scalar(16) * std::numeric_limits<Scalar>::epsilon() * size;
  }

  /// Round-off error of the velocity of joint i, which may be a difference of positions over a tick. A tick rounds
  /// q̇ + h a with an error of at most ε (|q̇| + h |a|). The factor 4 also covers the difference of two velocities from
  /// which `last` is computed.
  [[nodiscard]] Scalar velocity_rounding(Eigen::Index i) const noexcept {
    return position_rounding(i) / limits.tick() + Scalar(4) * std::numeric_limits<Scalar>::epsilon() *
                                                      (std::abs(state.qd(i)) + limits.tick() * std::abs(last(i)));
  }

  /// Remark for a position outside its range that would be within the range if it were in degrees.
  [[nodiscard]] static const char* degrees(Scalar q, Scalar lower, Scalar upper) noexcept {
    const Scalar converted = q * Scalar(3.14159265358979323846 / 180.0);
    const bool likely = std::abs(q) > Scalar(6.5) && lower <= converted && converted <= upper;
    return likely ? ": positions are in radians, and the value looks like degrees; multiply it by pi/180" : "";
  }
  static constexpr const char* kRecover = ", or give recover_start = true, with which the joint returns";
};

}  // namespace fpbm
