#include "motion.hpp"

#include <array>
#include <memory>
#include <optional>
#include <vector>

namespace fpbm::bindings {

template <typename Space>
RolloutResult<kDynamic> Motion<Space>::simulate(const Output<Space>& output) const {
  if (stack != nullptr) return simulate_stack(output);
  Recorder<Space> record(output, scheme.level);
  const auto result = std::visit([&](const auto& any) { return rollout(*arm, path, any, start, grid, record); },
                                 scheme.make<Space>(*arm));
  record.finish();
  return result;
}

template <typename Space>
FastestClock Motion<Space>::clock(const Spline<kDynamic>& joints, const JointLimits<kDynamic>& limits,
                                  AnyBounds& bounds, const FastestOptions& options) const {
  return fastest_clock(joints, path, limits, bounds, options);
}

template <typename Space>
JointPath<kDynamic> Motion<Space>::joint_path(double duration, const std::shared_ptr<const PlannedMotion>& plan) const {
  const AnyPath<Space> timed = plan ? AnyPath<Space>(TimedPath(path, plan)) : path;
  std::optional<StackOptions> tasks;
  if (stack != nullptr) {
    tasks = *stack;
    if (plan) {
      tasks->duration = timed.duration();
      for (TaskPath& each : tasks->paths) each.keep(plan);
    }
  }
  return fpbm::joint_path<kDynamic>(duration, plan != nullptr, [&](int intervals, JointNodes<kDynamic>& nodes) {
    const double whole = tasks ? tasks->duration : timed.duration();
    const TimeGrid<double> grid_of_nodes(whole, whole / intervals);
    const Motion motion{arm, timed, scheme, start, grid_of_nodes, tasks ? &*tasks : nullptr};
    using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    std::array<Rows, 3> rows;  // Positions, velocities and accelerations.
    for (Rows& each : rows) each.resize(motion.grid.samples(), start.q.size());
    Output<Space> output;
    output.buffers.q = rows[0].data();
    output.buffers.qd = rows[1].data();
    output.buffers.qdd = rows[2].data();
    const auto result = motion.simulate(output);
    for (Eigen::Index i = 0; i < result.samples; ++i) nodes.q.emplace_back(rows[0].row(i).transpose());
    if (failed(result.status)) return result;
    nodes.end = Spline<kDynamic>::Rates::Zero(2, start.q.size());
    if (scheme.level == Level::kAcceleration) nodes.end << rows[1].bottomRows(1), rows[2].bottomRows(1);
    if (plan) nodes = nodes.at_places(plan->clock, duration);
    return result;
  });
}

template <typename Space>
std::shared_ptr<const PlannedMotion> Motion<Space>::kept_motion(const JointLimits<kDynamic>& limits, AnyBounds bounds,
                                                                double duration, double shortest,
                                                                const FastestOptions& options) const {
  constexpr double kAtRest = 1e-6;  // [rad/s]: decaying motions of a tracker that has stopped.
  if (start.qd.cwiseAbs().maxCoeff() > kAtRest) {
    validation::reject("qd0", ": must be zero with keep_path: stop the arm first");
  }
  const auto joints_of = [&](const auto& plan) { return joint_path(duration, plan); };
  return fpbm::kept_motion(path, duration, joints_of, limits, bounds, shortest, options);
}

template struct Motion<Position<2>>;
template struct Motion<PlanarPose>;
template struct Motion<Position<3>>;
template struct Motion<Pose>;

}  // namespace fpbm::bindings
