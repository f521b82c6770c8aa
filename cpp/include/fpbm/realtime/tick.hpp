#pragma once

#include <cstdint>

#include "fpbm/core/status.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/model/kinematics.hpp"
#include "fpbm/scheme/detail/set_damping.hpp"
#include "fpbm/singular/damping.hpp"

namespace fpbm {

/// Result of one tick of a control loop. Rows: number of rows of the task error.
template <int Rows, int N, typename Scalar>
struct TickOfRows {
  Vector<N, Scalar> q;         ///< Command for the end of the tick [rad], or [m] for a prismatic joint.
  Vector<N, Scalar> qd;        ///< Velocity at the end of the tick [rad/s].
  Vector<N, Scalar> qdd;       ///< Mean acceleration over the tick [rad/s²].
  Status status;               ///< Status of the tick. If failed, the reason why the arm brakes.
  Scalar scale;                ///< Task scale: 1 for the whole task, 0 if the arm brakes.
  JointBits saturated;         ///< Bit i is set if joint i is on a bound.
  Vector<Rows, Scalar> error;  ///< x ⊖ f(q) at the start of the tick [m, rad].
  /// Rate of the clock of a kept path (PathFollower) at the end of the tick, relative to the rate of the reference.
  /// Below 1, the status is at least kSlowed. Above 1, the clock slows down less than asked.
  Scalar path_fraction = Scalar(1);
};

/// Result of one tick of a control loop.
template <typename Space, int N, typename Scalar = double>
struct Tick : TickOfRows<Space::kRows, N, Scalar> {};

/// Multiplies the scale of a tick by a fraction. take_scale() sets the scale to the scale of a motion.
template <typename Space, int N, typename Scalar>
void multiply_scale(Tick<Space, N, Scalar>& tick, Scalar factor) noexcept {
  tick.scale *= factor;
}
template <typename Space, int N, typename Scalar, typename Motion>
void take_scale(Tick<Space, N, Scalar>& tick, const Motion& motion) noexcept {
  tick.scale = motion.scale;
}
/// Reports levels that are slowed for other reasons than limits. A single task has no levels.
template <typename Space, int N, typename Scalar>
void report_levels(const Kinematics<Space, N, Scalar>&, const typename Space::template Point<Scalar>&,
                   Tick<Space, N, Scalar>&) noexcept {}

/// Scale of a task below the first level. row: first row of the task's error. A single task has no lower level.
template <typename Space, int N, typename Scalar>
[[nodiscard]] Scalar lower_scale(const Tick<Space, N, Scalar>&, int) noexcept {
  return Scalar(1);
}

template <typename Scalar = double>
struct TrackerOptions {
  Scalar dt = Scalar(1e-3);  ///< Length of a tick [s]. Default: the rate of libfranka.
  /// Largest error that the feedback uses, of the position [characteristic lengths of the arm] and of the orientation
  /// [rad]. A larger error, for example of an unreachable target, does not increase the feedback. The bounds on the
  /// joints determine the largest error of a posture task (JointApproach). Default: Stall.is_not_a_slow_approach passes
  /// with 0.1 to 1, and fails with 0.03.
  Scalar error_bound = Scalar(0.1);
  /// Gain kᵢ of ∫(x ⊖ f(q)) dt, which is added to the acceleration [1/s³] or velocity [1/s²] of the reference. The
  /// integral removes the steady-state error due to a constant bias (PID feedback: Guo et al. 2018). At acceleration
  /// level, the loop is stable for kᵢ < k₁k₂ (docs/measured.md, Integral of the error). The integral is constant while
  /// the task is slowed or damped, or the error exceeds error_bound. Each task of a stack has an integral.
  /// integral_bound: largest contribution of the integral [characteristic lengths and radians per s², or per s]. The
  /// default of integral_bound is not tuned.
  Scalar integral_gain = Scalar(0);
  Scalar integral_bound = Scalar(1);
  /// If an arm is slowed, or farther than error_bound from its target, and makes no progress for this time [s], the arm
  /// stops until its target moves, or until resume(). Infinite: the arm never stalls. Default:
  /// Stall.is_not_a_slow_approach passes with 2 and 5, and fails with 1.
  Scalar stall_time = Scalar(2);
  /// Damping near singular postures, for a scheme that has none.
  SingularDamping<Scalar> singular = SingularDamping<Scalar>();
  /// Null-space damping [1/s] for a scheme of acceleration level that has none; 0: none. Without damping, self-motion
  /// at acceleration level never stops. With 2, the usual value of this library, self-motion decays to 1 % in 2.3 s.
  Scalar null_damping = Scalar(2);
  /// Whether a stalled arm may move to a remembered posture from which the target is reachable (Recovery), and an arm
  /// at rest may leave a singular posture (SaddleExit).
  bool recovery = true;
  /// Whether limits and stops preserve the first of several levels. A part of the limits is reserved for the first
  /// level: 0.7 of each bound on acceleration and 0.35 of each bound on velocity. stop() keeps the first level: its
  /// references are held at rest, and the joints stop in its null space. A stop that keeps the first level takes longer
  /// than a stop of each joint by itself. A task that is farther than 0.001 characteristic lengths, or 0.001 rad, from
  /// its reference stays at its current point. On a kept path (PathFollower), also of a single level, the arm stops on
  /// the path, within the ramp of the follower. No effect on resolve_measured().
  bool keep_first_level = false;
  /// Largest age of the states that are passed to resolve_measured() [ticks]: the time from the measurement to the
  /// start of the tick in which the robot realises the command. Most robots need one to three ticks. 0: exact and
  /// current states, as in a simulation.
  int measured_delay = 3;
  /// Whether the start may be outside the joints' ranges, or too fast for their bounds. The joints then return within
  /// the bounds on velocity, acceleration and jerk. false: this start is an error.
  bool recover_start = false;

  /// Damping for a scheme of an arm with dof joints, whose task has the given number of rows. Without a null space,
  /// there is no null-space damping. continuous: bits of the continuous joints.
  [[nodiscard]] DefaultDamping<Scalar> damping(Eigen::Index dof, Eigen::Index rows,
                                               JointBits continuous = 0) const noexcept {
    return {singular, dof > rows ? null_damping : Scalar(0), continuous};
  }
};

}  // namespace fpbm
