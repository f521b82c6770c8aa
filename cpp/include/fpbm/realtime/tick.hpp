#pragma once

#include <cstdint>

#include "fpbm/core/status.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/scheme/set_damping.hpp"
#include "fpbm/singular/damping.hpp"

namespace fpbm {

/// Result of one tick of a control loop, of a task whose errors have so many rows.
template <int Rows, int N, typename Scalar>
struct TickOfRows {
  Vector<N, Scalar> q;         ///< Command for the tick's end [rad], or [m] for a prismatic joint.
  Vector<N, Scalar> qd;        ///< Its velocity [rad/s].
  Vector<N, Scalar> qdd;       ///< Mean acceleration over the tick [rad/s²].
  Status status;               ///< Where it failed, why the arm brakes.
  Scalar scale;                ///< Share of the task that the limits left: 1 all of it, 0 where the arm brakes.
  JointBits saturated;         ///< Bit i is set where joint i is on a bound.
  Scalar sigma;                ///< Lower bound on σ_min(J), tight within a factor √M: at the tick's start, or in its
                               ///< middle where several levels have bounds on acceleration.
  Vector<Rows, Scalar> error;  ///< x ⊖ f(q) at the tick's start [m, rad].
};

/// Result of one tick of a control loop.
template <typename Space, int N, typename Scalar = double>
struct Tick : TickOfRows<Space::kRows, N, Scalar> {};

/// Multiplies the scale of a tick, and takes over the scale of a motion.
template <typename Space, int N, typename Scalar>
void multiply_scale(Tick<Space, N, Scalar>& tick, Scalar share) noexcept {
  tick.scale *= share;
}
template <typename Space, int N, typename Scalar, typename Motion>
void take_scale(Tick<Space, N, Scalar>& tick, const Motion& motion) noexcept {
  tick.scale = motion.scale;
}
/// Reports levels below the first: none.
template <typename Space, int N, typename Scalar>
void report_lower_levels(Tick<Space, N, Scalar>&) noexcept {}

/// Share of a task below the first level that the limits left. row: the first row of its error. There is none.
template <typename Space, int N, typename Scalar>
[[nodiscard]] Scalar lower_scale(const Tick<Space, N, Scalar>&, int) noexcept {
  return Scalar(1);
}

template <typename Scalar = double>
struct TrackerOptions {
  Scalar dt = Scalar(1e-3);  ///< Length of a tick [s].
  /// Largest error that the feedback sees, of the position [the arm's characteristic lengths] and of the orientation
  /// [rad]: a farther target, out of reach perhaps, pulls no harder.
  Scalar error_bound = Scalar(0.1);
  /// Gain of ∫(x ⊖ f(q)) dt, which is added to the reference's acceleration [1/s³] or velocity [1/s²] and removes the
  /// error that a constant bias leaves (PID feedback: Guo et al. 2018); stable below k₁k₂. The integral waits while
  /// the task is slowed or damped, or its target farther than error_bound, and adds integral_bound at most
  /// [characteristic lengths and radians per s², or per s]. Each task of a stack has an integral.
  Scalar integral_gain = Scalar(0);
  Scalar integral_bound = Scalar(1);
  /// An arm that is slowed, or farther than error_bound from its target, and comes no nearer for this time [s] rests
  /// until its target moves, or until resume(). Infinite: it never gives up.
  Scalar stall_time = Scalar(2);
  SingularDamping<Scalar> singular = SingularDamping<Scalar>();  ///< Used where the scheme has none.
  /// Damping of the null space [1/s] for a scheme of acceleration level that has none; 0: none. Without damping the
  /// self-motion of these schemes never comes to rest. 2 is the library's usual value: self-motion decays to 1 % in
  /// 2.3 s.
  Scalar null_damping = Scalar(2);
  /// Whether a stalled arm may move to a posture that it remembers, if the target can be reached from there (Recovery).
  bool recovery = true;
  /// Whether the first level comes before speed. The lower levels leave the first level a reserve of the limits: 0.7 of
  /// each bound on acceleration and 0.35 of each bound on velocity. stop() keeps the first level: its references are
  /// held at rest, and the joints come to rest in its null space, which takes longer than the stop of each joint by
  /// itself. A task that is farther than 0.001 characteristic lengths, or 0.001 rad, from its reference stays where it
  /// is. Without effect on resolve_measured(), and on a tracker of a single level.
  bool keep_first_level = false;
  /// Largest age of the states that resolve_measured() is given [ticks]: the time from the measurement to the start of
  /// the tick in which the robot realises the answer. 0: exact states of this moment, as a simulation has them.
  int measured_delay = 3;

  /// The damping for a scheme of an arm whose task has so many rows: without a null space, none of it.
  [[nodiscard]] DefaultDamping<Scalar> damping(Eigen::Index dof, Eigen::Index rows) const noexcept {
    return {singular, dof > rows ? null_damping : Scalar(0)};
  }
};

}  // namespace fpbm
