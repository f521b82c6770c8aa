#pragma once

#include <utility>

#include "fpbm/core/status.hpp"
#include "fpbm/linalg/detail/entrywise.hpp"
#include "fpbm/realtime/detail/followable_fraction.hpp"
#include "fpbm/realtime/detail/joint_approach.hpp"
#include "fpbm/realtime/detail/path_motion.hpp"
#include "fpbm/realtime/detail/tracker_state.hpp"

namespace fpbm {

/// Sets scale, saturated joints and status of the result for a limited motion.
template <typename Motion, typename Bounds_, typename Result>
void report_limits(const Motion& found, const Bounds_& bounds, bool braking, Result& result) noexcept {
  take_scale(result, found);
  result.saturated = found.joints;
  if (found.scale < 1 && !braking) result.status = bounds.status(found.rows);
}

/// Motion of a recovery within the limits and the rows.
template <typename TrackerState, typename Rows>
[[nodiscard]] auto recovery_motion(const TrackerState& state, const Rows& rows,
                                   typename TrackerState::Result& result) noexcept {
  const auto& tick = state.tick;
  const auto box = state.limits().box(tick.joints, tick.last);
  result.status = Status::kRecovering;
  multiply_scale(result, typename TrackerState::Scalar(0));
  return rows.near(box.nearest(state.progress.recovery().motion(state.limits(), tick.joints)), box);
}

/// followable_fraction() at the start of a tick.
template <typename TrackerState, typename Desired>
[[nodiscard]] auto followable_part(const TrackerState& state, const Desired& desired) noexcept {
  using Scalar = typename TrackerState::Scalar;
  auto loop = desired.loop;
  const auto& q = state.tick.joints.q;
  auto field = q;
  if (failed(loop.evaluate(state.correction(desired.now), q, field))) return Scalar(1);
  const auto reference_after = [&](Scalar seconds) noexcept {
    auto correction = state.correction;
    approach_postures<TrackerState::kLevel, typename TrackerState::Space>(
        loop.arm, state.limits(), correction, [&](int joint) { return seconds * field.coeff(joint); });
    return correction(desired.now);
  };
  return followable_fraction(loop, state.limits(), reference_after, q, field);
}

/// Motion of a tick whose desired motion u the limits or the rows do not admit: level by level within the limits and
/// the rows (Limiter). If the arm has stalled, or each joint brakes by itself, the braking motion.
template <typename TrackerState, typename Desired, typename Rows_>
[[nodiscard, gnu::noinline]] typename TrackerState::JointVector limited_motion(
    const TrackerState& state, const Desired& desired, typename TrackerState::JointVector u, const Rows_& rows,
    typename TrackerState::Result& result) noexcept {
  using Scalar = typename TrackerState::Scalar;
  using JointVector = typename TrackerState::JointVector;
  const auto& limiter = state.limiter;
  const auto& joints = state.tick.joints;
  const auto& last = state.tick.last;
  Scalar fraction(1);  // Fraction of the velocities of the scheme.
  if constexpr (TrackerState::kLevel == Level::kVelocity) {
    if (!failed(result.status) && !state.on_path()) fraction = followable_part(state, desired);
  }
  const auto slowed = [&](const JointVector& v) {
    return entrywise(v, [&](Eigen::Index i) { return fraction * v.coeff(i); });
  };
  u = slowed(u);
  auto tasks = jacobian_in_metres(desired.loop.kinematics);
  [[maybe_unused]] JointVector first = u;
  if constexpr (TrackerState::kHasLevels) {
    if (has_lower_levels(desired.loop.kinematics)) first = slowed(desired.loop.first);
    tasks.set_first_motion(first);
  }
  const bool stalled = result.status == Status::kStalled;
  const bool braking = stalled || state.brakes(result.status);
  auto found = with_scale(tasks, joints.qd, Scalar(0));
  if (braking) {
    found.u = limiter.brake(joints, last, stalled ? rows : Rows_{}).u;
  } else if (!state.stops()) {
    found = limiter.motion(tasks, joints, u, last, rows);
  } else if constexpr (TrackerState::kHasLevels) {
    found = limiter.stop_on_first_level(tasks, joints, u, last, rows);
  }
  report_limits(found, state.bounds, braking, result);
  if (fraction < Scalar(1)) {
    multiply_scale(result, fraction);
    result.status = worse(result.status, Status::kSlowed);
  }
  return found.u;
}

/// Second step of a tick: the motion within the limits and the rows that realises as much of the desired motion as
/// possible. A desired motion that the limits and the rows admit does not change. rows: TrackerState::rows().
template <typename TrackerState, typename Desired, typename Rows_>
[[nodiscard]] typename TrackerState::JointVector limit(TrackerState& state, const Desired& desired, const Rows_& rows,
                                                       typename TrackerState::Result& result) noexcept {
  using Scalar = typename TrackerState::Scalar;
  const typename TrackerState::JointVector& u = desired.u;
  if (!state.is_brakable(state.tick.after(u))) result.status = Status::kNotFinite;
  if (state.progress.recovering() && !state.stops() && !failed(result.status)) {
    return recovery_motion(state, rows, result);
  }
  if (state.progress.stalled()) result.status = worse(result.status, Status::kStalled);
  if (!state.stops() && result.status < Status::kStalled) {
    if (state.admits(rows, u)) return u;
    if constexpr (Desired::kOnPath) {
      if (state.on_path()) {
        const auto box = state.limits().box(state.tick.joints, state.tick.last);
        auto found = u;
        if (find_motion_on_path(desired, box, rows, state.most_path_fraction, Scalar(1), found)) return found;
      }
    }
  }
  return limited_motion(state, desired, u, rows, result);
}

/// limit() for a measured state. last: last command [rad/s²].
template <typename TrackerState, typename Limiter, typename Desired>
[[nodiscard]] typename TrackerState::JointVector limit_measured(TrackerState& state, const Limiter& limiter,
                                                                const Desired& desired,
                                                                const typename TrackerState::JointVector& last,
                                                                typename TrackerState::Result& result) noexcept {
  const auto& measured = desired.loop.state;
  const auto& limits = limiter.limits();
  const auto rows = state.rows(limits, measured, desired.u, state.dt() / limits.tick());
  auto tasks = jacobian_in_metres(desired.loop.kinematics);
  if constexpr (TrackerState::kHasLevels) tasks.set_first_motion(desired.loop.first);
  auto found = with_scale(tasks, last, typename TrackerState::Scalar(0));
  const bool braking = state.stops() || failed(result.status);
  if (braking) {
    found.u = limiter.brake(measured, last).u;
  } else {
    found = limiter.motion(tasks, measured, desired.u, last, rows);
  }
  report_limits(found, state.bounds, braking, result);
  return found.u;
}

}  // namespace fpbm
