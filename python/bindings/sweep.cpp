#include "sweep.hpp"

#include <cstddef>

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

}  // namespace

template <typename Space>
void sweep(const TaskModel<Space>& model, const AnyPath<Space>& path, const TimeGrid<double>& grid,
           const std::vector<Job<Space>>& jobs, const std::atomic<bool>& stop, Outcome* outcomes) {
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    outcomes[i] = stop.load(std::memory_order_relaxed) ? Outcome::of_nothing() : run(model, path, grid, jobs[i], stop);
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
