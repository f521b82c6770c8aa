#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "fpbm/core/detail/validation.hpp"
#include "fpbm/core/status.hpp"
#include "fpbm/model/kinematics.hpp"
#include "fpbm/path/detail/fastest_clock.hpp"
#include "fpbm/path/detail/moving_ends.hpp"
#include "fpbm/path/spline.hpp"
#include "fpbm/simulate/detail/anchored_path.hpp"
#include "fpbm/simulate/detail/joint_path.hpp"
#include "fpbm/simulate/detail/motion.hpp"
#include "fpbm/simulate/detail/motion_differences.hpp"
#include "fpbm/simulate/detail/moving_joints.hpp"
#include "fpbm/simulate/detail/planned_stops.hpp"
#include "fpbm/simulate/rollout.hpp"
#include "fpbm/simulate/time_grid.hpp"

namespace fpbm {

/// Options of fastest() and kept_path().
struct FastestOptions {
  double dt = 1e-3;  ///< Time between samples [s]; the motion lasts a multiple of dt.
  double tip_speed = std::numeric_limits<double>::infinity();         ///< Bound on the speed of the tip [m/s].
  double tip_acceleration = std::numeric_limits<double>::infinity();  ///< Bound on the acceleration of the tip [m/s²].
  double reserve = 0.0;      ///< The motion keeps the bounds of the joints also if it is faster by this fraction.
  double start_speed = 0.0;  ///< Speed of the tip along the path at the start [m/s]; 0: at rest, as for kept_path().
  double end_speed = 0.0;    ///< Speed of the tip along the path at the end [m/s].
};

/// Whether the tip moves at the start and at the end. Throws std::invalid_argument unless the speeds are zero, or
/// finite and at least kLeastSpeed.
[[nodiscard]] inline std::array<bool, 2> moves_at_ends(const FastestOptions& options) {
  constexpr double kLeastSpeed = 1e-5;  // [m/s]. At lower speeds, round-off errors of the clock lengthen the motion.
  const auto moves = [](const char* name, double speed) {
    validation::require_non_negative(name, speed);
    if (speed > 0.0 && speed < kLeastSpeed) validation::fail(name, speed, "0, or at least ", kLeastSpeed);
    return speed > 0.0;
  };
  return {moves("start_speed", options.start_speed), moves("end_speed", options.end_speed)};
}

/// The limits with a reserve: a motion within these limits that is faster by the fraction `reserve` keeps the limits.
template <int N>
[[nodiscard]] JointLimits<N> with_reserve(JointLimits<N> limits, double reserve) {
  validation::require_non_negative("reserve", reserve);
  const double slower = 1.0 / (1.0 + reserve);
  limits.velocity *= slower;
  limits.velocity_offset *= slower;
  limits.acceleration *= slower * slower;
  limits.deceleration *= slower * slower;
  limits.jerk *= slower * slower * slower;
  return limits;
}

/// Throws std::invalid_argument if the bounds do not admit the posture q at a fraction of a path.
template <typename Kept, typename JointVector>
void require_posture(Kept& bounds, const JointVector& q, double fraction) {
#if defined(__cpp_exceptions)
  try {
    bounds.require(q);
  } catch (const std::invalid_argument& error) {
    validation::reject("path", " at the fraction ", fraction, ": ", error.what());
  }
#else
  bounds.require(q);
#endif
}

/// The clock of FastestClock for joint positions along a path, slowed so that the motion lasts a multiple of dt and
/// keeps the bounds by differences. bounds: Bounds, of which the bounds on speeds and torques bound the clock. slower:
/// where the clock is slower, or null. Throws std::invalid_argument as FastestClock does, if the arm cannot hold a
/// posture along the path, and unless the path is at rest with zero acceleration at an end without a given speed.
template <int N, typename Path, typename Kept>
[[nodiscard]] FastestClock fastest_clock(const Spline<N>& joints, const Path& path, const JointLimits<N>& limits,
                                         Kept& bounds, const FastestOptions& options,
                                         const SlowerIntervals* slower = nullptr) {
  const JointLimits<N> reserved = with_reserve(limits.complete(), options.reserve);
  using Space = typename Path::Space;
  constexpr int kLinear = Space::kRows - Space::kTurns;
  const std::array<bool, 2> moving = moves_at_ends(options);
  GivenSpeeds given{{options.start_speed, options.end_speed}};
  for (const std::size_t i : {0U, 1U}) {
    const double end = i == 0 ? 0.0 : path.duration();
    if (moving[i]) {
      const double slope = path.sample(end).xd.template head<kLinear>().norm();
      if (!(slope > 0.0)) validation::fail(GivenSpeeds::kNames[i], given.speed[i], "0: a kept path is at rest there");
      given.rate[i] = given.speed[i] / slope;
    } else {
      require_rest(path, end);
    }
  }
  const bool bounds_tip = std::isfinite(options.tip_speed) || std::isfinite(options.tip_acceleration);
  const double faster = 1.0 + options.reserve;
  const auto add = [&](double p, const auto& d, ClockBounds& place) {
    if (!bounds.empty()) {
      place.add_speed(faster * bounds.speed_ratio(d[0], d[1]));
      auto torques = clock_torques(bounds, d[0], d[1], d[2], faster);
      constexpr double kHeld = 0.9999;  // Nearer to a bound, the arm would hardly move.
      for (std::size_t i = 0; i < torques.size(); ++i) {
        if (std::abs(torques[i].rest) <= kHeld) continue;
        require_posture(bounds, d[0], p / path.duration());
        validation::reject("path", " at the fraction ", p / path.duration(), ": joint ",
                           i % static_cast<std::size_t>(d[0].size()), " needs the fraction ",
                           std::abs(torques[i].rest) / faster, " of the bound on its torque at rest: must be at most ",
                           kHeld / faster, ", with the reserve");
      }
      place.add_torques(std::move(torques));
    }
    if (bounds_tip) {
      const Reference<Space> at = path.sample(p);
      place.add_tip(at.xd.template head<kLinear>(), at.xdd.template head<kLinear>(), options.tip_speed,
                    options.tip_acceleration);
    }
    if (const double factor = slower == nullptr ? 1.0 : slower->at(p); factor > 1.0) place.scale(factor * factor);
  };
  FastestClock clock(joints, reserved, add, given);
  const auto stretch = [&](double factor) {
    clock.stretch(std::ceil(factor * clock.duration() / options.dt) * options.dt);
  };
  stretch(1.0);
  // Few motions exceed a bound between the checks of FastestClock. After one round, no random motion does.
  // With given speeds, a longer motion is not slower everywhere.
  const int rounds = given.any() ? 50 : 5;
  for (int round = 0; round < rounds; ++round) {
    const double excess = std::max(excess_of_differences(joints, clock, reserved, options.dt, moving),
                                   excess_of_torques(joints, clock, bounds, faster, options.dt));
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
/// is the time of the path that can be followed. With options.start_speed or options.end_speed, the motion begins or
/// ends at this speed of the tip, and keeps its bounds from the first sample to the last. Throws std::invalid_argument
/// as rollout(), fastest_clock(), MovingEnds and moving_joints() do. Allocates.
template <typename Arm, typename Path, typename Scheme, typename Kept, typename Recorder>
RolloutResult<Arm::kDof> fastest(const Arm& arm, const Path& path, const Scheme& scheme, const Vector<Arm::kDof>& q0,
                                 const JointLimits<Arm::kDof>& limits, Kept&& bounds, const FastestOptions& options,
                                 Recorder&& record) {
  static_assert(Scheme::kLevel == Level::kVelocity, "a motion in the least time needs a scheme at velocity level");
  validation::require_positive("dt", options.dt);
  const std::array<bool, 2> moving = moves_at_ends(options);
  const auto path_of = joint_path_of(arm, path, scheme, q0);
  if (!path_of.joints) return path_of.result;
  for (const double p : path_of.joints->times()) {
    if (!bounds.empty()) require_posture(bounds, path_of.joints->at(p).x, p / path.duration());
  }
  const auto move = [&](const auto& along, const Spline<Arm::kDof>& joints) {
    const FastestClock clock = fastest_clock(joints, along, limits, bounds, options);
    return play(arm, along, joints, clock, TimeGrid<double>(clock.duration(), options.dt), record);
  };
  if (!moving[0] && !moving[1]) return move(path, *path_of.joints);
  const MovingEnds<Path> ends(path, moving);
  return move(ends, moving_joints(*path_of.joints, ends));
}

}  // namespace fpbm
