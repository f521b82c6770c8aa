#pragma once

#include <atomic>
#include <vector>

#include "arm.hpp"
#include "outcome.hpp"

namespace fpbm::bindings {

/// One motion of a sweep: under which scheme, and from where at rest.
template <typename Space>
struct Job {
  const PyScheme* scheme;
  Joints q0;
  MotionBuffers<Space, kDynamic> buffers = {};  ///< For the whole motion, where it is wanted.
};

/// Runs each job on one arm along one path, as model.simulate() would, and writes an outcome for each: where the
/// processor has lanes, and there is code for them, many jobs side by side, with results that do not depend on which.
/// Once stop is set, which is looked at in every sample, all that are not done yet are not run. Throws
/// std::invalid_argument where a scheme or a start does not fit the arm.
template <typename Space>
void sweep(const TaskModel<Space>& model, const AnyPath<Space>& path, const TimeGrid<double>& grid,
           const std::vector<Job<Space>>& jobs, const std::atomic<bool>& stop, Outcome* outcomes);

}  // namespace fpbm::bindings
