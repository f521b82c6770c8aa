#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "fpbm/core/validation.hpp"
#include "fpbm/task/point.hpp"
#include "fpbm/task/reference.hpp"
#include "fpbm/task/rounding_compensation.hpp"
#include "fpbm/task/stamp_clock.hpp"
#include "fpbm/task/streamed_target.hpp"
#include "fpbm/task/target_axes.hpp"
#include "fpbm/task/target_bounds.hpp"

namespace fpbm {

/// Makes a smooth reference of targets that come at any rate, late, twice, out of order or not at all.
///
/// Each axis of the base frame goes to the target in the least time within its bounds (TimeOptimalAxis), in the frame
/// of a target that moves: it does not overshoot one at rest, and does not lag behind one that moves evenly. The axes
/// of an orientation are those of the rotation vector to the target. From rest, or from a rotation about that vector,
/// the orientation turns about it (FixedAxis): its largest angle in the least time, the other two in proportion. A
/// target without news for a timeout stops as quickly as the bounds allow.
///
/// After construction nothing allocates, throws or loops without a bound, whatever is pushed, and no bound is exceeded.
template <typename Space, typename Scalar = double>
class TargetFilter {
 public:
  using Point = typename Space::template Point<Scalar>;
  using Twist = Vector<Space::kRows, Scalar>;

  /// At rest at x0 [m, rad]. Throws std::invalid_argument where it is no point, or a number is out of range.
  TargetFilter(const Point& x0, const TargetBounds<Scalar>& bounds, const TargetFilterOptions<Scalar>& options = {})
      : dt_(options.dt),
        timeout_(options.timeout),
        axes_(bounds),
        reference_(Reference<Space, Scalar>::hold(orthonormalised(x0))),
        clock_(options.dt, options.timeout, options.start),
        target_(reference_.x, options.dt / Scalar(2), options.timeout, axes_.fastest()) {
    options.require_good();
    if (!is_point(x0)) validation::reject("x0", ": must be finite, and its R a rotation");
  }

  /// A target [m, rad], seen at a time [s] on any clock. Its R becomes the nearest rotation. Returns false for a
  /// rejected message, which changes nothing: x is not a point (is_point), or the stamp is not finite, not newer than
  /// all before, or too far ahead (StampClock).
  bool push(const Point& x, double stamp) noexcept {
    if (!is_point(x)) return false;
    const std::optional<Scalar> elapsed = clock_.hear(stamp);
    if (elapsed) take(orthonormalised(x), *elapsed);
    return elapsed.has_value();
  }

  /// A target seen now.
  bool push(const Point& x) noexcept {
    if (!is_point(x)) return false;
    take(orthonormalised(x), clock_.hear_now());
    return true;
  }

  /// A velocity to go at [m/s, rad/s], as far as the bounds allow, until the timeout.
  bool push_twist(const Twist& v, double stamp) noexcept {
    if (!v.allFinite() || !clock_.hear(stamp)) return false;
    take(v);
    return true;
  }
  bool push_twist(const Twist& v) noexcept {
    if (!v.allFinite()) return false;
    (void)clock_.hear_now();
    take(v);
    return true;
  }

  /// The reference at the start of the coming tick.
  [[nodiscard]] const Reference<Space, Scalar>& reference() const noexcept { return reference_; }

  /// Some seconds into the coming tick.
  [[nodiscard]] Reference<Space, Scalar> ahead(Scalar seconds) const noexcept {
    return seconds == Scalar(0) ? reference_ : step(seconds).to;
  }

  [[nodiscard]] Scalar dt() const noexcept { return dt_; }

  /// Goes one tick on.
  void advance() noexcept {
    const Step next = step(dt_);
    compensation_.add(next.displacement, next.to.x, reference_.x);
    reference_ = next.to;
    clock_.advance();
    settle();
  }

  /// Starts anew, at rest at a point; a clock that was learnt is forgotten. Leaves all as it is where x is no point.
  bool reset(const Point& x) noexcept {
    if (!is_point(x)) return false;
    reference_ = Reference<Space, Scalar>::hold(orthonormalised(x));
    compensation_.clear();
    target_.rest_at(reference_.x);
    clock_.forget();
    free_ = false;
    return true;
  }

 private:
  /// The reference after some seconds, and the displacement to it [m, rad] before it is rounded.
  struct Step {
    Reference<Space, Scalar> to;
    Twist displacement;
  };

  [[nodiscard]] Step step(Scalar seconds) const noexcept {
    const auto& [x, xd, xdd] = reference_;
    if (free_) {
      const auto motion = axes_.change(xd, xdd, wanted_, seconds);
      return {{compensation_.displace(x, motion.displacement), motion.xd, motion.xdd}, motion.displacement};
    }
    const Twist error = compensation_.difference(target_.at(age()), x);
    const Twist velocity = axes_.within_bounds(clock_.rate() * target_.velocity());
    const auto motion = axes_.approach(xd, xdd, error, velocity, extent(x), seconds, dt_);
    // To the last bit, but for an angle in the plane, which may be whole turns away.
    const bool exact = motion.arrived && Space::kTurns != 1;
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
    wanted_ = axes_.within_bounds(v);
    settle();
  }

  /// Age of the target; one that was late already when it came is no older than one that has just become so.
  [[nodiscard]] Scalar age() const noexcept { return std::min(clock_.age(), timeout_ + dt_); }

  /// Lets a target come to rest that had no news for too long.
  void settle() noexcept {
    if (clock_.age() < timeout_) return;
    wanted_.setZero();
    if (!target_.streams()) return;
    const Point x = target_.at(age());
    const Twist velocity = target_.velocity();
    const Twist error = compensation_.difference(x, reference_.x);
    Twist way;
    bool in_step = !velocity.isZero(Scalar(0));
    for (int i = 0; i < Space::kRows; ++i) {
      const auto& stop = axes_(i).stop;
      way(i) = std::copysign(stop.way(std::abs(velocity(i))), velocity(i));
      const AxisState<Scalar> state{-error(i), reference_.xd(i) - velocity(i), reference_.xdd(i)};
      const Scalar change = stop.jerk * dt_ * dt_;
      const Scalar near = std::max(change * dt_, axes_(i).tolerance(state, extent(x), dt_));
      in_step = in_step && std::abs(state.v) <= change && std::abs(stop.rest(state)) <= near;
    }
    target_.rest_at(Space::template displace<Scalar>(x, way));
    free_ = free_ || in_step;  // Simply stops: turns about several axes at once would end a little elsewhere.
  }

  Scalar dt_;
  Scalar timeout_;
  TargetAxes<Space, Scalar> axes_;
  Reference<Space, Scalar> reference_;
  RoundingCompensation<Space, Scalar> compensation_;
  StampClock<Scalar> clock_;
  StreamedTarget<Space, Scalar> target_;
  bool free_ = false;  ///< Whether it goes at a velocity, to no point.
  Twist wanted_ = Twist::Zero();
};

}  // namespace fpbm
