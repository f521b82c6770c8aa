#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "fpbm/core/quickest_stop.hpp"
#include "fpbm/limits/limits.hpp"
#include "fpbm/limits/stop_profile.hpp"

namespace fpbm {

/// Where joints are over some time: displaced from where they were by s·way + t·tick + rest, with s and t rising from 0
/// to 1, and rest anywhere between low and high.
template <int N, typename Scalar = double>
struct Sweep {
  Vector<N, Scalar> way;
  Vector<N, Scalar> tick;
  Vector<N, Scalar> low;   ///< ≤ 0
  Vector<N, Scalar> high;  ///< ≥ 0
  /// Velocities at the start. s·way + t·tick is a sum of multiples of these and of −tick that are not negative.
  Vector<N, Scalar> begun;
};

/// A motion to rest from a viable state, known to its end: the arm's last resort.
///
/// Joints let go of their accelerations, then brake in proportion to one another, so that the arm stays close to the
/// straight line in joint space that it is on, in the time that the slowest of them needs. A joint that has to stop
/// sooner, to keep its bounds, takes its own quickest stop. All states on the way are viable.
template <Level kLevel, int N, typename Scalar = double>
class StopPlan {
 public:
  using JointVector = Vector<N, Scalar>;
  using JointLimits = Limits<kLevel, N, Scalar>;

  /// At rest.
  explicit StopPlan(Eigen::Index dof) : last_(JointVector::Zero(dof)), velocity_(JointVector::Zero(dof)) {}

  /// The plan from a viable state after a tick of acceleration last.
  StopPlan(const JointLimits& limits, const State<N, Scalar>& state, const JointVector& last) noexcept
      : last_(last), velocity_(state.qd) {
    const Scalar h = limits.tick();
    const auto& bounds = limits.bounds();
    for (Eigen::Index i = 0; i < last.size(); ++i) {
      using std::abs;
      using std::ceil;
      if (limits.bounds_jerk(i)) let_go_ = std::max(let_go_, ceil(abs(last(i)) / (h * bounds.jerk(i))));
    }
    velocity_ += h * gained() * last;
    for (Eigen::Index i = 0; i < last.size(); ++i) {
      profile_ =
          profile_.together(StopProfile<Scalar>::quickest(velocity_(i), bounds.acceleration(i), bounds.jerk(i), h));
    }
    profile_.wait = let_go_;
    for (Eigen::Index i = 0; i < last.size(); ++i) {
      if (!keeps_bounds(limits, i, state)) own_ |= joint_bit(i);
    }
  }

  /// Of an arm at rest.
  [[nodiscard]] Sweep<N, Scalar> sweep() const noexcept {
    return {velocity_, velocity_, velocity_, velocity_, velocity_};
  }

  /// The joints' places over a tick that leads to the plan's start, and over the plan.
  [[nodiscard]] Sweep<N, Scalar> sweep(const JointLimits& limits, const State<N, Scalar>& before,
                                       const State<N, Scalar>& start) const noexcept {
    using std::abs;
    const Eigen::Index n = last_.size();
    const Scalar h = limits.tick();
    const JointVector zero = JointVector::Zero(n);
    Sweep<N, Scalar> sweep{zero, zero, zero, zero, zero};
    const Scalar ticks = Scalar(1) + profile_.way(kLevel);
    // The tick's way less that at the velocity after letting go; and what is lost to that velocity while letting go.
    const Scalar lost = gained() + (kLevel == Level::kVelocity ? Scalar(0) : Scalar(0.5)) + late();
    for (Eigen::Index i = 0; i < n; ++i) {
      if (!is_own(i)) {
        sweep.way(i) = h * ticks * velocity_(i);
        sweep.tick(i) = -h * h * lost * last_(i);
        sweep.begun(i) = before.qd(i);
        continue;
      }
      const auto [low, high] = own_reach(limits, i, start.qd(i));
      const Scalar tick = start.q(i) - before.q(i);
      const Scalar between = kLevel == Level::kVelocity ? Scalar(0) : h * h / Scalar(8) * abs(last_(i));
      sweep.low(i) = std::min(tick, Scalar(0)) - between + low;
      sweep.high(i) = std::max(tick, Scalar(0)) + between + high;
    }
    return sweep;
  }

  /// Accelerations of its next tick, from the state it has come to; the plan goes on.
  [[nodiscard]] JointVector next(const JointLimits& limits, const State<N, Scalar>& state,
                                 const JointVector& before) noexcept {
    const Scalar h = limits.tick();
    JointVector u(before.size());
    for (Eigen::Index i = 0; i < u.size(); ++i) {
      if (is_own(i)) {
        u(i) = quickest(limits, i, state, before);
      } else if (k_ < let_go_) {
        u(i) = last_(i) * (Scalar(1) - (k_ + Scalar(1)) / let_go_);
      } else if (k_ + Scalar(1) < profile_.ticks()) {
        u(i) = -profile_.share(k_) * velocity_(i) / h;
      } else {
        u(i) = -state.qd(i) / h;  // To rest, exactly.
      }
    }
    k_ += Scalar(1);
    return u;
  }

  /// Way of the whole plan for each unit of velocity, in ticks.
  [[nodiscard]] Scalar average() const noexcept { return profile_.way(kLevel); }

  /// The same without rounding to whole ticks, about: a continuous function of the state.
  [[nodiscard]] Scalar smooth_average(const JointLimits& limits) const noexcept {
    using std::abs;
    Scalar most(0);
    for (Eigen::Index i = 0; i < velocity_.size(); ++i) {
      const Scalar speed = abs(velocity_(i));
      if (!(speed > Scalar(0))) continue;
      const Scalar deceleration = limits.bounds().acceleration(i);
      const Scalar way = limits.bounds_jerk(i) ? QuickestStop<Scalar>{deceleration, limits.bounds().jerk(i)}.way(speed)
                                               : speed * speed / (Scalar(2) * deceleration);
      most = std::max(most, way / (limits.tick() * speed));
    }
    return profile_.wait + most;
  }

  /// Ticks of an acceleration that a velocity gains before it can be let go, that of the tick included.
  [[nodiscard]] static Scalar latency(const JointLimits& limits) noexcept {
    using std::ceil;
    Scalar most(0);
    for (Eigen::Index i = 0; i < limits.bounds().jerk.size(); ++i) {
      if (!limits.bounds_jerk(i)) continue;
      most = std::max(most, ceil(limits.bounds().acceleration(i) / (limits.tick() * limits.bounds().jerk(i))));
    }
    return Scalar(1) + std::max(most - Scalar(1), Scalar(0)) / Scalar(2);
  }

  /// Ticks until rest.
  [[nodiscard]] Scalar ticks_left() const noexcept { return std::max(profile_.ticks() - k_, Scalar(0)); }

 private:
  [[nodiscard]] bool is_own(Eigen::Index i) const noexcept { return (own_ >> i & 1U) != 0; }

  /// Velocity that is gained while an acceleration is let go, over h times that: Σ 1 − (k + 1)/r for k < r.
  [[nodiscard]] Scalar gained() const noexcept { return std::max(let_go_ - Scalar(1), Scalar(0)) / Scalar(2); }

  /// What is missing in the way meanwhile, next to that at the velocity afterwards, over h² times the acceleration.
  [[nodiscard]] Scalar late() const noexcept {
    const Scalar r = std::max(let_go_, Scalar(1));
    return kLevel == Level::kVelocity ? std::max((r - Scalar(1)) * (r - Scalar(2)) / Scalar(6), Scalar(0))
                                      : (r - Scalar(1)) * (Scalar(2) * r - Scalar(1)) / Scalar(12);
  }

  /// Whether joint i keeps its bounds in the common stop. That is no faster, and no farther, than one that coasts at
  /// the greatest velocity until the deceleration is reached, and then keeps that to the end.
  [[nodiscard]] bool keeps_bounds(const JointLimits& limits, Eigen::Index i,
                                  const State<N, Scalar>& start) const noexcept {
    using std::abs;
    const Scalar left = velocity_(i);
    const Scalar v = start.qd(i) * left > left * left ? start.qd(i) : left;
    if (!(abs(v) <= limits.bounds().velocity(i))) return false;
    const Scalar h = limits.tick();
    const Scalar coasts = h * (let_go_ + profile_.ramp - Scalar(1));
    const Scalar deceleration = abs(left) / (h * (profile_.brake - profile_.ramp + Scalar(1)));
    return limits.allows_stop(i, start.q(i) + coasts * v, v, deceleration);
  }

  /// Acceleration of the next tick on joint i's own quickest way to rest.
  [[nodiscard]] static Scalar quickest(const JointLimits& limits, Eigen::Index i, const State<N, Scalar>& state,
                                       const JointVector& before) noexcept {
    const Scalar most = limits.bounds().acceleration(i);
    if (!limits.bounds_jerk(i)) return std::clamp(-state.qd(i) / limits.tick(), -most, most);
    const auto joint = limits.jerk_limited(i);
    const auto [low, high] = joint.viable(joint.after(before(i)), state.q(i), state.qd(i));
    return std::clamp(joint.brake(state.qd(i), before(i)), low, high);
  }

  /// Bounds on the displacement over joint i's own quickest stop.
  [[nodiscard]] Interval<Scalar> own_reach(const JointLimits& limits, Eigen::Index i, Scalar qd) const noexcept {
    using std::abs;
    const Scalar h = limits.tick();
    const Scalar most = limits.bounds().acceleration(i);
    if (!limits.bounds_jerk(i)) {
      const Scalar way = abs(qd) * (abs(qd) / most + h) / Scalar(2);
      return qd > Scalar(0) ? Interval<Scalar>{Scalar(0), way} : Interval<Scalar>{-way, Scalar(0)};
    }
    // At no time faster than top, which is left for its quickest stop once the acceleration has been let go.
    const Scalar jerk = limits.bounds().jerk(i);
    const Scalar lost = abs(last_(i)) / jerk;
    const Scalar top = abs(qd) + abs(last_(i)) * lost / Scalar(2);
    const Scalar way = top * (lost + Scalar(2) * h) + QuickestStop<Scalar>{most, jerk}.way(top);
    const bool forth = qd > Scalar(0) && velocity_(i) >= Scalar(0);
    const bool back = qd < Scalar(0) && velocity_(i) <= Scalar(0);
    return {forth ? Scalar(0) : -way, back ? Scalar(0) : way};
  }

  StopProfile<Scalar> profile_;
  JointVector last_;           ///< Acceleration of the tick before the plan.
  Scalar let_go_ = Scalar(0);  ///< Ticks in which it is let go: none where no jerk is bounded.
  JointVector velocity_;       ///< Velocity afterwards.
  JointBits own_ = 0;          ///< Bit i is set where joint i takes its own quickest stop.
  Scalar k_ = Scalar(0);       ///< Ticks done.
};

}  // namespace fpbm
