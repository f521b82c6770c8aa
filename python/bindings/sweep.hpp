#pragma once

#include <atomic>
#include <limits>
#include <vector>

#include "arm.hpp"

namespace fpbm::bindings {

/// One motion of a sweep: under which scheme, and from where at rest.
template <typename Space>
struct Job {
  const PyScheme* scheme;
  Joints q0;
  MotionBuffers<Space, kDynamic> buffers = {};  ///< For the whole motion, where it is wanted.
};

/// What became of it. Not a number where there is none: of a motion that was not run, or has no sample.
struct Outcome {
  static constexpr int kNotRun = -1;
  [[nodiscard]] static Outcome of_nothing() noexcept {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    return {kNotRun, 0, kNone, {kNone, kNone, kNone, kNone, kNone, kNone, kNone}};
  }

  int status;  ///< A Status, or kNotRun.
  int samples;
  double time;  ///< Of the last sample [s].
  MotionSummary<> summary;
};

/// Runs each job on one arm along one path, as model.simulate() would, and writes an outcome for each.
/// Once stop is set, which is looked at in every sample, all that are not done yet are not run. Throws
/// std::invalid_argument where a scheme or a start does not fit the arm.
template <typename Space>
void sweep(const TaskModel<Space>& model, const AnyPath<Space>& path, const TimeGrid<double>& grid,
           const std::vector<Job<Space>>& jobs, const std::atomic<bool>& stop, Outcome* outcomes);

}  // namespace fpbm::bindings
