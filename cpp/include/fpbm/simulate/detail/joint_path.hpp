#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "fpbm/core/detail/validation.hpp"
#include "fpbm/core/status.hpp"
#include "fpbm/path/detail/timed_path.hpp"
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

/// Joint positions of a motion at equal steps, and the velocity and the acceleration at the end, where the joints of
/// schemes at acceleration level may move in the null space.
template <int N>
struct JointNodes {
  std::vector<Vector<N>> q;       ///< [rad] or [m]
  typename Spline<N>::Rates end;  ///< Derivatives with respect to the parameter of the steps.

  /// The spline of the positions. duration: of the motion [s].
  [[nodiscard]] Spline<N> spline(double duration) const {
    std::vector<double> times(q.size());
    for (std::size_t i = 0; i < q.size(); ++i) times[i] = place(i) * duration;
    constexpr double kRest = 1e-6;  // [rad] or [m] in the duration: round-off errors and decaying errors of the tip.
    const typename Spline<N>::Rates rest = Spline<N>::Rates::Zero(2, end.cols());
    return Spline<N>(q, times, rest, duration * end.row(0).cwiseAbs().maxCoeff() < kRest ? rest : end);
  }

  /// The positions of a motion with a clock at as many equal steps of the path's own time. duration: of the path [s].
  [[nodiscard]] JointNodes at_places(const FastestClock& clock, double duration) const {
    const Spline<N> motion = spline(clock.duration());
    JointNodes places{q, end};
    for (std::size_t i = 0; i < q.size(); ++i) places.q[i] = motion.at(clock.time_at(place(i) * duration)).x;
    const Phase<double> last = clock.at(clock.duration());
    places.end.row(0) /= last.sd;
    places.end.row(1) = (end.row(1) - places.end.row(0) * last.sdd) / (last.sd * last.sd);
    return places;
  }

 private:
  /// Position i as a fraction of all steps.
  [[nodiscard]] double place(std::size_t i) const noexcept {
    return static_cast<double>(i) / static_cast<double>(q.size() - 1);
  }
};

/// Sets the result of a motion along positions q whose steps are too long: the task is lost where a joint moves by the
/// longest step.
template <int N>
void set_unresolved(RolloutResult<N>& result, const std::vector<Vector<N>>& q) {
  double longest = 0.0;
  const double duration = result.time;
  for (std::size_t i = 1; i < q.size(); ++i) {
    const double length = (q[i] - q[i - 1]).cwiseAbs().maxCoeff();
    if (length <= longest) continue;
    longest = length;
    result.time = duration * static_cast<double>(i) / static_cast<double>(q.size() - 1);
    result.last.q = q[i];
  }
  result.status = Status::kTaskLost;
}

/// The joint positions of a motion without limits along a path of a duration [s], as a spline.
/// run(intervals, nodes) executes the motion with this number of equal steps, sets the nodes, and returns the result.
/// The number of intervals is doubled until the motion follows the path, and the positions in the middle of the
/// intervals are within the accuracy of the spline. If they are not within the tolerance of the last spline but one,
/// the arm cannot follow the path: it passes too near a singular posture. with_clock: whether the motion has the clock
/// of a plan.
template <int N, typename Run>
[[nodiscard]] JointPath<N> joint_path(double duration, bool with_clock, const Run& run) {
  // [rad] or [m]. With the accuracy 1e-8, the tip is within 1e-8 m of most paths. With the tolerance 3e-3, the tip
  // leaves a path of bench/fastest.py by 1e-5 m. A clock has discontinuous jerks: a motion with a clock needs many more
  // intervals for less than 1e-4.
  const double accuracy = with_clock ? 1e-4 : 1e-8;
  const double tolerance = with_clock ? 1e-2 : 3e-4;
  constexpr int kLeast = 600;
  constexpr int kMost = 19200;  // With 9600, the tip leaves paths of bench/fastest.py by 2e-6 and 1e-5.
  JointPath<N> path{};
  std::optional<Spline<N>> spline;
  for (int intervals = kLeast; intervals <= kMost; intervals *= 2) {
    JointNodes<N> nodes;
    path.result = run(intervals, nodes);
    if (failed(path.result.status)) continue;  // Maybe the steps are too long.
    double deviation = spline ? 0.0 : std::numeric_limits<double>::infinity();
    for (std::size_t i = 1; spline && i < nodes.q.size(); i += 2) {
      const double p = static_cast<double>(i) * duration / intervals;
      deviation = std::max(deviation, (spline->at(p).x - nodes.q[i]).cwiseAbs().maxCoeff());
    }
    if (deviation < accuracy) {
      path.joints = std::move(spline);
      break;
    }
    spline = nodes.spline(duration);
    path.joints = deviation < tolerance ? spline : std::nullopt;
    if (!path.joints) set_unresolved(path.result, nodes.q);
  }
  return path;
}

/// joint_path() of the motion of a scheme from rest. plan: if given, with the clock of this plan.
template <typename Arm, typename Path, typename Scheme>
[[nodiscard]] JointPath<Arm::kDof> joint_path_of(const Arm& arm, const Path& path, const Scheme& scheme,
                                                 const Vector<Arm::kDof>& q0,
                                                 const std::shared_ptr<const PlannedMotion>& plan = nullptr) {
  using JointVector = Vector<Arm::kDof>;
  const TimedPath<Path> timed(path, plan);
  const auto run = [&](int intervals, JointNodes<Arm::kDof>& nodes) {
    const auto add = [&](const auto& sample) {
      nodes.q.push_back(sample.q);
      nodes.end = Spline<Arm::kDof>::Rates::Zero(2, q0.size());
      if constexpr (Scheme::kLevel == Level::kAcceleration) nodes.end << sample.qd.transpose(), sample.qdd.transpose();
      return true;
    };
    const TimeGrid<double> grid(timed.duration(), timed.duration() / intervals);
    const auto result = rollout(arm, timed, scheme, State<Arm::kDof>{q0, filled<JointVector>(q0.size())}, grid, add);
    if (plan && !failed(result.status)) nodes = nodes.at_places(plan->clock, path.duration());
    return result;
  };
  return joint_path<Arm::kDof>(path.duration(), plan != nullptr, run);
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
