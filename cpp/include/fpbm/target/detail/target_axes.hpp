#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

#include "fpbm/core/types.hpp"
#include "fpbm/path/detail/fixed_axis.hpp"
#include "fpbm/path/detail/time_optimal_axis.hpp"
#include "fpbm/path/reference.hpp"
#include "fpbm/target/detail/chunk_piece.hpp"
#include "fpbm/target/detail/joining_axis.hpp"
#include "fpbm/target/detail/target_bounds.hpp"

namespace fpbm {

/// Motion along all axes of the base frame within bounds: time-optimal for each axis, and about a fixed axis for an
/// orientation if possible.
template <typename Space, typename Scalar>
class TargetAxes {
 public:
  using Axis = TimeOptimalAxis<Scalar>;
  using Axes = AxesOf<Space, Scalar>;
  using Moving = Reference<Space, Scalar>;
  using Twist = Vector<Space::kRows, Scalar>;

  /// Displacement [m, rad], velocity and acceleration after a time.
  struct Motion {
    Twist displacement;
    Twist xd;
    Twist xdd;
    bool arrived = false;  ///< Whether all axes rest on the target, or move with the target.

    void set(int i, const AxisState<Scalar>& axis) noexcept {
      displacement(i) = axis.q;
      xd(i) = axis.v;
      xdd(i) = axis.a;
    }
  };

  /// Throws std::invalid_argument if a bound is not positive and finite.
  TargetAxes(const typename Axes::Bounds& bounds, Scalar dt) : axes_(bounds, dt) {}

  /// Fraction of the velocity bounds that the motion uses, in (0, 1].
  void set_speed(Scalar fraction) noexcept { speed_ = fraction; }
  [[nodiscard]] Scalar speed() const noexcept { return speed_; }

  [[nodiscard]] Axis operator()(int i) const noexcept {
    Axis axis = axes_(i);
    axis.velocity *= speed_;
    return axis;
  }

  /// Range of coordinate i.
  [[nodiscard]] Range<Scalar> range(int i) const noexcept { return axes_.range(i); }

  [[nodiscard]] Twist fastest() const noexcept {
    Twist result;
    for (int i = 0; i < Space::kRows; ++i) result(i) = (*this)(i).velocity;
    return result;
  }
  [[nodiscard]] Twist within_bounds(const Twist& v) const noexcept {
    return v.cwiseMax(-fastest()).cwiseMin(fastest());
  }

  /// Motion after `seconds` [s] from xd, xdd toward a velocity.
  [[nodiscard]] Motion change(const Twist& xd, const Twist& xdd, const Twist& velocity, Scalar seconds) const noexcept {
    Motion motion;
    for (int i = 0; i < Space::kRows; ++i) {
      motion.set(i, (*this)(i).change({Scalar(0), xd(i), xdd(i)}, velocity(i), seconds));
    }
    return motion;
  }

  /// Motion after `seconds` [s] from xd, xdd toward a target at the displacement `error`, which moves at `velocity`.
  /// size: largest coordinate of the target, for the round-off error. h: length of a tick [s].
  [[nodiscard]] Motion approach(const Twist& xd, const Twist& xdd, const Twist& error, const Twist& velocity,
                                Scalar size, Scalar seconds, Scalar h) const noexcept {
    Motion motion;
    motion.arrived = true;
    const auto approach_one = [&](int i) noexcept {
      const Scalar v = velocity(i);
      if (error(i) == Scalar(0) && xd(i) == v && xdd(i) == Scalar(0)) return AxisState<Scalar>{error(i), {}, {}};
      const AxisState<Scalar> state{Scalar(0), xd(i) - v, xdd(i)};
      const Axis axis = (*this)(i);
      const AxisState<Scalar> to = axis.approach(state, error(i), v, seconds, axis.tolerance(state, size, h));
      motion.arrived = motion.arrived && to.q == error(i) && to.v == Scalar(0) && to.a == Scalar(0);
      return to;
    };
    const std::optional<FixedAxis<Scalar>> fixed = turns_about(xd, xdd, error, velocity);
    for (int i = 0; i < (fixed ? kLengths : Space::kRows); ++i) {
      const AxisState<Scalar> to = approach_one(i);
      motion.set(i, {to.q + seconds * velocity(i), to.v + velocity(i), to.a});
    }
    if constexpr (kRotates) {
      if (!fixed) return motion;
      const AxisState<Scalar> to = approach_one(kLengths + static_cast<int>(fixed->largest));
      motion.displacement.template tail<3>() = to.q * fixed->angles;
      motion.xd.template tail<3>() = to.v * fixed->motion;
      motion.xdd.template tail<3>() = to.a * fixed->motion;
    }
    return motion;
  }

  /// Motion after `seconds` [s] that joins a target within the bounds. from: the reference. schedule: the motion of the
  /// target. now: the time at the start of the tick. rate: of the clock of the schedule.
  template <typename Schedule>
  [[nodiscard]] Motion join(const Moving& from, const Twist& error, const Schedule& schedule, Scalar now, Scalar rate,
                            Scalar size, Scalar seconds, Scalar h) const noexcept {
    const std::size_t piece = schedule.active(now);
    const auto moving = [&](Scalar t) noexcept { return schedule.at(piece, now + rate * t); };
    const Moving start = moving(Scalar(0));
    const Moving end = moving(h);
    const Moving then = seconds == h ? end : moving(seconds);
    const Twist to_end = Space::template difference<Scalar>(end.x, start.x);
    const Twist to_then = Space::template difference<Scalar>(then.x, start.x);
    Motion motion;
    motion.arrived = true;
    for (int i = 0; i < Space::kRows; ++i) {
      const auto at = [&](const Moving& state, Scalar q) noexcept {
        return AxisState<Scalar>{q, rate * state.xd(i), rate * rate * state.xdd(i)};
      };
      if (rests(from, i) && rests(start, i) && rests(end, i) && error(i) == Scalar(0) && to_end(i) == Scalar(0)) {
        motion.set(i, {});  // For example, an unused joint of a stream for any number of joints.
        continue;
      }
      const MovingAxis<Scalar> target{at(start, Scalar(0)), at(end, to_end(i)), at(then, to_then(i)),
                                      rate * rate * rate * schedule.largest_jerk(piece, now + h, i)};
      const AxisState<Scalar> own{Scalar(0), from.xd(i), from.xdd(i)};
      const Axis axis = (*this)(i);
      // Targets of any velocity must not increase the tolerance.
      const AxisState<Scalar> relative{Scalar(0), own.v - axis.nearest_velocity(target.start.v), own.a};
      Range<Scalar> ends = axes_.range(i);
      Range<Scalar> range = ends;
      if (i < kLengths) {
        const Scalar x = coordinate(from.x, i);
        if (!schedule.continues()) range = schedule.range_after(piece, start.x, i).within(ends);
        const Scalar round_off = Scalar(8) * std::numeric_limits<Scalar>::epsilon() * size;
        ends = {ends.low - x - round_off, ends.high - x + round_off};
        range = range.from(x);
      }
      const JoiningAxis<Scalar> joining{
          axis, axes_.envelope(i), ends, range, h, axis.tolerance(relative, size, h, Axes::kPart)};
      bool on_target = false;
      motion.set(i, joining.after(seconds, own, error(i), target, on_target));
      motion.arrived = motion.arrived && on_target;
    }
    return motion;
  }

 private:
  static constexpr int kLengths = Axes::kLengths;
  static constexpr bool kRotates = Space::kRows - kLengths == 3;

  [[nodiscard]] static bool rests(const Moving& motion, int i) noexcept {
    return motion.xd(i) == Scalar(0) && motion.xdd(i) == Scalar(0);
  }

  /// Fixed axis about which an orientation rotates to a target without angular velocity, if possible.
  [[nodiscard]] static std::optional<FixedAxis<Scalar>> turns_about(const Twist& xd, const Twist& xdd,
                                                                    const Twist& error,
                                                                    const Twist& velocity) noexcept {
    if constexpr (kRotates) {
      if (!velocity.template tail<3>().isZero(Scalar(0))) return {};
      return fixed_axis<Scalar>(error.template tail<3>(), xd.template tail<3>(), xdd.template tail<3>());
    } else {
      return {};
    }
  }

  Axes axes_;
  Scalar speed_{1};
};

}  // namespace fpbm
