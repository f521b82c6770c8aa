#pragma once

#include "bounds.hpp"
#include "fpbm/any/detail/any_path.hpp"
#include "fpbm/realtime/tick.hpp"
#include "fpbm/simulate/fastest.hpp"
#include "fpbm/simulate/rollout.hpp"
#include "lane_tracker.hpp"
#include "recorder.hpp"
#include "scheme.hpp"
#include "stack_path.hpp"

namespace fpbm::bindings {

/// Limits of a motion and their options; the length of a tick is the step of the grid.
struct LimitOptions {
  JointLimits<kDynamic> limits;
  TrackerOptions<> options;
  AnyBounds bounds;
  bool keeps_clear = false;  ///< Whether a clearance was given.
};

/// One motion along a path.
template <typename Space>
struct Motion {
  const AnyArmFor<Space>* arm;  ///< Null for a robot, which has a stack.
  const AnyPath<Space>& path;
  const Scheme& scheme;
  State<kDynamic> start;
  TimeGrid<double> grid;
  const StackOptions* stack;  ///< Null if the tip's task is the only task.

  /// rollout() of the motion. Throws std::invalid_argument if scheme or start do not fit the arm.
  RolloutResult<kDynamic> simulate(const Output<Space>& output) const;

  /// fpbm::track() of the motion. Throws std::invalid_argument if scheme, start, limits, options or bounds do not
  /// fit.
  RolloutResult<kDynamic> track(const LimitOptions& limit_options, const Output<Space>& output) const;

  /// fastest_clock() and play() of the motion, for joint positions along the path.
  FastestClock clock(const Spline<kDynamic>& joints, const JointLimits<kDynamic>& limits, AnyBounds& bounds,
                     const FastestOptions& options) const;
  void play(const Spline<kDynamic>& joints, const FastestClock& clock, const Output<Space>& output) const;

  /// The tracker of the motion, for an arm of N joints. Throws as track() does.
  template <int N>
  LaneTracker<Space, N> tracker(const LimitOptions& limit_options) const;

  /// Throws as simulate() does, or as track() if there are limits.
  void require(const LimitOptions* limit_options) const;

 private:
  RolloutResult<kDynamic> simulate_stack(const Output<Space>& output) const;
};

extern template struct Motion<Position<2>>;
extern template struct Motion<PlanarPose>;
extern template struct Motion<Position<3>>;
extern template struct Motion<Pose>;

}  // namespace fpbm::bindings
