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
#include "fpbm/realtime/progress.hpp"
#include "fpbm/realtime/slow_down.hpp"
#include "fpbm/realtime/tick.hpp"
#include "fpbm/realtime/tick_motion.hpp"

namespace fpbm {

/// State of a Tracker from tick to tick, and the end of a tick.
///
/// If an RK4 step keeps every bound, the tick is this step. Otherwise the mean motion of the step is limited (Limiter).
/// If only the position at the end of the step violates a bound, the tick has the mean acceleration of the step
/// throughout. has_one_acceleration() and expects_limits() define the ticks without an RK4 step.
template <Level kLevel, typename Space, int N, typename Scalar, typename Guard_>
class LimitedState {
 public:
  static constexpr bool kGuarded = !std::is_same_v<Guard_, Unguarded>;
  using JointVector = Vector<N, Scalar>;
  using JointState = State<N, Scalar>;
  using JointLimits = Limits<kLevel, N, Scalar>;
  using Result = Tick<Space, N, Scalar>;

  /// start: state after a tick with the acceleration qdd0. Throws std::invalid_argument if an option is out of range.
  LimitedState(const TrackerOptions<Scalar>& options, const JointLimits& limits, const JointState& start,
               const JointVector& qdd0, const Guard_& guard)
      : motion_{options.dt},
        correction_(options),
        limiter_(limits, kHasLevels && options.keep_first_level ? kReserve : Scalar(0)),
        guard_(guard),
        keeps_first_level_(kHasLevels && options.keep_first_level),
        state_(start),
        last_(qdd0),
        change_(filled<JointVector>(qdd0.size())),
        progress_(options, start.q) {}

  /// Stores the start posture with its tip as the first posture of a recovery. length: the arm's characteristic length
  /// [m].
  void begin_at(const typename Space::template Point<Scalar>& tip, Scalar length) noexcept {
    progress_.begin_at(state_.q, tip, length);
  }

  [[nodiscard]] Scalar dt() const noexcept { return motion_.dt; }
  [[nodiscard]] const JointState& state() const noexcept { return state_; }
  /// Acceleration of the last tick.
  [[nodiscard]] const JointVector& last() const noexcept { return last_; }
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

  /// Whether a state is finite, and so far from overflow that braking does not overflow.
  [[nodiscard]] bool moderate(const JointState& state) const noexcept {
    const Scalar rate = Scalar(4) / dt();
    return is_finite(state.q) &&
           is_finite(entrywise(state.qd, [&](Eigen::Index i) { return state.qd.coeff(i) * rate; }));
  }

  /// Whether a tick has one acceleration (docs/equations.md, A tick with one acceleration): a tick of several tasks at
  /// acceleration level. An RK4 step would contain motions of lower levels that the limits do not admit. In the mean
  /// motion of the step, these motions would disturb the higher levels by J̇q̇. An RK4 step also resolves the tasks
  /// four times.
  template <typename Arm>
  [[nodiscard]] static bool has_one_acceleration(const Arm& arm) noexcept {
    return kSecondOrder && has_several_tasks(arm);
  }

  /// Evaluates `loop` in the middle of a tick that continues the acceleration of the last tick
  /// (StackKinematics::continue_tick()). Before the call, `loop` has the points at the start of the tick.
  template <typename Loop, typename References>
  void update_middle(Loop& loop, const References& references) const noexcept {
    const auto tip = loop.kinematics.tip;
    loop.update(Loop::packed(motion_.middle(state_, last_)));
    const auto reference = Space::template difference<Scalar>(references.stages[1].x, references.stages[0].x);
    const auto moved = Space::template difference<Scalar>(loop.kinematics.tip, tip);
    loop.kinematics.continue_tick(dt(),
                                  entrywise(moved, [&](Eigen::Index i) { return reference.coeff(i) - moved.coeff(i); }),
                                  {loop.state.qd, last_, change_});
  }

  /// Rows of the guard at the start of the tick.
  [[nodiscard]] auto rows() noexcept { return guard_.rows(limits(), state_); }

  /// Whether the limits or the rows do not admit the acceleration at the start of a tick, or damping is active there.
  /// Then the tick has one acceleration, which is evaluated in its middle, and no RK4 step (docs/limits.md, Bounds on
  /// jerk). The function sets `next` to the state after the tick, and leaves the kinematics of the middle in `loop`.
  /// Therefore the longest ticks resolve the task twice instead of four times. reference: in the middle of the tick.
  /// at_start: joint accelerations at the start [rad/s²].
  template <typename Loop, typename Target, typename Rows>
  [[nodiscard]] bool expects_limits(Loop& loop, const Target& reference, const Rows& rows, JointVector at_start,
                                    JointState& next, Result& result) const noexcept {
    if constexpr (!kSecondOrder) return false;
    if (failed(result.status)) return false;
    const bool admitted = rows.admit(at_start) && admits(motion_.after(state_, at_start));
    if (result.status != Status::kDamped && admitted) return false;
    result.status = worse(result.status, expect(loop, reference, at_start));
    next = motion_.after(state_, at_start);
    return true;
  }

  /// State after a tick with the constant motion u.
  [[nodiscard]] JointState after(const JointVector& u) const noexcept { return motion_.after(state_, u); }

  /// Ends a tick: limits the desired motion, replaces it if the arm could not stop clear of shapes, and updates the
  /// state, the result, and the detection of a stall.
  ///
  /// next: state to which the desired motion leads. At velocity level, only next.q is read. field: velocities of the
  /// scheme at the start of the tick [rad/s], read at velocity level only. now: reference at the start, not corrected.
  /// rows: bounds on the motion from the guard. one_acceleration: whether `loop` has the kinematics in the middle of
  /// the tick. Otherwise, the kinematics are evaluated if the motion must be limited. result: has the status of the
  /// desired motion, and the error with which the correction began.
  template <typename Loop, typename Target, typename Rows>
  void take(Loop& loop, const Target& now, Rows rows, JointState next, const JointVector& field, bool one_acceleration,
            Result& result) noexcept {
    if constexpr (kGuarded) {
      progress_.watch_shapes(state_.qd.isZero(Scalar(0)), guard_.room(), correction_.length());
    }
    // Acceleration level: with bounds on jerk, or if differences of positions would violate bounds, the tick has the
    // mean acceleration of the step (docs/limits.md, Bounds on jerk). Velocity level: the tick has the mean velocity of
    // the step.
    if constexpr (kSecondOrder) {
      if (limits().bounds_jerk() || !limits().admits_differences(state_, next)) {
        next.q = motion_.moved(state_, motion_.rate(state_.qd, next.qd));
      }
    } else {
      next.qd = motion_.rate(state_.q, next.q);
    }
    if constexpr (kGuarded) {
      if (guard_.draws_away() && !failed(result.status)) {
        next = motion_.after(state_, motion_.between(state_, next) + self_motion_away(loop.arm, next.q));
      }
      guard_.bound_speeds(limits(), state_, motion_.between(state_, next), rows);
    }
    if (!moderate(next)) result.status = Status::kNotFinite;
    const bool recovering = progress_.recovering() && !stopping_ && !failed(result.status);
    if (progress_.stalled() && !recovering) result.status = worse(result.status, Status::kStalled);
    // Motion of a recovery, or the limited motion if the arm brakes or a bound does not admit the desired motion.
    if (recovering) {
      const Box<N, Scalar> box = limits().box(state_, last_);
      next = motion_.after(state_, rows.near(box.nearest(progress_.recovery().motion(limits(), state_)), box));
      result.status = Status::kRecovering;
      multiply_scale(result, Scalar(0));
    } else if (stopping_ || result.status >= Status::kStalled || !rows.admit(motion_.between(state_, next)) ||
               !admits(next)) {
      JointVector desired = next.qd;
      Scalar share(1);
      if constexpr (kSecondOrder) {
        desired = motion_.rate(state_.qd, next.qd);
      } else if (!failed(result.status)) {
        share = slow_down(loop, limits(), correction_(now), state_.q, field);
        if (share < Scalar(1)) desired = entrywise(field, [&](Eigen::Index i) { return share * field.coeff(i); });
      }
      const bool several = has_lower_levels(loop.kinematics);
      if constexpr (kHasLevels) {
        if (several && !failed(result.status) && !one_acceleration) {
          result.status = worse(result.status, expect(loop, correction_(ahead(now, dt() / 2)), desired));
          if (share < Scalar(1)) desired = entrywise(desired, [&](Eigen::Index i) { return share * desired.coeff(i); });
        }
      }
      if (!several && !one_acceleration) {
        // Jacobian in the middle of the tick: joints that compensate for joints on their bounds then do not disturb the
        // tip.
        const JointVector middle =
            entrywise(next.q, [&](Eigen::Index i) { return (state_.q.coeff(i) + next.q.coeff(i)) / Scalar(2); });
        loop.arm.kinematics(middle, loop.kinematics);
      }
      const JointVector u = limited(loop.kinematics, state_, last_, desired, rows, result);
      if (share < Scalar(1)) {
        multiply_scale(result, share);
        result.status = worse(result.status, Status::kSlowed);
      }
      next = motion_.after(state_, u);
    }
    // If every joint brakes, or if the arm could not stop clear of all shapes after this tick, the arm follows the
    // stopping trajectory of the previous tick (docs/clearance.md, Guarantees).
    if constexpr (kGuarded) {
      const bool braking = brakes(result.status);
      if (!guard_.empty() && (braking || !guard_.accepts(limits(), state_, next))) {
        const JointVector qdd = guard_.stop(limits(), state_, last_);
        next = motion_.after(state_, kSecondOrder ? qdd : JointVector(state_.qd + dt() * qdd));
        multiply_scale(result, Scalar(0));
        if (!braking) result.status = Status::kBlocked;
      }
    }
    result.q = next.q;
    result.qd = next.qd;
    result.qdd = motion_.rate(state_.qd, next.qd);
    change_ = entrywise(last_, [&](Eigen::Index i) { return result.qdd.coeff(i) - last_.coeff(i); });
    last_ = result.qdd;
    const JointVector q = state_.q;
    state_ = std::move(next);
    if (stopping_ || failed(result.status)) return;
    const Scalar length = correction_.length();
    if (recovering) return progress_.recovered(state_.q, now.x, length);
    if (result.status != Status::kOk || correction_.far()) {
      return progress_.missed(state_.q, limits().bounds().velocity, now.x, result, length, correction_.far());
    }
    correction_.integrate(result);
    progress_.done(q, now.x, result, length);
  }

  /// Desired motion within the limits, after a tick with the acceleration `last`. If the scheme failed, the arm has
  /// stalled, or stop() was called, the braking motion.
  template <int P>
  [[nodiscard, gnu::noinline]] JointVector limited(const Kinematics<Space, N, Scalar>& kinematics,
                                                   const JointState& state, const JointVector& last,
                                                   const JointVector& desired, const Rows<N, P, Scalar>& rows,
                                                   Result& result) const noexcept {
    const bool braking = brakes(result.status) || result.status == Status::kStalled;
    const bool gives_way = result.status == Status::kStalled;
    const auto tasks = jacobian_in_metres(kinematics);
    auto found = with_scale(tasks, state.qd, Scalar(0));
    if (braking) {
      found.u = limiter_.brake(state, last, gives_way ? rows : Rows<N, P, Scalar>{}).u;
    } else {
      if constexpr (kHasLevels) {
        found = stopping_ ? limiter_.stop_on_first_level(tasks, state, desired, last, rows)
                          : limiter_.motion(tasks, state, desired, last, rows);
      } else {
        found = limiter_.motion(tasks, state, desired, last, rows);
      }
    }
    take_scale(result, found);
    result.saturated = found.joints;
    if (found.scale < Scalar(1) && !braking) {
      result.status = guard_.is_near(found.rows) ? Status::kBlocked : Status::kSlowed;
    }
    return found.u;
  }

 private:
  static constexpr bool kSecondOrder = kLevel == Level::kAcceleration;
  static constexpr bool kHasLevels = kLevelsOf<Space> != 1;
  /// Reserve of the first level (Limiter). Of the 10,000 motions along the path of `make grasp`, five lose the grasp
  /// with 0.4, one with 0.6, and none with 0.7.
  static constexpr Scalar kReserve = Scalar(0.7);

  /// Whether each joint brakes by itself. A stop that keeps the first level moves the joints together.
  [[nodiscard]] bool brakes(Status status) const noexcept {
    return (stopping_ && !keeps_first_level_) || failed(status);
  }

  /// Evaluates the desired motion and the kinematics in the middle of a tick that continues the acceleration of the
  /// last tick.
  template <typename Loop, typename Target>
  [[nodiscard]] Status expect(Loop& loop, const Target& reference, JointVector& desired) const noexcept {
    const JointState middle = motion_.middle(state_, last_);
    typename Loop::X dx = Loop::packed(middle);
    const Status status = loop.evaluate(reference, Loop::packed(middle), dx);
    if (!failed(status)) desired = column(dx, kSecondOrder ? 1 : 0);
    return status;
  }

  /// Whether the limits admit a tick to the state `next`.
  [[nodiscard]] bool admits(const JointState& next) const noexcept { return limiter_.admits(state_, next, last_); }

  /// Null-space part of the motion away from shapes, in the middle of a tick that ends at the posture `end`.
  template <typename Arm>
  [[nodiscard]] JointVector self_motion_away(const Arm& arm, const JointVector& end) noexcept {
    const JointVector middle =
        entrywise(end, [&](Eigen::Index i) { return (state_.q.coeff(i) + end.coeff(i)) / Scalar(2); });
    Kinematics<Space, N, Scalar> kinematics;
    arm.kinematics(middle, kinematics);
    return null_space_motion(jacobian_in_metres(kinematics), guard_.away());
  }

  TickMotion<kLevel, N, Scalar> motion_;
  Correction<kLevel, Space, Scalar> correction_;
  Limiter<kLevel, N, Scalar> limiter_;
  Guard_ guard_;
  bool keeps_first_level_;
  JointState state_;
  JointVector last_;    ///< Acceleration of the last tick.
  JointVector change_;  ///< Change of acceleration from the tick before the last tick to the last tick.
  Progress<Space, N, Scalar> progress_;
  bool stopping_ = false;
};

}  // namespace fpbm
