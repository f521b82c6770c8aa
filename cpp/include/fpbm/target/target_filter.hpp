#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "fpbm/core/detail/validation.hpp"
#include "fpbm/path/detail/point.hpp"
#include "fpbm/path/detail/rounding_compensation.hpp"
#include "fpbm/path/reference.hpp"
#include "fpbm/target/detail/stamp_clock.hpp"
#include "fpbm/target/detail/streamed_target.hpp"
#include "fpbm/target/detail/target_axes.hpp"
#include "fpbm/target/detail/target_bounds.hpp"

namespace fpbm {

/// Smooth reference from targets that arrive at any rate, late, duplicate, out of order or not at all.
///
/// Each axis of the base frame moves to the target in minimum time within its bounds (TimeOptimalAxis), in the frame of
/// the moving target. The reference does not overshoot a target at rest, and has no lag behind a target with constant
/// velocity. The axes of an orientation are the three coordinates of the rotation vector to the target. From rest, or
/// from a rotation about the rotation vector to the target, the orientation rotates about this vector (FixedAxis). The
/// largest coordinate then becomes zero in minimum time, and the other two coordinates change in proportion. A target
/// without a message for a timeout stops in minimum time within the bounds.
///
/// For all pushed messages, no bound is exceeded, and after construction, no function allocates, throws or has an
/// unbounded loop.
template <typename Space, typename Scalar = double>
class TargetFilter {
 public:
  using Point = typename Space::template Point<Scalar>;
  using Twist = Vector<Space::kRows, Scalar>;

  /// Starts at rest at x0 [m, rad]. Throws std::invalid_argument if x0 is not a point, or a number is out of range.
  TargetFilter(const Point& x0, const TargetBounds<Scalar>& bounds, const TargetFilterOptions<Scalar>& options = {})
      : dt_(options.dt),
        timeout_(options.timeout),
        axes_(bounds, options.dt),
        reference_(Reference<Space, Scalar>::hold(orthonormalised(x0))),
        clock_(options.dt, options.timeout, options.start),
        target_(reference_.x, options.dt / Scalar(2), options.timeout, axes_.fastest()) {
    options.require_good();
    if (!is_point(x0)) validation::reject("x0", ": must be finite, with a rotation R");
  }

  /// Target [m, rad], observed at a time `stamp` [s] on any clock. R of x is replaced by the nearest rotation. Returns
  /// false for a rejected message, which has no effect: x is not a point (is_point), or the stamp is not finite, not
  /// newer than all stamps before, or too far ahead (StampClock).
  bool push(const Point& x, double stamp) noexcept {
    if (!is_point(x)) return false;
    const std::optional<Scalar> elapsed = clock_.accept(stamp);
    if (elapsed) take(orthonormalised(x), *elapsed);
    return elapsed.has_value();
  }

  /// Target observed at the current time.
  bool push(const Point& x) noexcept {
    if (!is_point(x)) return false;
    take(orthonormalised(x), clock_.hear_now());
    return true;
  }

  /// Desired velocity [m/s, rad/s], limited by the bounds, until the timeout. Returns false for a rejected message.
  bool push_twist(const Twist& v, double stamp) noexcept {
    if (!v.allFinite() || !clock_.accept(stamp)) return false;
    take(v);
    return true;
  }
  bool push_twist(const Twist& v) noexcept {
    if (!v.allFinite()) return false;
    (void)clock_.hear_now();
    take(v);
    return true;
  }

  /// Reduces the bounds on velocity to a fraction of the bounds of the constructor, until the next call. A faster
  /// reference decelerates within the bounds on acceleration and jerk. A faster target is followed with a lag. If the
  /// fraction is not in (0, 1], returns false without an effect.
  bool set_speed(Scalar fraction) noexcept {
    if (!(fraction > Scalar(0) && fraction <= Scalar(1))) return false;
    axes_.set_speed(fraction);
    return true;
  }
  /// The fraction of the last call of set_speed().
  [[nodiscard]] Scalar speed() const noexcept { return axes_.speed(); }

  /// The reference at the start of the coming tick.
  [[nodiscard]] const Reference<Space, Scalar>& reference() const noexcept { return reference_; }

  /// The reference `seconds` [s] after the start of the coming tick.
  [[nodiscard]] Reference<Space, Scalar> ahead(Scalar seconds) const noexcept {
    return seconds == Scalar(0) ? reference_ : step(seconds).to;
  }

  [[nodiscard]] Scalar dt() const noexcept { return dt_; }

  /// Advances by one tick.
  void advance() noexcept {
    const Step next = step(dt_);
    compensation_.add(next.displacement, next.to.x, reference_.x);
    reference_ = next.to;
    clock_.advance();
    settle();
  }

  /// Restarts at rest at x, with the same speed, and forgets an estimated clock. Returns false, without effect, if x is
  /// not a point.
  bool reset(const Point& x) noexcept {
    if (!is_point(x)) return false;
    reference_ = Reference<Space, Scalar>::hold(orthonormalised(x));
    compensation_.clear();
    target_.rest_at(reference_.x);
    clock_.reset();
    free_ = false;
    return true;
  }

 private:
  /// The reference after a time, and the displacement to this reference [m, rad] before rounding.
  struct Step {
    Reference<Space, Scalar> to;
    Twist displacement;
  };

  [[nodiscard]] Step step(Scalar seconds) const noexcept {
    const auto& [x, xd, xdd] = reference_;
    if (free_) {
      const auto motion = axes_.change(xd, xdd, axes_.within_bounds(wanted_), seconds);
      return {{compensation_.displace(x, motion.displacement), motion.xd, motion.xdd}, motion.displacement};
    }
    const Twist error = compensation_.difference(target_.at(age()), x);
    const Twist target_velocity = clock_.rate() * target_.velocity();
    const Twist velocity = axes_.within_bounds(target_velocity);
    const auto motion = axes_.approach(xd, xdd, error, velocity, extent(x), seconds, dt_);
    // Exactly the target, except for an angle in the plane, which may differ by full turns.
    const bool exact = motion.arrived && velocity == target_velocity && Space::kTurns != 1;
    return {{exact ? target_.at(age() + clock_.rate() * seconds) : compensation_.displace(x, motion.displacement),
             motion.xd, motion.xdd},
            motion.displacement};
  }

  void take(const Point& x, Scalar elapsed) noexcept {
    if (free_) target_.rest_at(x);
    free_ = false;
    target_.push(x, elapsed);
    settle();
  }
  void take(const Twist& v) noexcept {
    free_ = true;
    wanted_ = v;
    settle();
  }

  /// Age of the target [s]. A target that was too old on arrival is treated like a target that has just become too old.
  [[nodiscard]] Scalar age() const noexcept { return std::min(clock_.age(), timeout_ + dt_); }

  /// Stops a target without a message for a timeout.
  void settle() noexcept {
    if (clock_.age() < timeout_) return;
    wanted_.setZero();
    if (!target_.streams()) return;
    const Point x = target_.at(age());
    const Twist velocity = target_.velocity();
    const Twist error = compensation_.difference(x, reference_.x);
    Twist stopping_displacement;
    bool in_step = !velocity.isZero(Scalar(0));
    for (int i = 0; i < Space::kRows; ++i) {
      const auto stop = axes_(i).stop;
      stopping_displacement(i) = std::copysign(stop.stopping_distance(std::abs(velocity(i))), velocity(i));
      const AxisState<Scalar> state{-error(i), reference_.xd(i) - velocity(i), reference_.xdd(i)};
      const Scalar change = stop.jerk * dt_ * dt_;
      const Scalar near = std::max(change * dt_, axes_(i).tolerance(state, extent(x), dt_));
      in_step = in_step && std::abs(state.v) <= change && std::abs(stop.end_position(state)) <= near;
    }
    target_.rest_at(Space::template displace<Scalar>(x, stopping_displacement));
    free_ = free_ || in_step;  // Stop directly: rotations about several axes do not end exactly at the target.
  }

  Scalar dt_;
  Scalar timeout_;
  TargetAxes<Space, Scalar> axes_;
  Reference<Space, Scalar> reference_;
  RoundingCompensation<Space, Scalar> compensation_;
  StampClock<Scalar> clock_;
  StreamedTarget<Space, Scalar> target_;
  bool free_ = false;  ///< Whether the reference follows a velocity and not a point.
  Twist wanted_ = Twist::Zero();
};

}  // namespace fpbm
