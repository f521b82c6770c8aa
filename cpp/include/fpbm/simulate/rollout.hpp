#pragma once

#include <type_traits>

#include "fpbm/core/detail/mask.hpp"
#include "fpbm/core/detail/validation.hpp"
#include "fpbm/core/status.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/model/detail/continuous_joints.hpp"
#include "fpbm/model/kinematics.hpp"
#include "fpbm/path/reference.hpp"
#include "fpbm/scheme/detail/set_damping.hpp"
#include "fpbm/simulate/detail/anchored_path.hpp"
#include "fpbm/simulate/detail/closed_loop.hpp"
#include "fpbm/simulate/detail/motion.hpp"
#include "fpbm/simulate/detail/rk4.hpp"
#include "fpbm/simulate/detail/watch.hpp"
#include "fpbm/simulate/time_grid.hpp"

namespace fpbm {

/// End of a rollout. If the rollout stopped early, the samples before the end are valid.
template <int N, typename Scalar = double>
struct RolloutResult {
  Status status;          ///< kOk, kCoarse or kDamped if the motion is complete; otherwise the reason for the stop.
  Number<Scalar> time;    ///< Time of the end [s].
  State<N, Scalar> last;  ///< Last valid state.
  int samples;            ///< Number of recorded samples.
};

/// Passes a sample to a recorder. Returns false if the recorder ends the motion.
template <typename Recorder, typename Sample>
[[nodiscard]] bool show(Recorder& record, const Sample& sample) {
  if constexpr (std::is_same_v<decltype(record(sample)), bool>) {
    return record(sample);
  } else {
    record(sample);
    return true;
  }
}

/// Integrates an arm with a scheme by RK4 at fixed steps: along a path, then for the time `hold` of the grid with the
/// reference at rest at the end of the path.
///
/// For a stack, the arm is a RobotTasks, the scheme is a ByLevels, and the path is in the space of the stack. Only the
/// errors of the first level decide whether the motion follows its reference.
///
/// The path is a displacement from the start position of the tip. If damping at a singular posture prevents the tip
/// from following its path, the motion stops with kTaskLost, whereas a Tracker continues. If the discretisation error
/// of the tip exceeds 1e-4 of the largest lever arm, the status is kCoarse; this error is an estimate, see TaskWatch.
/// Velocity-level schemes integrate q (start.qd is not read), acceleration-level schemes integrate q and qd.
/// `record(const Sample&)`, which must be noexcept, is called once per time of the grid. If `record` returns false, the
/// motion ends at this sample, and the status is not a failure. Throws std::invalid_argument if the scheme or start
/// does not suit the arm, the grid does not suit the path, or start is not finite. After the checks, nothing throws or
/// allocates, and the result reports failures.
///
/// With lanes, many motions run in parallel. The last q of a motion is NaN if its scheme fails or is damped, its tip
/// leaves its path, or its steps are too long. For its status and time, run a motion with NaN again without lanes.
template <typename Arm, typename Path, typename Scheme, typename Recorder>
RolloutResult<Arm::kDof, typename Arm::Scalar> rollout(const Arm& arm, const Path& path, const Scheme& given,
                                                       const State<Arm::kDof, typename Arm::Scalar>& start,
                                                       const TimeGrid<Number<typename Arm::Scalar>>& grid,
                                                       Recorder&& record) {
  using Scalar = typename Arm::Scalar;
  using Time = Number<Scalar>;
  using Space = typename Path::Space;
  using Loop = ClosedLoop<Arm, Scheme, Space>;
  using X = typename Loop::X;
  static_assert(std::is_same_v<typename Path::Scalar, Time>, "the path and the arm must have the same Scalar");

  if (grid.duration() != path.duration()) {
    validation::fail("grid duration", grid.duration(), "the duration of the path = ", path.duration());
  }
  given.require_dof(arm.dof());
  Scheme scheme = given;
  set_continuous_joints(scheme, continuous_joints(arm, 0), 0);
  validation::require_joint_vector("q0", start.q, arm.dof());
  X x(start.q.size(), Loop::kSecondOrder ? 2 : 1);
  x.col(0) = start.q;
  if constexpr (Loop::kSecondOrder) {
    validation::require_joint_vector("qd0", start.qd, arm.dof());
    x.col(1) = start.qd;
  }

  Loop loop{arm, scheme, {}, start, Vector<Arm::kDof, Scalar>::Zero(start.q.size())};
  arm.kinematics(start.q, loop.kinematics);
  AnchoredPath<Path, Scalar> references(path, loop.kinematics.tip);

  X dx = x;
  TaskWatch<Space, Arm::kDof, Scalar> watch(loop.kinematics.tip);
  RolloutResult<Arm::kDof, Scalar> result{Status::kOk, Time(0), start, 0};
  for (int i = 0;; ++i) {
    const Time t = grid.time(i);
    const bool last = i == grid.steps();
    const bool moving = i < grid.motion_steps() || (last && grid.hold_steps() == 0);
    const Reference<Space, Scalar> arrived =
        i <= grid.motion_steps() ? references.motion(t, grid.time(i > 0 ? i - 1 : 0)) : references.hold();
    const auto derivative = [&](Time stage_t, const X& stage_x, X& stage_dx) noexcept {
      return loop.evaluate(moving ? references.motion(stage_t, t) : references.hold(), stage_x, stage_dx);
    };

    const Status status = derivative(t, x, dx);
    result.status = worse(result.status, status);
    if (failed(status)) break;
    const Reference<Space, Scalar> reference = moving ? references.motion(t, t) : references.hold();
    const Mask<Scalar> followed = watch.template follows_reference<Scheme::kLevel>(
        loop.kinematics, arrived, reference, loop.state, loop.qdd, grid.dt(), status == Status::kDamped);
    if (none_of(followed)) {
      result.status = Status::kTaskLost;
      break;
    }
    if (none_of(watch.accurate())) result.status = worse(result.status, Status::kCoarse);
    for (Eigen::Index j = 0; j < loop.state.q.size(); ++j) {
      set_nan_unless(followed && watch.accurate(), x(j, 0));
      set_nan_unless(followed && watch.accurate(), loop.state.q(j));
    }

    result.time = t;
    result.last = loop.state;
    result.samples = i + 1;
    const Sample<Space, Arm::kDof, Scalar> sample{i,
                                                  t,
                                                  loop.state.q,
                                                  loop.state.qd,
                                                  loop.qdd,
                                                  loop.kinematics.tip,
                                                  reference,
                                                  task_error(loop.kinematics, reference.x),
                                                  first_rows(loop.kinematics)};
    if (!show(record, sample) || last) break;
    result.status = worse(result.status, RK4::step(derivative, t, grid.dt(), dx, x));
    if (failed(result.status)) break;
  }
  return result;
}

}  // namespace fpbm
