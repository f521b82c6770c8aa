#include "motion.hpp"

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
JointPath<kDynamic> Motion<Space>::joint_path(double duration, double lasting) const {
  const double factor = lasting / duration;
  const AnyPath<Space> stretched(Stretched(path, factor));
  std::optional<StackOptions> tasks;
  if (stack != nullptr) {
    tasks = *stack;
    tasks->duration *= factor;
    for (TaskPath& each : tasks->paths) each.stretch(factor);
  }
  return fpbm::joint_path<kDynamic>(duration, [&](int intervals, std::vector<JointVector>& rows) {
    const double whole = tasks ? tasks->duration : stretched.duration();  // Equal to `lasting` up to round-off.
    const TimeGrid<double> grid_of_nodes(whole, whole / intervals);
    const Motion nodes{arm, stretched, scheme, start, grid_of_nodes, tasks ? &*tasks : nullptr};
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> q(nodes.grid.samples(), start.q.size());
    Output<Space> output;
    output.buffers.q = q.data();
    const auto result = nodes.simulate(output);
    for (Eigen::Index i = 0; i < result.samples; ++i) rows.emplace_back(q.row(i).transpose());
    return result;
  });
}

template <typename Space>
std::shared_ptr<const PlannedMotion> Motion<Space>::kept_motion(const JointLimits<kDynamic>& limits, AnyBounds bounds,
                                                                double duration, double shortest,
                                                                const FastestOptions& options) const {
  if (scheme.level != Level::kVelocity) {
    validation::reject("keep_path", " needs a scheme at velocity level, for example MVN() or WMVN(weights)");
  }
  constexpr double kAtRest = 1e-6;  // [rad/s]: decaying motions of a tracker that has stopped.
  if (start.qd.cwiseAbs().maxCoeff() > kAtRest) {
    validation::reject("qd0", ": must be zero with keep_path: stop the arm first");
  }
  const auto joints_of = [&](double lasting) { return joint_path(duration, lasting); };
  return fpbm::kept_motion(path, duration, joints_of, limits, bounds, shortest, options);
}

template struct Motion<Position<2>>;
template struct Motion<PlanarPose>;
template struct Motion<Position<3>>;
template struct Motion<Pose>;

}  // namespace fpbm::bindings
