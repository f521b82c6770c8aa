#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "fpbm/core/detail/validation.hpp"
#include "fpbm/core/status.hpp"
#include "fpbm/model/kinematics.hpp"
#include "fpbm/path/detail/timed_path.hpp"
#include "fpbm/path/detail/tip_bounds.hpp"
#include "fpbm/path/fastest_clock.hpp"
#include "fpbm/path/spline.hpp"
#include "fpbm/simulate/detail/anchored_path.hpp"
#include "fpbm/simulate/detail/motion.hpp"
#include "fpbm/simulate/detail/motion_differences.hpp"
#include "fpbm/simulate/rollout.hpp"
#include "fpbm/simulate/time_grid.hpp"

namespace fpbm {

/// Options of fastest().
struct FastestOptions {
  double dt = 1e-3;      ///< Time between samples [s]; the motion lasts a multiple of dt.
  TipBounds<> tip = {};  ///< Bounds on velocity and acceleration of the tip; angular bounds are not read.
};

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

/// The clock of FastestClock for joint positions along a path, slowed so that the motion lasts a multiple of dt and
/// keeps the bounds by differences. bounds: Bounds, of which the bounds on speeds bound the clock. Throws
/// std::invalid_argument as FastestClock does, and unless the path begins and ends at rest with zero acceleration.
template <int N, typename Path, typename Kept>
[[nodiscard]] FastestClock fastest_clock(const Spline<N>& joints, const Path& path, const JointLimits<N>& limits,
                                         Kept& bounds, const FastestOptions& options) {
  using Space = typename Path::Space;
  constexpr double kRest = 1e-9;  // [m, rad], for the round-off errors of splines.
  const double duration = path.duration();
  for (const double end : {0.0, duration}) {
    const Reference<Space> at = path.sample(end);
    if (!(duration * (at.xd.norm() + duration * at.xdd.norm()) < kRest)) {
      validation::reject("path", ": must begin and end at rest with zero acceleration: use the time law Quintic");
    }
  }
  const TipBounds<>& tip = options.tip;
  const bool bounds_tip = std::isfinite(tip.velocity) || std::isfinite(tip.acceleration);
  const auto add = [&](double p, const Vector<N>& q, const Vector<N>& dq, ClockBounds& place) {
    if (!bounds.empty()) place.add_speed(bounds.speed_ratio(q, dq));
    if (!bounds_tip) return;
    constexpr int kLinear = Space::kRows - Space::kTurns;
    const Reference<Space> at = path.sample(p);
    place.add_tip(at.xd.template head<kLinear>(), at.xdd.template head<kLinear>(), tip.velocity, tip.acceleration);
  };
  FastestClock clock(joints, limits, add);
  const auto stretch = [&](double factor) {
    clock.stretch(std::ceil(factor * clock.duration() / options.dt) * options.dt);
  };
  stretch(1.0);
  // Few motions exceed a bound between the checks of FastestClock. After one round, no random motion does.
  constexpr int kRounds = 5;
  for (int round = 0; round < kRounds; ++round) {
    const double excess = excess_of_differences(joints, clock, limits, options.dt);
    if (!(excess > 1.0)) break;
    stretch(excess);
  }
  return clock;
}

/// Calls `record(const Sample&)` for each time of a motion along a joint path with a clock, from the start of the path.
template <typename Arm, typename Path, typename Recorder>
RolloutResult<Arm::kDof> play(const Arm& arm, const Path& path, const Spline<Arm::kDof>& joints,
                              const FastestClock& clock, const TimeGrid<double>& grid, Recorder&& record) {
  using Space = typename Path::Space;
  using JointVector = Vector<Arm::kDof>;
  Kinematics<Space, Arm::kDof> kinematics;
  arm.kinematics(joints.at(0.0).x, kinematics);
  AnchoredPath<Path> references(path, kinematics.tip);
  RolloutResult<Arm::kDof> result{};
  for (int k = 0; k < grid.samples(); ++k) {
    const double t = grid.time(k);
    const Phase<double> phase = clock.at(t);
    const double square = phase.sd * phase.sd;
    const auto at = joints.at(phase.s);
    const JointVector qd = at.xd * phase.sd;
    const JointVector qdd = at.xdd * square + at.xd * phase.sdd;
    arm.kinematics(at.x, kinematics);
    Reference<Space> reference = references.motion(phase.s, phase.s);
    reference.xdd = reference.xdd * square + reference.xd * phase.sdd;
    reference.xd *= phase.sd;
    result = {Status::kOk, t, {at.x, qd}, k + 1};
    if (!show(record, Sample<Space, Arm::kDof>{k, t, at.x, qd, qdd, kinematics.tip, reference,
                                               task_error(kinematics, reference.x), first_rows(kinematics)})) {
      break;
    }
  }
  return result;
}

/// Moves an arm along a path in the least time within its joint limits: the joint positions of a velocity-level scheme
/// along the path (rollout()), with the clock of FastestClock. The tip stays on the path.
///
/// The duration of the path has no effect, except on null-space motions. The path must begin and end at rest, also with
/// zero acceleration, as with the time law Quintic or as Waypoints do. `record(const Sample&)` is called for each
/// sample. If the arm cannot follow the path, nothing is recorded, and the result is the result of rollout(): its time
/// is the time of the path that can be followed. Throws std::invalid_argument as rollout() and fastest_clock() do.
/// Allocates.
template <typename Arm, typename Path, typename Scheme, typename Kept, typename Recorder>
RolloutResult<Arm::kDof> fastest(const Arm& arm, const Path& path, const Scheme& scheme, const Vector<Arm::kDof>& q0,
                                 const JointLimits<Arm::kDof>& limits, Kept&& bounds, const FastestOptions& options,
                                 Recorder&& record) {
  static_assert(Scheme::kLevel == Level::kVelocity, "fastest() needs a scheme at velocity level");
  validation::require_positive("dt", options.dt);
  const auto path_of = joint_path<Arm::kDof>(path.duration(), [&](int intervals, std::vector<Vector<Arm::kDof>>& q) {
    const TimeGrid<double> nodes(path.duration(), path.duration() / intervals);
    const auto add = [&](const auto& sample) {
      if (!bounds.empty()) bounds.require(sample.q);
      q.push_back(sample.q);
      return true;
    };
    return rollout(arm, path, scheme, State<Arm::kDof>{q0, filled<Vector<Arm::kDof>>(q0.size())}, nodes, add);
  });
  if (!path_of.joints) return path_of.result;
  const FastestClock clock = fastest_clock(*path_of.joints, path, limits, bounds, options);
  return play(arm, path, *path_of.joints, clock, TimeGrid<double>(clock.duration(), options.dt), record);
}

}  // namespace fpbm
