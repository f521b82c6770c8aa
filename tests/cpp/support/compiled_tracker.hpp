#pragma once

#include <memory>

#include "fpbm/any/any_arm.hpp"
#include "fpbm/any/detail/any_path.hpp"
#include "fpbm/bound/bounds.hpp"
#include "fpbm/realtime/tracker.hpp"
#include "fpbm/scheme/schemes.hpp"

/// Trackers that are compiled once for all tests. A test that uses these trackers compiles only the calls.
namespace fpbm::test {

/// A Tracker whose members are defined in compiled_tracker_members.hpp. trackers_*.cpp instantiate the types that the
/// tests use. Any other type is an undefined symbol for the linker.
template <typename Arm, typename Space, typename Scheme, typename Bounds_ = Bounds<>>
class CompiledTracker {
 public:
  using Scalar = typename Arm::Scalar;
  static constexpr int N = Arm::kDof;
  static constexpr Level kLevel = Scheme::kLevel;
  using Target = Reference<Space, Scalar>;
  using JointVector = Vector<N, Scalar>;
  using JointState = State<N, Scalar>;
  using Result = Tick<Space, N, Scalar>;
  using Options = TrackerOptions<Scalar>;
  using MotionLimits = Limits<kLevel, N, Scalar>;

  CompiledTracker(const Arm& arm, Space, const Scheme& scheme, const JointState& start, const Options& options,
                  const MotionLimits& limits);
  CompiledTracker(const Arm& arm, Space, const Scheme& scheme, const JointState& start, const Options& options,
                  const MotionLimits& limits, const JointVector& acceleration);
  CompiledTracker(const Arm& arm, Space, const Scheme& scheme, const JointState& start, const Options& options = {});
  CompiledTracker(const Arm& arm, Space, const Scheme& scheme, const JointVector& q0, const Options& options = {});
  CompiledTracker(CompiledTracker&&) noexcept;
  CompiledTracker& operator=(CompiledTracker&&) = delete;
  ~CompiledTracker();

  Result tick(const Target& reference) noexcept;
  /// In double only.
  Result tick(PathFollower<AnyPath<Space>>& follower) noexcept;
  /// Instantiated separately in the tests that use it.
  template <typename S>
  Result tick(TargetFilter<Space, S>& filter) noexcept;
  /// At acceleration level only.
  [[nodiscard]] Result resolve_measured(const JointVector& q, const JointVector& qd, const Target& reference) noexcept;
  void stop() noexcept;
  void resume() noexcept;
  [[nodiscard]] const JointState& state() const noexcept;
  [[nodiscard]] const JointVector& acceleration() const noexcept;
  [[nodiscard]] const Arm& arm() const noexcept;
  [[nodiscard]] typename Space::template Point<Scalar> tip() const noexcept;
  /// Calls limits.require_viable() for the current state and acceleration, from which another tracker could start.
  void require_viable(const MotionLimits& limits) const;

 private:
  std::unique_ptr<Tracker<Arm, Space, Scheme, Bounds_>> tracker_;
};

}  // namespace fpbm::test
