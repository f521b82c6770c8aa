#pragma once

#include "fpbm/bound/detail/joint_displacement.hpp"
#include "fpbm/bound/detail/next_motion.hpp"

namespace fpbm {

/// The planned stop, and the motion from which the stop starts, for rows on gaps.
template <int N, int Joints, typename Scalar>
struct GapMotion {
  using JointVector = Vector<N, Scalar>;
  using AllJoints = Vector<Joints, Scalar>;

  JointVector line;  ///< Displacement of the drives in the stop, at constant velocity [rad] or [m].
  JointDisplacement<Joints, Scalar> stop;
  const JointVector& qd;
  AllJoints speed;       ///< Velocities of all joints.
  Scalar coasting_time;  ///< Stopping distance divided by the velocity, T − kSoft [s].
  Scalar tick;           ///< h [s]
  Scalar lag;            ///< Delay by bounds on jerk: change of the velocity after the tick, divided by u [s].

  template <typename Drives, Level kLevel>
  GapMotion(const Drives& drives, const NextMotion<kLevel, N, Scalar>& next) noexcept
      : GapMotion(drives, next, Scalar(1) + next.stop.plan.smooth_coasting_ticks(next.limits)) {}

  [[nodiscard]] Scalar time() const noexcept { return coasting_time + kSoft; }

  /// The rows are evaluated in the middle of the tick, like J of the task. At the start of the tick, the rows would
  /// differ by h/2 d(∇s)/dt.
  [[nodiscard]] JointVector middle(const State<N, Scalar>& state) const noexcept {
    return state.q + tick / Scalar(2) * state.qd;
  }

 private:
  /// Part of T beyond the coasting time [s]. Range: 0.025 to 0.2. With 0.0125 and with 1,
  /// Bounds.returns_when_a_shape_leaves fails. With 0.2, T/κ exceeds τ: the tests of GapRows pass, but
  /// TaskBounds.stop_gently_before_a_wall fails.
  static constexpr Scalar kSoft = Scalar(0.05);

  /// ticks: not rounded to whole ticks, because the steps of a rounded number would cause jerks.
  template <typename Drives, Level kLevel>
  GapMotion(const Drives& drives, const NextMotion<kLevel, N, Scalar>& next, Scalar ticks) noexcept
      : line(ticks / (Scalar(1) + next.stop.plan.coasting_ticks()) * next.stop.displacement.line),
        stop(drives, next.stop.displacement),
        qd(next.state.qd),
        speed(drives.rates(next.state.qd)),
        coasting_time(next.limits.tick() * ticks),
        tick(next.limits.tick()),
        lag((next.acting_ticks - Scalar(1)) * next.limits.tick()) {
    stop.line = drives.rates(line);
  }
};

}  // namespace fpbm
