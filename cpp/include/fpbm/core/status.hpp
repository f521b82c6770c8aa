#pragma once

namespace fpbm {

/// Result of one evaluation, step, tick or rollout. The control loop returns a Status and never throws.
/// Up to kStalled, a motion was computed. From kSingular on, there is no result.
enum class Status : unsigned char {
  kOk = 0,
  kCoarse,      ///< The step is too long: the step length, and not the scheme, causes a significant tip error.
  kDamped,      ///< Near a singular posture: motion in the lost task directions is damped.
  kSlowed,      ///< Joint limits or rotations near π reduce a task scale, or a lower level has stopped (Tick::scales).
  kBlocked,     ///< Clearances, or bounds of tasks, reduce the task scale.
  kRecovering,  ///< No progress toward the target: the arm moves to a posture from which it can reach the target.
  kStalled,     ///< No progress toward the target: the arm rests until the target or a near shape moves, or resume().
  kNotFound,    ///< A search found no posture at its target: its result is the nearest posture found.
  kSingular,    ///< The task Jacobian is rank-deficient up to round-off.
  kTaskLost,    ///< Within one step, the tip has left the motion that the scheme prescribes.
  kNotFinite,   ///< The state, the reference or the result is infinite or NaN.
};

/// Whether there is no result.
[[nodiscard]] constexpr bool failed(Status status) noexcept {
  return status >= Status::kSingular;
}

/// The more severe of two statuses.
[[nodiscard]] constexpr Status worse(Status a, Status b) noexcept {
  return a > b ? a : b;
}

/// Description of the status in one sentence.
[[nodiscard]] constexpr const char* message(Status status) noexcept {
  switch (status) {
    case Status::kOk: return "the whole task is executed";
    case Status::kCoarse: return "the steps are too long: they cause a discretisation error of the tip";
    case Status::kDamped: return "the posture is nearly singular: motion in the singular directions is damped";
    case Status::kSlowed: return "joint limits or free rotations near π scale the task, or a lower level has stopped";
    case Status::kBlocked: return "self-collision, obstacles or task bounds limit the task";
    case Status::kRecovering:
      return "the arm made no progress toward its target: it moves to a posture from which the target is reachable";
    case Status::kStalled:
      return "the arm makes no progress toward its target, which may be unreachable: the arm stops";
    case Status::kNotFound: return "no posture at the target was found: the target may be unreachable";
    case Status::kSingular: return "the posture is singular: the task Jacobian is rank-deficient";
    case Status::kTaskLost: return "the tip has left its reference: the target is unreachable, or the step is too long";
    case Status::kNotFinite: return "a number is not finite: the joint motion has diverged";
  }
  return "unknown status";
}

/// Advice to the caller. Empty for kOk.
[[nodiscard]] constexpr const char* advice(Status status) noexcept {
  switch (status) {
    case Status::kOk: return "";
    case Status::kCoarse: return "Shorten dt.";
    case Status::kDamped: return "Expect a tip error until the arm has left the singular posture.";
    case Status::kSlowed:
      return "Expect a tip error until the joints leave their limits, or slow the path. The scales of a stack show "
             "which level is limited. If a task leaves rotations free, replace its rotation rows by an AxisTask.";
    case Status::kBlocked:
      return "Lead the target around the nearest shape, or expect a tip error while shapes or bounds limit the task.";
    case Status::kRecovering: return "Expect a tip error until the arm is in that posture.";
    case Status::kStalled: return "Move the target into the workspace, or call resume() to try again.";
    case Status::kNotFound: return "Move the target into the workspace, relax the bounds, or allow more starts.";
    case Status::kSingular:
      return "Choose another start posture, a path inside the workspace, or weights with smaller ratios.";
    case Status::kTaskLost: return "Keep the path inside the workspace and away from singular postures, or shorten dt.";
    case Status::kNotFinite: return "Check the start state and the path, lower the gains, or shorten dt.";
  }
  return "";
}

}  // namespace fpbm
