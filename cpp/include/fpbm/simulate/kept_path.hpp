#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "fpbm/path/detail/kept_motion.hpp"
#include "fpbm/path/detail/timed_path.hpp"
#include "fpbm/simulate/detail/joint_path.hpp"
#include "fpbm/simulate/fastest.hpp"

namespace fpbm {

/// The plan of a motion along a path with the clock of fastest(), of joint positions along the path.
template <int N, typename Path, typename Kept>
[[nodiscard]] std::shared_ptr<const PlannedMotion> planned_motion(const Spline<N>& joints, const Path& path,
                                                                  const JointLimits<N>& limits, Kept& bounds,
                                                                  double shortest, const FastestOptions& options) {
  constexpr double kStep = 0.01;  // [s]: at 2 rad/s and 15 rad/s², interpolated postures are exact to 2e-4 rad.
  SlowerIntervals slower(path.duration());
  const auto fastest = [&] {
    FastestClock clock = fastest_clock(joints, path, limits, bounds, options, &slower);
    if (shortest > clock.duration()) clock.stretch(std::ceil(shortest / options.dt - 1e-9) * options.dt);
    return clock;
  };
  FastestClock clock = fastest();
  if (bounds.bounds_torques()) {
    constexpr int kRounds = 8;
    constexpr int kFew = 2;  // Certificates are not exact: they refuse few stops, also of slow motions.
    const Limits<Level::kAcceleration, N> of_ticks(limits, options.dt);
    for (int round = 0, refused = kFew + 1; round < kRounds && refused > kFew; ++round) {
      refused = slow_down(slower, joints, clock, bounds, of_ticks, 1.0 + options.reserve);
      if (refused > 0) clock = fastest();
    }
  }
  const auto steps = static_cast<int>(std::ceil(clock.duration() / kStep)) + 1;
  std::vector<double> postures;
  std::vector<double> closeness;
  for (int i = 0; i <= steps; ++i) {
    const Vector<N> q = joints.at(clock.at(i * kStep).s).x;
    postures.insert(postures.end(), q.data(), q.data() + q.size());
    closeness.push_back(bounds.closeness(q, KeptMotion::kRange));
  }
  const double ramp = least_ramp(joints, clock, limits, bounds, options.dt);
  return std::make_shared<const PlannedMotion>(std::move(clock), ramp, kStep, std::move(postures),
                                               std::move(closeness));
}

/// The plan of a motion along a path of a duration [s], which a PathFollower keeps.
///
/// joints_of(plan): JointPath of the path with the clock of a plan, or null, with its own time law. Accelerations of a
/// scheme and motions in the null space depend on the clock: the plan is repeated with the clock found, until the joint
/// path is the same. shortest: least duration of the motion [s]. bounds: Bounds.
template <int N, typename Path, typename JointsOf, typename Kept>
[[nodiscard]] std::shared_ptr<const PlannedMotion> kept_motion(const Path& path, double duration,
                                                               const JointsOf& joints_of, const JointLimits<N>& limits,
                                                               Kept& bounds, double shortest,
                                                               const FastestOptions& options) {
  constexpr int kRounds = 8;
  constexpr int kPlaces = 100;
  constexpr double kSame = 1e-4;  // [rad] or [m]; each round reduces the deviation to about a tenth.
  std::optional<Spline<N>> joints;
  std::shared_ptr<const PlannedMotion> plan;
  for (int round = 0; round < kRounds; ++round) {
    JointPath<N> along = joints_of(plan);
    require_followed(along, plan ? plan->clock.duration() : duration);
    double deviation = joints ? 0.0 : std::numeric_limits<double>::infinity();
    for (int k = 0; joints && k <= kPlaces; ++k) {
      const double p = duration * k / kPlaces;
      deviation = std::max(deviation, (along.joints->at(p).x - joints->at(p).x).cwiseAbs().maxCoeff());
    }
    if (deviation < kSame) break;
    joints = std::move(along.joints);
    plan = planned_motion(*joints, path, limits, bounds, shortest, options);
  }
  return plan;
}

/// A path for a PathFollower that keeps the path, from the posture q0 at rest: `path` with the clock of fastest(), at
/// least as long as `path` (docs/paths.md, In a control loop).
///
/// options.reserve is for disturbances and an operator; usual value: 0.05. The scheme is the scheme of the tracker.
/// The path must begin and end at rest with zero acceleration. Throws std::invalid_argument if an argument is out of
/// range, or the arm cannot follow the path. Allocates.
template <typename Arm, typename Path, typename Scheme, typename Kept>
[[nodiscard]] TimedPath<Path> kept_path(const Arm& arm, const Path& path, const Scheme& scheme,
                                        const Vector<Arm::kDof>& q0, const JointLimits<Arm::kDof>& limits,
                                        Kept&& bounds, const FastestOptions& options) {
  const double duration = path.duration();
  const auto joints_of = [&](const auto& plan) { return joint_path_of(arm, path, scheme, q0, plan); };
  return {path, kept_motion(path, duration, joints_of, limits, bounds, duration, options)};
}

}  // namespace fpbm
