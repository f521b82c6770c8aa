#pragma once

#include <algorithm>
#include <utility>

#include "fpbm/core/status.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/linalg/detail/entrywise.hpp"
#include "fpbm/linalg/detail/sums.hpp"
#include "fpbm/realtime/detail/continue_tick.hpp"
#include "fpbm/realtime/detail/tick_motion.hpp"
#include "fpbm/realtime/detail/tick_references.hpp"

namespace fpbm {

/// Joint state of a Tracker from tick to tick, with the accelerations of the last ticks.
template <Level kLevel, typename Space, int N, typename Scalar = double>
struct TickState {
  using JointVector = Vector<N, Scalar>;
  using JointState = State<N, Scalar>;

  TickMotion<kLevel, N, Scalar> motion;
  JointState joints;
  JointVector last;    ///< Acceleration of the last tick.
  JointVector change;  ///< Change of acceleration from the tick before the last tick to the last tick.
  /// Change of the reference's acceleration during the last tick.
  Vector<Space::kRows, Scalar> reference_change = filled<Vector<Space::kRows, Scalar>>(Space::kRows);

  /// State after a tick with the constant motion u.
  [[nodiscard]] JointState after(const JointVector& u) const noexcept { return motion.after(joints, u); }
  /// Motion of a tick in which all velocities decrease in proportion, to 1/e in 0.025 s or two ticks. With 0.1 s, a
  /// stopped task of LowerLevels.stay_where_they_stopped_at_acceleration_level moves by 2e-4 in this time.
  [[nodiscard, gnu::cold, gnu::noinline]] JointVector slowed() const noexcept {
    const Scalar decrease = std::min(Scalar(40), Scalar(0.5) / motion.dt);
    return entrywise(joints.qd, [&](Eigen::Index i) {
      const Scalar rate = -decrease * joints.qd.coeff(i);
      return kLevel == Level::kAcceleration ? rate : joints.qd.coeff(i) + motion.dt * rate;
    });
  }
  /// Mean motion of a tick to the state `next`.
  [[nodiscard]] JointVector motion_to(const JointState& next) const noexcept { return motion.between(joints, next); }
  /// Mean acceleration of a tick to the state `next`.
  [[nodiscard]] JointVector acceleration_to(const JointState& next) const noexcept {
    return motion.rate(joints.qd, next.qd);
  }
  /// Ends a tick at the state `next`, which was reached with the acceleration qdd.
  void store(JointState&& next, const JointVector& qdd) noexcept {
    change = entrywise(last, [&](Eigen::Index i) { return qdd.coeff(i) - last.coeff(i); });
    last = qdd;
    joints = std::move(next);
  }

  /// Updates `loop` to the middle of a tick that continues the motion of the last tick (continue_tick()). Returns the
  /// reference in the middle. Before the call, `loop` has the points at the start of the tick. gains: of the scheme.
  template <typename Loop, typename References>
  [[nodiscard]] auto update_middle(Loop& loop, const References& references,
                                   const TaskGains<Scalar>& gains) const noexcept {
    const auto start = loop.kinematics.tip;
    loop.state = kLevel == Level::kAcceleration ? motion.middle(joints, last) : motion.middle(joints);
    loop.arm.kinematics(loop.state.q, loop.state.qd, loop.kinematics);
    const auto moved = Space::template difference<Scalar>(loop.kinematics.tip, start);
    auto middle = references.template middle<kLevel>(reference_change);
    if constexpr (kLevel == Level::kAcceleration) {
      const auto expected = Space::template difference<Scalar>(references.stages[1].x, references.stages[0].x);
      continue_tick(loop.kinematics, middle, gains, motion.dt,
                    entrywise(moved, [&](Eigen::Index i) { return expected.coeff(i) - moved.coeff(i); }),
                    TickBefore<N, Scalar>{loop.state.qd, last, change});
    } else {
      const auto error = Space::template difference<Scalar>(references.stages[0].x, start);
      continue_tick_of_velocity(loop.kinematics, middle, gains, motion.dt, error, moved, loop.state.qd);
    }
    return middle;
  }
};

}  // namespace fpbm
