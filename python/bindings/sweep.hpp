#pragma once

#include <atomic>
#include <vector>

#include "lanes.hpp"
#include "motion.hpp"
#include "outcome.hpp"

namespace fpbm::bindings {

/// One motion of a sweep: under which scheme, from where at rest, and where to write it if the whole motion is wanted.
template <typename Space>
struct Job {
  const Scheme* scheme;
  JointVector q0;
  Output<Space> output = {};
};

/// Runs each job on one arm along one path, as simulate() would or, where limited is not null, track(); and writes an
/// outcome for each. Where code is not null, it runs motions side by side, with results that do not depend on which.
/// Once stop is set, which is looked at in every sample, all that are not done yet are not run.
/// Throws std::invalid_argument where a scheme, a start or the limits do not fit the arm.
template <typename Space>
void sweep(const Arm& arm, const AnyPath<Space>& path, const TimeGrid<double>& grid,
           const std::vector<Job<Space>>& jobs, const Limited* limited, const LaneCode* code,
           const std::atomic<bool>& stop, Outcome* outcomes);

}  // namespace fpbm::bindings
