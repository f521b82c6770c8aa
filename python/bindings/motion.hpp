#pragma once

#include <atomic>
#include <memory>

#include "bounds.hpp"
#include "fpbm/any/detail/any_path.hpp"
#include "fpbm/simulate/detail/motion.hpp"
#include "fpbm/simulate/fastest.hpp"
#include "fpbm/simulate/kept_path.hpp"
#include "fpbm/simulate/rollout.hpp"
#include "fpbm/simulate/summary.hpp"
#include "scheme.hpp"
#include "stack_path.hpp"
#include "tracker.hpp"

namespace fpbm::bindings {

/// Arrays for a motion, and the flag that ends the motion early. A null pointer means no array or no flag.
template <typename Space>
struct Output {
  MotionBuffers<Space, kDynamic> buffers = {};
  double* scale = nullptr;      ///< Within limits: scale of each tick.
  bool* saturated = nullptr;    ///< Within limits: which joints are on a bound, a row for each tick.
  double* clearance = nullptr;  ///< Distance of the nearest pair, written by the code that computes it.
  double* scales = nullptr;     ///< For a stack: scale of each level, a row for each tick.
  double* errors = nullptr;     ///< For a stack: errors of all tasks, a row for each tick.
  MotionSummary<>* summary = nullptr;
  const std::atomic<bool>* stop = nullptr;
};

/// The recorder of every motion: one type, so that a rollout is compiled once for all outputs.
template <typename Space>
class Recorder {
 public:
  /// level: at acceleration level, the samples have accelerations.
  Recorder(const Output<Space>& output, Level level) : output_(output), summary_(level) {}

  bool operator()(const Sample<Space, kDynamic>& sample) noexcept {
    output_.buffers(sample);
    if (output_.summary != nullptr) summary_(sample);
    return output_.stop == nullptr || !output_.stop->load(std::memory_order_relaxed);
  }

  template <typename AnyTick>
  bool operator()(const Sample<Space, kDynamic>& sample, const AnyTick& tick) noexcept {
    if (output_.scale != nullptr) output_.scale[sample.index] = tick.scale;
    if (output_.saturated != nullptr) {
      const Eigen::Index n = sample.q.size();
      for (Eigen::Index i = 0; i < n; ++i) output_.saturated[sample.index * n + i] = ((tick.saturated >> i) & 1U) != 0;
    }
    return (*this)(sample);
  }

  /// Writes the summary to the output.
  void finish() const noexcept {
    if (output_.summary != nullptr) *output_.summary = summary_.result();
  }

 private:
  Output<Space> output_;
  Summary<Space, kDynamic> summary_;
};

/// Limits of a motion and their options; the length of a tick is the step of the grid.
struct LimitOptions {
  JointLimits<kDynamic> limits;
  TrackerOptions<> options;
  AnyBounds bounds;
  bool keeps_clear = false;  ///< Whether a clearance was given.
  bool keeps_path = false;   ///< Whether the clock of the path slows down, so that the tip stays on the path.
  double reserve = 0.0;      ///< Of the duration to the least duration, with keeps_path.
};

/// One motion along a path.
template <typename Space>
struct Motion {
  const AnyArmFor<Space>* arm;  ///< Null for a robot, which has a stack.
  const AnyPath<Space>& path;
  const Scheme& scheme;
  State<kDynamic> start;
  TimeGrid<double> grid;
  const StackOptions* stack;                            ///< Null if the tip's task is the only task.
  std::shared_ptr<const PlannedMotion> kept = nullptr;  ///< Given if the motion keeps its path.

  /// rollout() of the motion. Throws std::invalid_argument if scheme or start do not fit the arm.
  RolloutResult<kDynamic> simulate(const Output<Space>& output) const;

  /// fpbm::track() of the motion. Throws std::invalid_argument if scheme, start, limits, options or bounds do not
  /// fit.
  RolloutResult<kDynamic> track(const LimitOptions& limit_options, const Output<Space>& output) const;

  /// joint_path() of the motion, whose path has a duration [s], with the clock of a plan, or null.
  [[nodiscard]] JointPath<kDynamic> joint_path(double duration,
                                               const std::shared_ptr<const PlannedMotion>& plan = nullptr) const;
  /// The plan of kept_path() for the motion, whose path has a duration [s]. shortest: least duration of the motion
  /// [s]. The scheme has the damping of the tracker. Throws std::invalid_argument as kept_path() does, and unless the
  /// motion starts at rest.
  [[nodiscard]] std::shared_ptr<const PlannedMotion> kept_motion(const JointLimits<kDynamic>& limits, AnyBounds bounds,
                                                                 double duration, double shortest,
                                                                 const FastestOptions& options) const;

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
