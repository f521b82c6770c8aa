#pragma once

#include "fpbm/bound/bounds.hpp"
#include "fpbm/core/detail/parts.hpp"
#include "fpbm/limits/limiter.hpp"
#include "fpbm/linalg/detail/entrywise.hpp"
#include "fpbm/realtime/detail/correction.hpp"
#include "fpbm/realtime/detail/held_level.hpp"
#include "fpbm/realtime/detail/no_lower_levels.hpp"
#include "fpbm/realtime/detail/progress.hpp"
#include "fpbm/realtime/detail/tick_state.hpp"
#include "fpbm/realtime/tick.hpp"

namespace fpbm {

/// State of a Tracker from tick to tick. A tick has four steps, which read and change this state: desire(), limit(),
/// prove() and account() (docs/architecture.md, A tick).
template <Level kLevel_, typename Space_, int N, typename Scalar_, typename Bounds_>
struct TrackerState {
  static constexpr Level kLevel = kLevel_;
  static constexpr bool kBounded = !std::is_same_v<Bounds_, Bounds<>>;
  static constexpr bool kHasLevels = kLevelsOf<Space_> != 1;
  using Space = Space_;
  using Scalar = Scalar_;
  using Target = Reference<Space, Scalar>;
  using JointVector = Vector<N, Scalar>;
  using JointState = State<N, Scalar>;
  using MotionLimits = Limits<kLevel, N, Scalar>;
  using Result = Tick<Space, N, Scalar>;

  /// start: state after a tick with the acceleration qdd0. continuous: bits of the continuous joints. Throws
  /// std::invalid_argument if an option is out of range.
  TrackerState(const TrackerOptions<Scalar>& options, const MotionLimits& limits_, const JointState& start,
               const JointVector& qdd0, const Bounds_& bounds_, JointBits continuous_)
      : tick{{options.dt}, start, qdd0, filled<JointVector>(qdd0.size())},
        correction(options),
        limiter(limits_, kHasLevels && options.keep_first_level ? kReserve : Scalar(0), options.recover_start),
        bounds(bounds_),
        stop(Stop<kLevel, N, Scalar>::at_rest(qdd0.size())),
        acting_ticks(kBounded ? StopPlan<kLevel, N, Scalar>::acting_ticks(limits_) : Scalar(1)),
        progress(options, start.q, continuous_),
        lower_levels(options.stall_time, options.dt),
        planned(start),
        continuous(continuous_),
        keeps_first_level(options.keep_first_level),
        returning(options.recover_start && !limits_.is_viable(start, qdd0)) {}

  TickState<kLevel, Space, N, Scalar> tick;
  Correction<kLevel, Space, Scalar> correction;
  Limiter<kLevel, N, Scalar> limiter;
  Bounds_ bounds;
  Stop<kLevel, N, Scalar> stop;  ///< The planned stop, with the tick before the stop. Set if there are bounds.
  Scalar acting_ticks;           ///< StopPlan::acting_ticks().
  Progress<Space, N, Scalar> progress;
  typename LowerLevelsOf<Space, Scalar>::type lower_levels;
  std::conditional_t<kHasLevels, HeldLevel<Space, Scalar>, NoHeldLevel> held_level;
  JointState planned;    ///< The state of the joints on a kept path, at the start of the tick.
  JointBits continuous;  ///< Bits of the continuous joints.
  bool keeps_first_level;
  bool returning;  ///< Whether the joints return from a start outside their bounds.
  bool stopping = false;
  Scalar speed = Scalar(0);               ///< Fraction of set_speed(); 0: each source has its own speed.
  Scalar most_path_fraction = Scalar(0);  ///< Entry of the references of the tick.

  [[nodiscard]] Scalar dt() const noexcept { return tick.motion.dt; }
  [[nodiscard]] const MotionLimits& limits() const noexcept { return limiter.limits(); }
  /// Whether the references of the tick belong to a kept path.
  [[nodiscard]] bool on_path() const noexcept { return most_path_fraction > Scalar(0); }
  /// Whether the arm stops. On a kept path, the clock of the path stops an arm that keeps its first level.
  [[nodiscard]] bool stops() const noexcept { return stopping && !(on_path() && keeps_first_level); }
  /// Whether the arm stops and keeps the first level.
  [[nodiscard]] bool keeps_stopping() const noexcept { return kHasLevels && stops() && keeps_first_level; }
  /// Whether each joint brakes by itself. A stop that keeps the first level moves the joints together.
  [[nodiscard]] bool brakes(Status status) const noexcept { return (stops() && !keeps_stopping()) || failed(status); }

  void resume() noexcept {
    stopping = false;
    progress.try_again();
    held_level.release();
    lower_levels.release();
  }

  /// The levels of a stack have a new order.
  void reordered() noexcept {
    correction.reset_integrals(0, Space::kRows);
    held_level.release();
    lower_levels.release();
  }

  bool set_speed(Scalar fraction) noexcept {
    if (!(fraction > Scalar(0) && fraction <= Scalar(1))) return false;
    speed = fraction;
    return true;
  }

  /// Initial result of a tick: the arm has not moved.
  [[nodiscard]] static Result idle(const JointState& joints) noexcept {
    using Twist = Vector<Space::kRows, Scalar>;
    Result result{{joints.q, joints.qd, filled<JointVector>(joints.q.size()), Status::kOk, Scalar(1), 0,
                   filled<Twist>(Space::kRows)}};
    if constexpr (kIsProduct<Space>) result.scales.fill(Scalar(1));
    return result;
  }

  /// Whether a state is finite, and so far from overflow that braking does not overflow. The acceleration between two
  /// velocities of a braking joint is at most 2 |q̇|/h, half of the tested 4 |q̇|/h.
  [[nodiscard]] bool is_brakable(const JointState& joints) const noexcept {
    const Scalar rate = Scalar(4) / dt();
    return is_finite(joints.q) &&
           is_finite(entrywise(joints.qd, [&](Eigen::Index i) { return joints.qd.coeff(i) * rate; }));
  }

  /// Throws std::invalid_argument if the start, or a limit, is not for dof joints, an option is out of range, or the
  /// start violates a limit and options.recover_start is false.
  void require_start(const TrackerOptions<Scalar>& options, Eigen::Index dof) const {
    const JointState& start = tick.joints;
    validation::require_size("limits", limits().bounds().lower.size(), dof);
    if (limits().tick() != options.dt) {
      validation::fail("limits' tick", limits().tick(), "the tracker's dt = ", options.dt);
    }
    validation::require_joint_vector("q0", start.q, dof);
    validation::require_joint_vector("qd0", start.qd, dof);
    validation::require_joint_vector("qdd0", tick.last, dof);
    if (options.recover_start) {
      limits().require_accelerations(start, tick.last);
    } else {
      limits().require_viable(start, tick.last);
    }
    validation::require_non_negative("null_damping", options.null_damping);
  }

  /// Throws std::invalid_argument if the start violates a bound, or if the arm cannot stop within the bounds.
  void require_bounds() {
    const JointState& start = tick.joints;
    const JointVector& last = tick.last;
    bounds.require_limits(limits());
    bounds.require(start.q);
    if (bounds.empty()) return;
    for (Eigen::Index i = 0; i < start.q.size() && !limits().is_viable(start, last); ++i) {
      // Only from rest does the stop of a joint outside its range have the bounds that the stopping trajectory assumes.
      if (start.qd(i) == Scalar(0) && last(i) == Scalar(0)) continue;
      validation::fail(validation::element("qd0", i), start.qd(i),
                       "0 before a start outside the limits with bounds: stop the arm first");
    }
    stop = Stop<kLevel, N, Scalar>::after(limits(), start, start, last);
    if (!bounds.accepts(limits(), start, stop)) {
      validation::reject("qd0", ": is too fast: must be slow enough for the arm to stop within all bounds");
    }
  }

  /// Rows of the bounds for a tick with the desired motion u.
  [[nodiscard]] auto rows(const JointVector& u) noexcept { return rows(limits(), tick.joints, u); }
  /// Rows for a motion from `joints` within `joint_limits`. The motion lasts at least the given fraction of a tick.
  [[nodiscard]] auto rows(const MotionLimits& joint_limits, const JointState& joints, const JointVector& u,
                          Scalar least_fraction = Scalar(1)) noexcept {
    return bounds.rows(NextMotion<kLevel, N, Scalar>{joint_limits, joints, u, stop, acting_ticks, least_fraction});
  }
  /// Whether the limits and the rows admit a tick with the motion u.
  template <typename Rows>
  [[nodiscard]] bool admits(const Rows& rows, const JointVector& u) const noexcept {
    return rows.admit(u) && limiter.admits(tick.joints, tick.after(u), tick.last);
  }

 private:
  /// Reserve of the first level (Limiter). Of the 10,000 motions along the path of `make grasp`, five lose the grasp
  /// with 0.4, one with 0.6, and none with 0.7.
  static constexpr Scalar kReserve = Scalar(0.7);
};

}  // namespace fpbm
