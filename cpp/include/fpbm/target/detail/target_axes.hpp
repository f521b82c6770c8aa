#pragma once

#include <cmath>
#include <optional>

#include "fpbm/core/types.hpp"
#include "fpbm/path/detail/fixed_axis.hpp"
#include "fpbm/path/detail/time_optimal_axis.hpp"
#include "fpbm/target/detail/target_bounds.hpp"

namespace fpbm {

/// Motion along all axes of the base frame within bounds: time-optimal for each axis, and about a fixed axis for an
/// orientation if possible.
template <typename Space, typename Scalar>
class TargetAxes {
 public:
  using Axis = TimeOptimalAxis<Scalar>;
  using Twist = Vector<Space::kRows, Scalar>;

  /// Displacement [m, rad], velocity and acceleration after a time.
  struct Motion {
    Twist displacement;
    Twist xd;
    Twist xdd;
    bool arrived = false;  ///< Whether all axes rest on the target.

    void set(int i, const AxisState<Scalar>& axis) noexcept {
      displacement(i) = axis.q;
      xd(i) = axis.v;
      xdd(i) = axis.a;
    }
  };

  /// Throws std::invalid_argument if a bound is not positive and finite.
  explicit TargetAxes(const TargetBounds<Scalar>& bounds)
      : lengths_(bounds.lengths()), angles_(Space::kTurns > 0 ? bounds.angles() : bounds.lengths()) {}

  /// Fraction of the velocity bounds that the motion uses, in (0, 1].
  void set_speed(Scalar fraction) noexcept { speed_ = fraction; }
  [[nodiscard]] Scalar speed() const noexcept { return speed_; }

  [[nodiscard]] Axis operator()(int i) const noexcept {
    Axis axis = i < kLengths ? lengths_ : angles_;
    axis.velocity *= speed_;
    return axis;
  }

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
    if constexpr (Space::kTurns == 3) {
      if (!fixed) return motion;
      const AxisState<Scalar> to = approach_one(kLengths + static_cast<int>(fixed->largest));
      motion.displacement.template tail<3>() = to.q * fixed->angles;
      motion.xd.template tail<3>() = to.v * fixed->motion;
      motion.xdd.template tail<3>() = to.a * fixed->motion;
    }
    return motion;
  }

 private:
  static constexpr int kLengths = Space::kRows - Space::kTurns;

  /// Fixed axis about which an orientation rotates to a target without angular velocity, if possible.
  [[nodiscard]] static std::optional<FixedAxis<Scalar>> turns_about(const Twist& xd, const Twist& xdd,
                                                                    const Twist& error,
                                                                    const Twist& velocity) noexcept {
    if constexpr (Space::kTurns == 3) {
      if (!velocity.template tail<3>().isZero(Scalar(0))) return {};
      return fixed_axis<Scalar>(error.template tail<3>(), xd.template tail<3>(), xdd.template tail<3>());
    } else {
      return {};
    }
  }

  Axis lengths_;
  Axis angles_;
  Scalar speed_{1};
};

}  // namespace fpbm
