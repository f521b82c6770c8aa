#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "fpbm/core/detail/validation.hpp"
#include "fpbm/core/status.hpp"
#include "fpbm/path/spline.hpp"
#include "fpbm/simulate/rollout.hpp"
#include "fpbm/simulate/time_grid.hpp"

namespace fpbm {

/// A joint path, and the result of the motion along the path. If the arm cannot follow the path, the joint path is
/// empty, and the time of the result is the time of the path that can be followed.
template <int N>
struct JointPath {
  RolloutResult<N> result;
  std::optional<Spline<N>> joints;
};

/// The joint positions of a motion without limits along a path of a duration [s], as a spline.
/// nodes(intervals, q) executes the motion with this number of equal steps, adds the positions to q, and returns the
/// result. The number of intervals is doubled until the motion follows the path, and the positions in the middle of the
/// intervals are within kAccuracy of the spline.
template <int N, typename Nodes>
[[nodiscard]] JointPath<N> joint_path(double duration, const Nodes& nodes) {
  constexpr double kAccuracy = 1e-8;  // [rad] or [m]; the tip is then within 1e-8 m of most paths.
  constexpr int kLeast = 600;
  constexpr int kMost = 9600;
  JointPath<N> path{};
  for (int intervals = kLeast; intervals <= kMost; intervals *= 2) {
    std::vector<Vector<N>> q;
    path.result = nodes(intervals, q);
    if (failed(path.result.status)) continue;  // Maybe the steps are too long.
    std::vector<double> p(q.size());
    for (std::size_t i = 0; i < p.size(); ++i) p[i] = static_cast<double>(i) * duration / intervals;
    double deviation = path.joints ? 0.0 : std::numeric_limits<double>::infinity();
    for (std::size_t i = 1; path.joints && i < p.size(); i += 2) {
      deviation = std::max(deviation, (path.joints->at(p[i]).x - q[i]).cwiseAbs().maxCoeff());
    }
    if (deviation < kAccuracy) break;
    path.joints = Spline<N>(q, p);
  }
  return path;
}

/// joint_path() of a scheme at velocity level. duration: of the parameter of the result [s].
template <typename Arm, typename Path, typename Scheme>
[[nodiscard]] JointPath<Arm::kDof> joint_path_of(const Arm& arm, const Path& path, const Scheme& scheme,
                                                 const Vector<Arm::kDof>& q0, double duration) {
  static_assert(Scheme::kLevel == Level::kVelocity, "a motion in the least time needs a scheme at velocity level");
  return joint_path<Arm::kDof>(duration, [&](int intervals, std::vector<Vector<Arm::kDof>>& q) {
    const TimeGrid<double> nodes(path.duration(), path.duration() / intervals);
    const auto add = [&](const auto& sample) {
      q.push_back(sample.q);
      return true;
    };
    return rollout(arm, path, scheme, State<Arm::kDof>{q0, filled<Vector<Arm::kDof>>(q0.size())}, nodes, add);
  });
}

/// Throws std::invalid_argument if the arm cannot follow a path of a duration [s].
template <int N>
void require_followed(const JointPath<N>& along, double duration) {
  if (along.joints) return;
  const Status status = along.result.status;
  validation::reject("path", ": can be followed to the fraction ", along.result.time / duration,
                     " only: ", message(status), ". ", advice(status));
}

}  // namespace fpbm
