#pragma once

#include <array>
#include <cstddef>
#include <type_traits>

#include "fpbm/linalg/detail/null_basis.hpp"
#include "fpbm/linalg/detail/product.hpp"
#include "fpbm/model/kinematics.hpp"
#include "fpbm/realtime/detail/joint_approach.hpp"
#include "fpbm/realtime/detail/require_stable.hpp"
#include "fpbm/realtime/detail/tick_references.hpp"
#include "fpbm/realtime/detail/turns.hpp"
#include "fpbm/simulate/detail/closed_loop.hpp"

namespace fpbm {

/// Result of desire(). kOnPath: whether the references may be of a kept path.
template <typename Loop, typename Space, int N, typename Scalar, bool kOnPath_ = false>
struct Desired {
  static constexpr bool kOnPath = kOnPath_;
  Loop loop;                     ///< Kinematics in the middle of the tick, and the motion of the first level.
  Reference<Space, Scalar> now;  ///< Reference at the start of the tick, not corrected.
  Vector<N, Scalar> u;           ///< Desired motion: accelerations [rad/s²], or velocities [rad/s].
  /// On a kept path: the desired motion for a reference that stops in the tick, in the unit of u.
  std::conditional_t<kOnPath, Vector<N, Scalar>, std::nullptr_t> still{};
};

/// Begins the correction of the references with the errors at the start of a tick.
template <typename Arm, typename TrackerState, typename Twist, typename Scalar>
void begin_correction(const Arm& arm, TrackerState& state, const Twist& error, const Scalar& length) noexcept {
  state.correction.begin(error, length);
  approach_postures<TrackerState::kLevel, typename TrackerState::Space>(arm, state.limits(), state.correction,
                                                                        [](int) { return Scalar(0); });
}

/// Adds the null-space motion away from shapes. desired: with the rows of the task in the middle of the tick.
template <typename TrackerState, typename Desired>
void move_away(TrackerState& state, Desired& desired) noexcept {
  if constexpr (TrackerState::kBounded) {
    desired.u += null_space_motion(jacobian_in_metres(desired.loop.kinematics), state.bounds.away(state.tick.joints.q));
  }
}

/// Acceleration in the null space toward the planned state of a kept path [rad/s²], to be added to the result of the
/// scheme for `middle`. Without this acceleration, a motion in the null space would not stop with the clock. For a
/// single task with the acceleration z toward the plan, the reference `middle` becomes xdd − J z, and the result is z:
/// J⁺(xdd − J z) + z = J⁺xdd + N z.
template <typename TrackerState, typename Kinematics_, typename Space, typename Scalar>
[[nodiscard]] auto toward_plan(const TrackerState& state, const Kinematics_& kinematics,
                               Reference<Space, Scalar>& middle) noexcept {
  // Critically damped, to 1 % in 1.3 s: the default gains of a task at acceleration level. Without this acceleration,
  // KeptPath.is_kept_while_an_operator_changes_the_speed prints an error of 17 mm.
  constexpr Scalar kStiffness = Scalar(25);  // [1/s²]
  constexpr Scalar kDamping = Scalar(10);    // [1/s]
  const auto& now = state.tick.joints;
  const auto& planned = state.planned;
  const typename TrackerState::JointVector z = entrywise(now.q, [&](Eigen::Index i) {
    return kStiffness * (planned.q.coeff(i) - now.q.coeff(i)) + kDamping * (planned.qd.coeff(i) - now.qd.coeff(i));
  });
  if constexpr (kIsProduct<Space>) {
    return null_space_motion(jacobian_in_metres(kinematics), z);
  } else {
    middle.xdd -= product(kinematics.J, z);
    return z;
  }
}

/// The reference `middle` of a tick, for a reference that stops in the tick: at velocity level, at rest in the tick; at
/// acceleration level, at rest at the end of the tick.
template <Level kLevel, typename Space, typename Scalar>
[[nodiscard]] Reference<Space, Scalar> at_rest(Reference<Space, Scalar> middle,
                                               const TickReferences<Space, Scalar>& references) noexcept {
  if constexpr (kLevel == Level::kVelocity) {
    middle.xd -= references.template middle<kLevel>(references.change()).xd;
  } else {
    middle.xdd -= references.stages[2].xd / references.dt;
  }
  return middle;
}

/// First step of a tick: the motion of the scheme in the middle of the tick (TickState::update_middle()), with
/// corrected references (Correction, HeldLevel, LowerLevels). Sets the error and the status of the result. If the
/// status is a failure, the desired motion is the present motion.
template <typename Arm, typename Scheme, typename TrackerState, typename References>
[[nodiscard]] auto desire(const Arm& arm, const Scheme& scheme, TrackerState& state, References references,
                          typename TrackerState::Result& result) noexcept {
  using Space = typename TrackerState::Space;
  using Scalar = typename TrackerState::Scalar;
  using Loop = ClosedLoop<Arm, Scheme, Space>;
  using JointVector = typename TrackerState::JointVector;
  constexpr bool kOnPath = kOfPath<References>;
  state.most_path_fraction = Scalar(0);
  if constexpr (kOnPath) state.most_path_fraction = references.most_path_fraction;
  const auto& joints = state.tick.joints;
  Desired<Loop, Space, Arm::kDof, Scalar, kOnPath> desired{
      {arm, scheme, {}, joints, filled<JointVector>(joints.q.size())}, {}, state.tick.motion_to(joints)};
  auto& kinematics = desired.loop.kinematics;
  points_of(arm, joints.q, kinematics, 0);
  remove_turns(arm, kinematics.tip, state.continuous, references.stages);
  if (state.keeps_stopping()) state.held_level.hold(references, kinematics.tip, kinematics.length);
  result.error = task_error(kinematics, references.stages[0].x);
  begin_correction(arm, state, result.error, kinematics.length);
  if (state.lower_levels.hold(references, kinematics, result.error, state.correction)) {
    begin_correction(arm, state, task_error(kinematics, references.stages[0].x), kinematics.length);
  }
  desired.now = references.stages[0];
  if (state.correction.active()) {
    for (auto& stage : references.stages) stage = state.correction(stage);
  }
  auto middle = state.tick.update_middle(desired.loop, references, gains_of<Scalar>(scheme));
  [[maybe_unused]] JointVector added = filled<JointVector>(joints.q.size());
  if constexpr (kOnPath) {
    if (state.on_path()) {
      if constexpr (TrackerState::kLevel == Level::kAcceleration) added = toward_plan(state, kinematics, middle);
      (void)desired.loop.resolve(at_rest<TrackerState::kLevel>(middle, references));  // Fails only if `middle` fails.
      desired.still = desired.loop.motion() + added;
    }
  }
  result.status = desired.loop.resolve(middle);
  if (failed(result.status)) {
    state.tick.reference_change = filled<Vector<Space::kRows, Scalar>>(Space::kRows);  // Maybe not finite.
    return desired;
  }
  state.tick.reference_change = references.change();
  if (state.lower_levels.rests()) {
    desired.u = state.tick.slowed();
  } else {
    desired.u = desired.loop.motion();
    if constexpr (kOnPath) {
      if (state.on_path()) desired.u += added;
    }
  }
  if (state.bounds.moves_away()) move_away(state, desired);
  return desired;
}

/// desire() for a tick whose motion u is computed elsewhere (TrackerBatch), after begin_correction(). now: reference at
/// the start of the tick, not corrected. references: corrected. rows: TrackerState::rows() of u, and after the call, of
/// the desired motion.
template <typename Arm, typename Scheme, typename TrackerState, typename References, typename Rows>
[[nodiscard]] auto desire_given(const Arm& arm, const Scheme& scheme, TrackerState& state,
                                const typename TrackerState::Target& now, const References& references,
                                const typename TrackerState::JointVector& u, Rows& rows) noexcept {
  using Space = typename TrackerState::Space;
  using Scalar = typename TrackerState::Scalar;
  const auto& joints = state.tick.joints;
  Desired<ClosedLoop<Arm, Scheme, Space>, Space, Arm::kDof, Scalar> desired{
      {arm, scheme, {}, joints, filled<typename TrackerState::JointVector>(joints.q.size())}, now, u};
  const bool moves_away = state.bounds.moves_away();
  if (moves_away || state.stops() || !state.admits(rows, u)) {
    points_of(arm, joints.q, desired.loop.kinematics, 0);
    (void)state.tick.update_middle(desired.loop, references, gains_of<Scalar>(scheme));
  }
  if (moves_away) {
    move_away(state, desired);
    rows = state.rows(desired.u);
  }
  state.tick.reference_change = references.change();
  return desired;
}

/// desire() for a measured state: the accelerations of the scheme in this state.
template <typename Arm, typename Scheme, typename TrackerState, typename Target>
[[nodiscard]] auto desire_measured(const Arm& arm, const Scheme& scheme, TrackerState& state,
                                   const typename TrackerState::JointState& measured, const Target& reference,
                                   typename TrackerState::Result& result) noexcept {
  using Scalar = typename TrackerState::Scalar;
  using JointVector = typename TrackerState::JointVector;
  using Loop = ClosedLoop<Arm, Scheme, typename TrackerState::Space>;
  Desired<Loop, typename TrackerState::Space, Arm::kDof, Scalar> desired{
      {arm, scheme, {}, measured, filled<JointVector>(measured.q.size())}, reference, measured.qd};
  auto& loop = desired.loop;
  arm.kinematics(measured.q, measured.qd, loop.kinematics);
  std::array<Target, 1> now{reference};
  remove_turns(arm, loop.kinematics.tip, state.continuous, now);
  result.error = task_error(loop.kinematics, now[0].x);
  begin_correction(arm, state, result.error, loop.kinematics.length);
  result.status = loop.resolve(state.correction(now[0]));
  desired.u = loop.qdd;
  return desired;
}

}  // namespace fpbm
