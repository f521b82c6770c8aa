#pragma once

namespace fpbm {

/// What became of one evaluation, step or rollout. The loop returns it and never throws.
enum class Status : unsigned char {
  kOk = 0,
  kSingular,   ///< The task Jacobian has lost rank: its Gram matrix has no usable Cholesky factor.
  kTaskLost,   ///< In one step the tip left the course that the scheme prescribes.
  kNotFinite,  ///< The state, the reference or the result is infinite or not a number.
};

/// One plain sentence: what happened.
[[nodiscard]] constexpr const char* message(Status status) noexcept {
  switch (status) {
    case Status::kOk: return "all is well";
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
    case Status::kSingular:
      return "Choose another start posture, a path that stays inside the workspace, or weights less far apart.";
    case Status::kTaskLost: return "Keep the path inside the workspace and away from singular postures, or shorten dt.";
    case Status::kNotFinite: return "Check the start state and the path, lower the gains, or shorten dt.";
  }
  return "";
}

}  // namespace fpbm
