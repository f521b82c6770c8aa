#pragma once

namespace fpbm {

/// What became of one evaluation, step, tick or rollout. The loop returns it and never throws.
/// Up to kStalled there is a result; from kSingular on there is none.
enum class Status : unsigned char {
  kOk = 0,
  kCoarse,      ///< The steps are too long: they, and not the scheme, made a tip error that counts.
  kDamped,      ///< Near a singular posture: motion in the directions that the tip loses there is damped.
  kSlowed,      ///< Joint limits scale the task down, or a lower level has stopped (Tick::scales).
  kBlocked,     ///< Shapes that the arm keeps clear of, or bounds of tasks, admit a share of the task only.
  kRecovering,  ///< The arm came no nearer to its target: it moves to a posture from which it can reach the target.
  kStalled,     ///< The arm comes no nearer to its target: it rests until this moves, or a shape near it, or resume().
  kSingular,    ///< The task Jacobian has lost rank, to round-off.
  kTaskLost,    ///< The tip left the motion that the scheme prescribes within one step.
  kNotFinite,   ///< The state, the reference or the result is infinite or not a number.
};

/// Whether there is no result.
[[nodiscard]] constexpr bool failed(Status status) noexcept {
  return status >= Status::kSingular;
}

/// The worse of two.
[[nodiscard]] constexpr Status worse(Status a, Status b) noexcept {
  return a > b ? a : b;
}

/// One plain sentence: what happened.
[[nodiscard]] constexpr const char* message(Status status) noexcept {
  switch (status) {
    case Status::kOk: return "all is well";
    case Status::kCoarse: return "the steps are too long: they give the tip an error that the scheme does not";
    case Status::kDamped: return "the posture is nearly singular: where the tip can hardly move, its motion is damped";
    case Status::kSlowed: return "joint limits slow the task, or a lower level has stopped";
    case Status::kBlocked: return "shapes that the arm keeps clear of, or bounds of tasks, slow the task";
    case Status::kRecovering:
      return "the arm came no nearer to its target: it moves to a posture from which it can reach the target";
    case Status::kStalled: return "the arm comes no nearer to its target, which may be out of reach: it rests";
    case Status::kSingular: return "the posture is singular: the tip cannot move in every direction of the task";
    case Status::kTaskLost:
      return "the tip has left its reference: the target is out of reach, or the step is too long";
    case Status::kNotFinite: return "a number is not finite: the joint motion has grown beyond all bounds";
  }
  return "unknown status";
}

/// One plain sentence: what the caller can do about it. Empty when nothing is wrong.
[[nodiscard]] constexpr const char* advice(Status status) noexcept {
  switch (status) {
    case Status::kOk: return "";
    case Status::kCoarse: return "Shorten dt.";
    case Status::kDamped: return "Expect a tip error until the arm has left the singular posture.";
    case Status::kSlowed:
      return "Expect a tip error until the joints are off their limits, or slow the path. The scales of a stack tell "
             "which level is slow.";
    case Status::kBlocked:
      return "Lead the target around the nearest shape, or expect a tip error while a shape or a bound is in the way.";
    case Status::kRecovering: return "Expect a tip error until the arm has reached that posture.";
    case Status::kStalled: return "Move the target into reach, or call resume() to try again.";
    case Status::kSingular:
      return "Choose another start posture, a path that stays inside the workspace, or weights less far apart.";
    case Status::kTaskLost: return "Keep the path inside the workspace and away from singular postures, or shorten dt.";
    case Status::kNotFinite: return "Check the start state and the path, lower the gains, or shorten dt.";
  }
  return "";
}

}  // namespace fpbm
