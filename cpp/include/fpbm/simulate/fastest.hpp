#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "fpbm/core/detail/validation.hpp"
#include "fpbm/core/status.hpp"
#include "fpbm/model/kinematics.hpp"
#include "fpbm/path/detail/tip_bounds.hpp"
#include "fpbm/path/fastest.hpp"
#include "fpbm/path/spline.hpp"
#include "fpbm/simulate/detail/anchored_path.hpp"
#include "fpbm/simulate/detail/motion.hpp"
#include "fpbm/simulate/rollout.hpp"
#include "fpbm/simulate/time_grid.hpp"

namespace fpbm {

/// Options of fastest().
struct FastestOptions {
  double dt = 1e-3;      ///< Time between samples [s]; the motion lasts a multiple of dt.
  int intervals = 600;   ///< Intervals of the joint path and of its clock.
  TipBounds<> tip = {};  ///< Bounds on velocity and acceleration of the tip; angular bounds are not read.
};

/// Joint positions q along a path of a duration [s], at equal intervals of the path's time, as a spline.
template <int N>
[[nodiscard]] Spline<N> joint_spline(const std::vector<Vector<N>>& q, double duration) {
  std::vector<double> p(q.size());
  for (std::size_t i = 0; i < p.size(); ++i) {
    p[i] = static_cast<double>(i) * duration / static_cast<double>(p.size() - 1);
  }
  return Spline<N>(q, p);
}

/// The factor by which a clock must be slower, so that the differences of positions at every dt [s] keep the bounds on
/// velocity, acceleration and jerk.
template <int N>
[[nodiscard]] double excess_of_differences(const Spline<N>& joints, const FastestClock& clock,
                                           const JointLimits<N>& limits, double dt) {
  const JointLimits<N> complete = limits.complete();
  const auto ratio = [](const Vector<N>& difference, const Vector<N>& bound) {
    return difference.cwiseAbs().cwiseQuotient(bound).maxCoeff();
  };
  // Before its start and after its end, the motion is at rest.
  Vector<N> q = joints.at(clock.at(0.0).s).x;
  Vector<N> velocity = filled<Vector<N>>(q.size());
  Vector<N> acceleration = velocity;
  double excess = 0.0;
  const auto ticks = static_cast<int>(std::lround(clock.duration() / dt));
  for (int k = 1; k <= ticks + 2; ++k) {
    const Vector<N> next = joints.at(clock.at(k * dt).s).x;
    const Vector<N> v = (next - q) / dt;
    const Vector<N> a = (v - velocity) / dt;
    excess = std::max({excess, ratio(v, complete.velocity), std::sqrt(ratio(a, complete.acceleration)),
                       std::cbrt(ratio((a - acceleration) / dt, complete.jerk))});
    q = next;
    velocity = v;
    acceleration = a;
  }
  return excess;
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
  if (options.intervals < 2) validation::fail("intervals", options.intervals, "at least 2");
  std::vector<Vector<Arm::kDof>> q;
  const TimeGrid<double> nodes(path.duration(), path.duration() / options.intervals);
  const auto add = [&q](const auto& sample) {
    q.push_back(sample.q);
    return true;
  };
  const auto along = rollout(arm, path, scheme, State<Arm::kDof>{q0, filled<Vector<Arm::kDof>>(q0.size())}, nodes, add);
  if (failed(along.status)) return along;
  if (!bounds.empty()) {
    for (const auto& posture : q) bounds.require(posture);
  }
  const Spline<Arm::kDof> joints = joint_spline(q, path.duration());
  const FastestClock clock = fastest_clock(joints, path, limits, bounds, options);
  return play(arm, path, joints, clock, TimeGrid<double>(clock.duration(), options.dt), record);
}

}  // namespace fpbm
