#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "fpbm/core/detail/validation.hpp"
#include "fpbm/path/detail/point.hpp"
#include "fpbm/path/detail/rounding_compensation.hpp"
#include "fpbm/path/reference.hpp"
#include "fpbm/target/detail/scheduled_target.hpp"
#include "fpbm/target/detail/stamp_clock.hpp"
#include "fpbm/target/detail/target_axes.hpp"
#include "fpbm/target/detail/target_bounds.hpp"

namespace fpbm {

/// Smooth reference from chunks of future points, for example of a policy, and from points that arrive one by one
/// (docs/streams.md). Chunks may be late, early, overlapping, duplicate, out of order, or not arrive at all.
///
/// A chunk replaces all points from its first point on. Between points, the target moves along polynomials of degree 5
/// (ChunkPiece). The reference joins the target within its bounds (JoiningAxis): after a jump of the target in minimum
/// time, without overshoot. At the end of the last chunk, the reference is at rest at the last point.
///
/// For all pushed points, no bound is exceeded, and after construction, no function allocates or throws. Space: Pose,
/// Position, PlanarPose, or JointSpace<N> (JointStream). kPoints: largest number of points of a chunk, and of points
/// that wait before a chunk.
template <typename Space, typename Scalar = double, int kPoints = 128>
class Stream {
 public:
  using Point = typename Space::template Point<Scalar>;
  using Twist = Vector<Space::kRows, Scalar>;
  using Bounds = typename AxesOf<Space, Scalar>::Bounds;
  using Timed = TimedPoint<Space, Scalar>;

  /// Starts at rest at x0 [m, rad]. bounds: TargetBounds, or JointLimits of a JointStream, with finite velocities and
  /// accelerations. Throws std::invalid_argument if x0 is not a point within its range, or a number is out of range.
  Stream(const Point& x0, const Bounds& bounds, const StreamOptions<Scalar>& options = {})
      : options_(options),
        axes_(bounds, options.dt),
        reference_(Reference<Space, Scalar>::hold(orthonormalised(x0))),
        clock_(options.dt, options.timeout, options.start) {
    options.require_good();
    if (!is_point(x0)) validation::reject("x0", ": must be finite, with a rotation R");
    for (int i = 0; i < Axes::kLengths; ++i) {
      const auto [low, high] = axes_.range(i);
      const Scalar x = coordinate(x0, i);
      if (!(low <= x && x <= high)) validation::fail(validation::element("x0", i), x, "from ", low, " to ", high);
    }
    schedule_.hold(reference_.x);
  }

  /// Chunk of `count` points at increasing times after `stamp` [s], on any clock; default: the current time. Points
  /// whose time has passed have no effect. Returns false for a rejected chunk, which has no effect: a point is not
  /// usable (is_usable()), a number is not finite, the times do not increase, there are more than kPoints points, or
  /// the stamp is not newer than all stamps before, or too far ahead (StampClock).
  bool push_chunk(const Timed* points, int count, std::optional<double> stamp = {}) noexcept {
    return is_chunk(points, count) && heard(stamp) &&
           schedule_.continue_with(
               points, count, [this](const Point& x) noexcept { return usable(x); }, clock_.age(), options_.blend);
  }

  /// Point observed at a time `stamp` [s]; default: the current time. The reference passes the point options.delay
  /// later, and continues after the newest point at constant velocity until the timeout. Returns false for a rejected
  /// point, as push_chunk().
  bool push(const Point& x, std::optional<double> stamp = {}) noexcept {
    return is_usable(x) && heard(stamp) && schedule_.extend(options_.delay, usable(x), clock_.age());
  }

  /// Whether a point is finite, with a rotation R, and at most a tenth of the width of a joint's range outside this
  /// range. Joints outside their range move to the end of the range. A larger distance is a mistake, such as degrees.
  [[nodiscard]] bool is_usable(const Point& x) const noexcept {
    if (!is_point(x)) return false;
    for (int i = 0; i < Axes::kLengths; ++i) {
      const auto [low, high] = axes_.range(i);
      const Scalar beyond = std::max(low - coordinate(x, i), coordinate(x, i) - high);
      if (beyond > Scalar(0) && !(beyond <= kOutside * (high - low))) return false;
    }
    return true;
  }

  [[nodiscard]] Range<Scalar> range(int i) const noexcept { return axes_.range(i); }
  /// Reduces the bounds on velocity to a fraction of the bounds of the constructor, until the next call. A faster
  /// target is followed with a lag. If the fraction is not in (0, 1], returns false without an effect.
  bool set_speed(Scalar fraction) noexcept {
    if (!(fraction > Scalar(0) && fraction <= Scalar(1))) return false;
    axes_.set_speed(fraction);
    return true;
  }
  [[nodiscard]] Scalar speed() const noexcept { return axes_.speed(); }

  /// The reference at the start of the coming tick, and `seconds` [s] later.
  [[nodiscard]] const Reference<Space, Scalar>& reference() const noexcept { return reference_; }
  [[nodiscard]] Reference<Space, Scalar> ahead(Scalar seconds) const noexcept {
    return seconds == Scalar(0) ? reference_ : step(seconds).to;
  }
  [[nodiscard]] Scalar dt() const noexcept { return options_.dt; }
  /// Time since the newest stamp [s], and displacement from the reference to the target [m, rad].
  [[nodiscard]] Scalar age() const noexcept { return clock_.age(); }
  [[nodiscard]] Twist gap() const noexcept { return compensation_.difference(target().x, reference_.x); }

  /// Advances by one tick.
  void advance() noexcept {
    const Step next = step(options_.dt);
    compensation_.add(next.displacement, next.to.x, reference_.x);
    reference_ = next.to;
    clock_.advance();
    if (schedule_.continues() && clock_.age() > schedule_.end_time() + options_.timeout) stop();
  }

  /// Restarts at rest at x, with the same speed, and forgets all chunks and an estimated clock. Returns false, without
  /// effect, if x is not a usable point.
  bool reset(const Point& x) noexcept {
    if (!is_usable(x)) return false;
    reference_ = Reference<Space, Scalar>::hold(usable(x));
    compensation_.clear();
    schedule_.hold(reference_.x);
    clock_.reset();
    return true;
  }

 private:
  using Axes = AxesOf<Space, Scalar>;
  /// Largest part of the width of a joint's range by which a point may be outside of the range: a choice.
  static constexpr Scalar kOutside = Scalar(0.1);

  /// The reference after a time, and the displacement to this reference [m, rad] before rounding.
  struct Step {
    Reference<Space, Scalar> to;
    Twist displacement;
  };

  /// The target `seconds` [s] later in the tick.
  [[nodiscard]] Reference<Space, Scalar> target(Scalar seconds = Scalar(0)) const noexcept {
    const Scalar now = clock_.age();
    return schedule_.at(schedule_.active(now), now + clock_.rate() * seconds);
  }

  [[nodiscard]] Step step(Scalar seconds) const noexcept {
    const auto motion = axes_.join(reference_, gap(), schedule_, clock_.age(), clock_.rate(), extent(reference_.x),
                                   seconds, options_.dt);
    const bool exact = motion.arrived && Space::kTurns != 1;  // An angle in the plane may differ by full turns.
    return {
        {exact ? target(seconds).x : compensation_.displace(reference_.x, motion.displacement), motion.xd, motion.xdd},
        motion.displacement};
  }

  [[nodiscard]] bool is_chunk(const Timed* points, int count) const noexcept {
    if (count < 1 || count > kPoints) return false;
    for (int k = 0; k < count; ++k) {
      const auto& [time, x, xd, xdd] = points[k];
      if (!std::isfinite(time) || (k > 0 && !(time > points[k - 1].time)) || !is_usable(x)) return false;
      if ((xd && !xd->allFinite()) || (xdd && !xdd->allFinite())) return false;
    }
    return true;
  }

  /// The point with its joints in their ranges, and with the nearest rotation.
  [[nodiscard]] Point usable(const Point& x) const noexcept {
    Point point = orthonormalised(x);
    if constexpr (kIsJointSpace<Space>) {
      for (int i = 0; i < Axes::kLengths; ++i) point(i) = axes_.range(i).nearest(point(i));
    }
    return point;
  }

  /// Processes a stamp; no stamp: the current time. Returns whether the stamp is accepted.
  [[nodiscard]] bool heard(std::optional<double> stamp) noexcept {
    const std::optional<Scalar> elapsed = stamp ? clock_.accept(*stamp) : clock_.hear_now();
    if (elapsed) schedule_.shift(*elapsed, clock_.age());
    return elapsed.has_value();
  }

  /// The target stops in minimum time.
  void stop() noexcept {
    const Reference<Space, Scalar> last = target();
    Twist displacement = last.xd;
    for (int i = 0; i < Space::kRows; ++i) {
      displacement(i) = std::copysign(axes_(i).stop.stopping_distance(std::abs(last.xd(i))), last.xd(i));
    }
    schedule_.hold(usable(Space::template displace<Scalar>(last.x, displacement)));
  }

  StreamOptions<Scalar> options_;
  TargetAxes<Space, Scalar> axes_;
  Reference<Space, Scalar> reference_;
  RoundingCompensation<Space, Scalar> compensation_;
  StampClock<Scalar> clock_;
  ScheduledTarget<Space, Scalar, 2 * kPoints> schedule_;
};

/// Stream of joint positions, within the limits of the joints (Stream). Without a bound on jerk, an acceleration may
/// change by any amount within a tick.
template <int N, typename Scalar = double, int kPoints = 128>
using JointStream = Stream<JointSpace<N>, Scalar, kPoints>;

}  // namespace fpbm
