#pragma once

namespace fpbm {

/// Replaces LowerLevels in a Tracker of a single task.
struct NoLowerLevels {
  template <typename Scalar>
  NoLowerLevels(Scalar, Scalar) noexcept {}

  template <typename References, typename Kinematics, typename Error, typename Correction>
  [[nodiscard]] static bool hold(const References&, const Kinematics&, const Error&, const Correction&) noexcept {
    return false;
  }
  [[nodiscard]] static constexpr bool rests() noexcept { return false; }
  template <typename Tick>
  static void report(const Tick&) noexcept {}
  template <typename JointVector, typename Scalar>
  static void end_tick(bool, const JointVector&, Scalar, Scalar) noexcept {}
  static void release() noexcept {}
};

template <typename Space, typename Scalar>
struct LowerLevelsOf {
  using type = NoLowerLevels;
};

}  // namespace fpbm
