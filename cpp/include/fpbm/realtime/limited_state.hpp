#pragma once

#include <cmath>
#include <utility>

#include "fpbm/clearance/unguarded.hpp"
#include "fpbm/core/parts.hpp"
#include "fpbm/limits/limiter.hpp"
#include "fpbm/limits/rows.hpp"
#include "fpbm/linalg/null_basis.hpp"
#include "fpbm/linalg/sums.hpp"
#include "fpbm/model/kinematics.hpp"
#include "fpbm/realtime/correction.hpp"
#include "fpbm/realtime/followable_fraction.hpp"
#include "fpbm/realtime/joint_approach.hpp"
#include "fpbm/realtime/progress.hpp"
#include "fpbm/realtime/tick.hpp"
#include "fpbm/realtime/tick_state.hpp"

namespace fpbm {

/// State of a Tracker from tick to tick. finish_tick() ends a tick.
///
/// If an RK4 step keeps every bound, the tick is this step. Otherwise the mean motion of the step is limited (Limiter).
/// If only the position at the end of the step violates a bound, the tick has the mean acceleration of the step
/// throughout. 
template <Level kLevel, typename Space, int N, typename Scalar, typename Guard_>
class LimitedState {
 public:
  static constexpr bool kGuarded = !std::is_same_v<Guard_, Unguarded>;
  static constexpr bool kHasLevels = kLevelsOf<Space> != 1;
  using JointVector = Vector<N, Scalar>;
  using JointState = State<N, Scalar>;
  using JointLimits = Limits<kLevel, N, Scalar>;
  using Result = Tick<Space, N, Scalar>;

  /// start: state after a tick with the acceleration qdd0. continuous: bits of the continuous joints. Throws
  /// std::invalid_argument if an option is out of range.
  LimitedState(const TrackerOptions<Scalar>& options, const JointLimits& limits, const JointState& start,
               const JointVector& qdd0, const Guard_& guard, JointBits continuous)
      : tick_{{options.dt}, start, qdd0, filled<JointVector>(qdd0.size())},
        correction_(options),
        limiter_(limits, kHasLevels && options.keep_first_level ? kReserve : Scalar(0), options.recover_start),
        guard_(guard),
        keeps_first_level_(kHasLevels && options.keep_first_level),
        progress_(options, start.q, continuous),
        returning_(options.recover_start && !limits.is_viable(start, qdd0)) {}

  /// Stores the start posture, if it is within the limits, with its tip as the first posture of a recovery. length: the
  /// arm's characteristic length [m].
  void begin_at(const typename Space::template Point<Scalar>& tip, Scalar length) noexcept {
    if (!returning_) progress_.begin_at(tick_.joints.q, tip, length);
  }

  [[nodiscard]] Scalar dt() const noexcept { return tick_.motion.dt; }
  [[nodiscard]] const TickState<kLevel, Space, N, Scalar>& tick() const noexcept { return tick_; }
  [[nodiscard]] const JointState& state() const noexcept { return tick_.joints; }
  /// Acceleration of the last tick.
  [[nodiscard]] const JointVector& last() const noexcept { return tick_.last; }
  [[nodiscard]] const JointLimits& limits() const noexcept { return limiter_.limits(); }
  [[nodiscard]] Correction<kLevel, Space, Scalar>& correction() noexcept { return correction_; }
  [[nodiscard]] const Correction<kLevel, Space, Scalar>& correction() const noexcept { return correction_; }
  [[nodiscard]] Guard_& guard() noexcept { return guard_; }
  [[nodiscard]] const Guard_& guard() const noexcept { return guard_; }

  [[nodiscard]] bool stopping() const noexcept { return stopping_; }
  /// Whether the arm stops and keeps the first level.
  [[nodiscard]] bool keeps_stopping() const noexcept { return stopping_ && keeps_first_level_; }
  void stop() noexcept { stopping_ = true; }
  void resume() noexcept {
    stopping_ = false;
    progress_.try_again();
  }

  /// Initial result of a tick: the arm has not moved.
  [[nodiscard]] static Result idle(const JointState& state) noexcept {
    using Twist = Vector<Space::kRows, Scalar>;
    Result result{{state.q, state.qd, filled<JointVector>(state.q.size()), Status::kOk, Scalar(1), 0, Scalar(0),
                   filled<Twist>(Space::kRows)}};
    if constexpr (kIsProduct<Space>) result.scales.fill(Scalar(1));
    return result;
  }

  /// Whether a state is finite, and so far from overflow that braking does not overflow. The acceleration between two
  /// velocities of a braking joint is at most 2 |q̇|/h, half of the tested 4 |q̇|/h.
  [[nodiscard]] bool is_brakable(const JointState& state) const noexcept {
    const Scalar rate = Scalar(4) / dt();
    return is_finite(state.q) &&
           is_finite(entrywise(state.qd, [&](Eigen::Index i) { return state.qd.coeff(i) * rate; }));
  }

  /// Rows of the guard at the start of the tick.
  [[nodiscard]] auto rows() noexcept { return guard_.rows(limits(), tick_.joints); }

  /// Whether the limits, the rows and the guard admit a tick to the state `next`.
  template <typename Rows>
  [[nodiscard]] bool is_free(const Rows& rows, const JointState& next) const noexcept {
    if constexpr (kGuarded) {
      if (guard_.moves_away()) return false;
    }
    return !stopping_ && rows.admit(tick_.motion_to(next)) && admits(next);
  }

  /// At velocity level, if the guard adds motion away from shapes, the tick has one velocity, which is evaluated in the
  /// middle of the tick, and no RK4 step. The function then returns true, sets `next` to the state after the tick, and
  /// leaves the kinematics of the middle in `loop`. reference: in the middle of the tick. field: joint velocities at
  /// the start [rad/s].
  template <typename Loop, typename Target>
  [[nodiscard]] bool evaluate_middle_of_guarded([[maybe_unused]] Loop& loop, [[maybe_unused]] const Target& reference,
                                                [[maybe_unused]] JointVector field, [[maybe_unused]] JointState& next,
                                                [[maybe_unused]] Result& result) const noexcept {
    if constexpr (kGuarded) {
      if (failed(result.status) || !guard_.moves_away()) return false;
      result.status = worse(result.status, tick_.evaluate_middle(loop, reference, field));
      next = tick_.after(field);
      return true;
    }
    return false;
  }

  /// Ends a tick: limits the desired motion, and updates the state, the result, and the detection of a stall. If the
  /// arm could not stop clear of shapes after this motion, the stopping trajectory replaces the motion.
  ///
  /// next: state to which the desired motion leads. At velocity level, only next.q is read. field: velocities of the
  /// scheme at the start of the tick [rad/s], read at velocity level only. now: reference at the start, not corrected.
  /// rows: bounds on the motion from the guard. has_middle: whether `loop` has the kinematics in the middle of the
  /// tick. Otherwise, the kinematics are evaluated if the motion must be limited. result: has the status of the
  /// desired motion, and the error with which the correction began.
  template <typename Loop, typename Target, typename Rows>
  void finish_tick(Loop& loop, const Target& now, Rows rows, JointState next, const JointVector& field,
                   bool has_middle, Result& result) noexcept {
    const bool damped = result.status == Status::kDamped;
    if constexpr (kGuarded) {
      progress_.watch_shapes(tick_.joints.qd.isZero(Scalar(0)), guard_.near_distance_sum(), correction_.length());
    }
    make_admissible(next);
    if constexpr (kGuarded) {
      if (guard_.moves_away() && !failed(result.status)) {
        next =
            tick_.after(tick_.motion_to(next) + null_space_motion(jacobian_in_metres(loop.kinematics), guard_.away()));
      }
      guard_.bound_speeds(limits(), tick_.joints, tick_.motion_to(next), rows);
    }
    if (!is_brakable(next)) result.status = Status::kNotFinite;
    const bool recovering = progress_.recovering() && !stopping_ && !failed(result.status);
    if (progress_.stalled() && !recovering) result.status = worse(result.status, Status::kStalled);
    if (recovering) {
      next = recovery_tick(rows, result);
    } else if (stopping_ || result.status >= Status::kStalled || !rows.admit(tick_.motion_to(next)) || !admits(next)) {
      next = limited_tick(loop, now, rows, next, field, has_middle, result);
    }
    if constexpr (kGuarded) keep_clear(next, result);
    result.q = next.q;
    result.qd = next.qd;
    result.qdd = tick_.acceleration_to(next);
    const JointVector q = tick_.joints.q;
    tick_.store(std::move(next), result.qdd);
    if (!stopping_ && !failed(result.status)) update_progress(loop.arm, q, now, recovering, damped, result);
  }

 private:
  static constexpr bool kSecondOrder = kLevel == Level::kAcceleration;
  /// Reserve of the first level (Limiter). Of the 10,000 motions along the path of `make grasp`, five lose the grasp
  /// with 0.4, one with 0.6, and none with 0.7.
  static constexpr Scalar kReserve = Scalar(0.7);

  /// Velocity level: the tick has the mean velocity of the RK4 step.
  void make_admissible(JointState& next) const noexcept {
    if constexpr (!kSecondOrder) next.qd = tick_.motion.rate(tick_.joints.q, next.q);
  }

  /// State after a tick of a recovery.
  template <typename Rows>
  [[nodiscard]] JointState recovery_tick(const Rows& rows, Result& result) const noexcept {
    const Box<N, Scalar> box = limits().box(tick_.joints, tick_.last);
    result.status = Status::kRecovering;
    multiply_scale(result, Scalar(0));
    return tick_.after(rows.near(box.nearest(progress_.recovery().motion(limits(), tick_.joints)), box));
  }

  /// State after a tick of the limited motion, if the arm brakes or a bound does not admit the desired motion. The
  /// arguments are as in finish_tick().
  template <typename Loop, typename Target, typename Rows>
  [[nodiscard]] JointState limited_tick(Loop& loop, const Target& now, const Rows& rows, const JointState& next,
                                        const JointVector& field, bool has_middle,
                                        Result& result) const noexcept {
    JointVector desired = tick_.motion_to(next);
    Scalar fraction(1);  // Fraction of the velocities of the scheme.
    const auto slowed = [&](const JointVector& u) {
      return entrywise(u, [&](Eigen::Index i) { return fraction * u.coeff(i); });
    };
    if constexpr (!kSecondOrder) {
      if (!failed(result.status)) {
        const auto reference_after = [&](Scalar seconds) noexcept {
          auto correction = correction_;
          approach_postures<kLevel, Space>(loop.arm, limits(), correction,
                                           [&](int joint) { return seconds * field.coeff(joint); });
          return correction(now);
        };
        fraction = followable_fraction(loop, limits(), reference_after, tick_.joints.q, field);
        if (fraction < Scalar(1)) desired = slowed(field);
      }
    }
    const bool several = has_lower_levels(loop.kinematics);
    const bool evaluates =
        !kSecondOrder && !failed(result.status) && (several || has_middle || is_nearly_at_rest(result));
    if constexpr (!kSecondOrder) {
      if (evaluates) {
        result.status = worse(result.status, tick_.evaluate_middle(loop, correction_(ahead(now, dt() / 2)), desired));
        if (fraction < Scalar(1)) desired = slowed(desired);
        if constexpr (kGuarded) {
          if (guard_.moves_away()) desired += null_space_motion(jacobian_in_metres(loop.kinematics), guard_.away());
        }
      }
    }
    if (!evaluates && !(kSecondOrder && has_middle)) {
      // With the Jacobian in the middle of the tick, joints that compensate for saturated joints do not disturb the
      // tip.
      loop.arm.kinematics(tick_.middle_of(next.q), loop.kinematics);
    }
    JointVector first = desired;
    if constexpr (kHasLevels) {
      if (several) first = slowed(loop.first);
    }
    const JointVector u = limited_motion(loop.kinematics, desired, first, rows, result);
    if (fraction < Scalar(1)) {
      multiply_scale(result, fraction);
      result.status = worse(result.status, Status::kSlowed);
    }
    return tick_.after(u);
  }

  /// Desired motion within the limits. If the arm has stalled, or each joint brakes by itself (brakes()), the result is
  /// the braking motion. first: desired motion of the first level alone.
  template <int P>
  [[nodiscard, gnu::noinline]] JointVector limited_motion(const Kinematics<Space, N, Scalar>& kinematics,
                                                          const JointVector& desired,
                                                          [[maybe_unused]] const JointVector& first,
                                                          const Rows<N, P, Scalar>& rows,
                                                          Result& result) const noexcept {
    const bool braking = brakes(result.status) || result.status == Status::kStalled;
    const bool keeps_rows = result.status == Status::kStalled;
    auto tasks = jacobian_in_metres(kinematics);
    if constexpr (kHasLevels) tasks.set_first_motion(first);
    auto found = with_scale(tasks, tick_.joints.qd, Scalar(0));
    if (braking) {
      found.u = limiter_.brake(tick_.joints, tick_.last, keeps_rows ? rows : Rows<N, P, Scalar>{}).u;
    } else {
      if constexpr (kHasLevels) {
        found = stopping_ ? limiter_.stop_on_first_level(tasks, tick_.joints, desired, tick_.last, rows)
                          : limiter_.motion(tasks, tick_.joints, desired, tick_.last, rows);
      } else {
        found = limiter_.motion(tasks, tick_.joints, desired, tick_.last, rows);
      }
    }
    take_scale(result, found);
    result.saturated = found.joints;
    if (found.scale < Scalar(1) && !braking) {
      result.status = guard_.is_near(found.rows) ? Status::kBlocked : Status::kSlowed;
    }
    return found.u;
  }

  /// If every joint brakes, or if the arm could not stop clear of all shapes after this tick, the tick becomes the next
  /// tick of the planned stopping trajectory (docs/clearance.md, Guarantees).
  void keep_clear(JointState& next, Result& result) noexcept {
    const bool braking = brakes(result.status);
    if (guard_.empty() || (!braking && guard_.accepts(limits(), tick_.joints, next))) return;
    const JointVector qdd = guard_.stop(limits(), tick_.joints, tick_.last);
    next = tick_.after(kSecondOrder ? qdd : JointVector(tick_.joints.qd + dt() * qdd));
    multiply_scale(result, Scalar(0));
    if (!braking) result.status = Status::kBlocked;
  }

  /// Updates the integral of the error and the detection of a stall, unless the joints return from a start outside
  /// their bounds. q: posture at the start of the tick. damped: whether the scheme damped the desired motion.
  template <typename Arm, typename Target>
  void update_progress(const Arm& arm, const JointVector& q, const Target& now, bool recovering, bool damped,
                       const Result& result) noexcept {
    if (returning_) {
      returning_ = !limits().is_viable(tick_.joints, tick_.last);
      return;
    }
    const Scalar length = correction_.length();
    if (recovering) return progress_.recovered(tick_.joints.q, now.x, length);
    if (result.status != Status::kOk || correction_.far()) {
      if (progress_.missed(tick_.joints.q, limits().bounds().velocity, now.x, result, length, correction_.far(),
                           damped)) {
        leave_saddle(arm, now, TaskDistance<Space, Scalar>::norm(result.error, length));
      }
      return;
    }
    correction_.integrate(result);
    progress_.done(q, now.x, result, length);
  }

  /// Starts a recovery from a singular posture that is a saddle point of the error.
  template <typename Arm, typename Target>
  [[gnu::cold, gnu::noinline]] void leave_saddle(const Arm& arm, const Target& now, Scalar error) noexcept {
    const JointVector& q = tick_.joints.q;
    progress_.leave(q, saddle_exit<Space>(arm, q, now.x, correction_(now).x, limits().bounds()), error);
  }

  /// Whether each joint brakes by itself. A stop that keeps the first level moves the joints together.
  [[nodiscard]] bool brakes(Status status) const noexcept {
    return (stopping_ && !keeps_first_level_) || failed(status);
  }

  /// Whether the limits admit a tick to the state `next`.
  [[nodiscard]] bool admits(const JointState& next) const noexcept {
    return limiter_.admits(tick_.joints, next, tick_.last);
  }

  /// Whether a tick at velocity level is limited although the arm hardly moves and no direction is damped: secondary
  /// motion presses joints against bounds. The mean velocity of an RK4 step is then of a motion that the bounds do not
  /// admit, and would move the tip by the order of h² times the cube of this motion. If the joints move by d = 1e-5 rad
  /// in a tick, one evaluation in the middle of the tick has an error of about d³/24 of the length of the arm, 4e-17,
  /// which is less than the round-off error: nothing is lost without RK4.
  [[nodiscard]] bool is_nearly_at_rest(const Result& result) const noexcept {
    return result.status == Status::kOk && largest_magnitude(tick_.joints.qd) * dt() < Scalar(1e-5);
  }

  TickState<kLevel, Space, N, Scalar> tick_;
  Correction<kLevel, Space, Scalar> correction_;
  Limiter<kLevel, N, Scalar> limiter_;
  Guard_ guard_;
  bool keeps_first_level_;
  Progress<Space, N, Scalar> progress_;
  bool returning_;  ///< Whether the joints return from a start outside their bounds.
  bool stopping_ = false;
};

}  // namespace fpbm
