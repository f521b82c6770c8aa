#include "sweep.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

#include "lanes.hpp"

namespace fpbm::bindings {
namespace {

/// One motion by itself.
template <typename Space>
Outcome run(const TaskModel<Space>& model, const AnyPath<Space>& path, const TimeGrid<double>& grid,
            const Job<Space>& job, const std::atomic<bool>& stop) {
  const Outcome nothing = Outcome::of_nothing();
  MotionSummary<> summary = nothing.summary;
  const State<kDynamic> start{job.q0, Joints::Zero(job.q0.size())};
  const RolloutResult<kDynamic> result = model.simulate(*job.scheme, path, start, grid, {job.buffers, &summary, &stop});
  const bool stopped = !failed(result.status) && result.samples < grid.samples();
  if (stopped) return nothing;
  return {static_cast<int>(result.status), result.samples, result.time, result.samples > 0 ? summary : nothing.summary};
}

/// All jobs of one level that can go side by side, in groups of as many as there are lanes; the last group is filled
/// up.
template <typename Space>
void run_in_lanes(const TaskModel<Space>& model, const AnyPath<Space>& path, const TimeGrid<double>& grid,
                  const std::vector<Job<Space>>& jobs, Level level, const std::atomic<bool>& stop, Outcome* outcomes) {
  const auto lanes = static_cast<std::size_t>(model.lanes());
  std::vector<std::size_t> members;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    const Job<Space>& job = jobs[i];
    if (job.scheme->level() == level && runs_in_lanes(*job.scheme) && job.buffers.t == nullptr) members.push_back(i);
  }
  std::vector<const PyScheme*> schemes(lanes);
  std::vector<Joints> starts(lanes);
  std::vector<Outcome> results(lanes, Outcome::of_nothing());
  for (std::size_t first = 0; first < members.size() && !stop.load(std::memory_order_relaxed); first += lanes) {
    const std::size_t last = std::min(first + lanes, members.size());
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const Job<Space>& job = jobs[members[std::min(first + lane, last - 1)]];
      schemes[lane] = job.scheme;
      starts[lane] = job.q0;
    }
    model.run_in_lanes(path, grid, schemes.data(), starts.data(), stop, results.data());
    for (std::size_t i = first; i < last; ++i) outcomes[members[i]] = results[i - first];
  }
}

}  // namespace

template <typename Space>
void sweep(const TaskModel<Space>& model, const AnyPath<Space>& path, const TimeGrid<double>& grid,
           const std::vector<Job<Space>>& jobs, const std::atomic<bool>& stop, Outcome* outcomes) {
  std::fill_n(outcomes, jobs.size(), Outcome::of_nothing());
  if (model.lanes() > 1) {
    run_in_lanes(model, path, grid, jobs, Level::kVelocity, stop, outcomes);
    run_in_lanes(model, path, grid, jobs, Level::kAcceleration, stop, outcomes);
  }
  for (std::size_t i = 0; i < jobs.size() && !stop.load(std::memory_order_relaxed); ++i) {
    if (outcomes[i].status == Outcome::kNotRun) outcomes[i] = run(model, path, grid, jobs[i], stop);
  }
}

template void sweep(const TaskModel<Position<2>>&, const AnyPath<Position<2>>&, const TimeGrid<double>&,
                    const std::vector<Job<Position<2>>>&, const std::atomic<bool>&, Outcome*);
template void sweep(const TaskModel<PlanarPose>&, const AnyPath<PlanarPose>&, const TimeGrid<double>&,
                    const std::vector<Job<PlanarPose>>&, const std::atomic<bool>&, Outcome*);
template void sweep(const TaskModel<Position<3>>&, const AnyPath<Position<3>>&, const TimeGrid<double>&,
                    const std::vector<Job<Position<3>>>&, const std::atomic<bool>&, Outcome*);
template void sweep(const TaskModel<Pose>&, const AnyPath<Pose>&, const TimeGrid<double>&,
                    const std::vector<Job<Pose>>&, const std::atomic<bool>&, Outcome*);

}  // namespace fpbm::bindings
