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
/// If the desired motion keeps every bound, the tick has this motion. Otherwise the motion is limited (Limiter).
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

  /// Ends a tick: limits the desired motion, and updates the state, the result, and the detection of a stall. If the
  /// arm could not stop clear of shapes after this motion, the stopping trajectory replaces the motion.
  ///
  /// loop: has the kinematics of the desired motion. now: reference at the start, not corrected. rows: bounds on the
  /// motion from the guard. next: state after the desired motion. result: has the status of the desired motion, and the
  /// error with which the correction began.
  template <typename Loop, typename Target, typename Rows>
  void finish_tick(const Loop& loop, const Target& now, Rows rows, JointState next, Result& result) noexcept {
    const bool damped = result.status == Status::kDamped;
    if constexpr (kGuarded) {
      progress_.watch_shapes(tick_.joints.qd.isZero(Scalar(0)), guard_.near_distance_sum(), correction_.length());
    }
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
      next = limited_tick(loop, now, rows, next, result);
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
  [[nodiscard]] JointState limited_tick(const Loop& loop, const Target& now, const Rows& rows, const JointState& next,
                                        Result& result) const noexcept {
    Scalar fraction(1);  // Fraction of the velocities of the scheme.
    if constexpr (!kSecondOrder) {
      if (!failed(result.status)) fraction = followable_part(loop, now);
    }
    const auto slowed = [&](const JointVector& u) {
      return entrywise(u, [&](Eigen::Index i) { return fraction * u.coeff(i); });
    };
    const JointVector desired = slowed(tick_.motion_to(next));
    JointVector first = desired;
    if constexpr (kHasLevels) {
      if (has_lower_levels(loop.kinematics)) first = slowed(loop.first);
    }
    const JointVector u = limited_motion(loop.kinematics, desired, first, rows, result);
    if (fraction < Scalar(1)) {
      multiply_scale(result, fraction);
      result.status = worse(result.status, Status::kSlowed);
    }
    return tick_.after(u);
  }

  /// followable_fraction() at the start of the tick. now: reference at the start, not corrected.
  template <typename Loop, typename Target>
  [[nodiscard]] Scalar followable_part(Loop loop, const Target& now) const noexcept {
    JointVector field = tick_.joints.q;
    if (failed(loop.evaluate(correction_(now), tick_.joints.q, field))) return Scalar(1);
    const auto reference_after = [&](Scalar seconds) noexcept {
      auto correction = correction_;
      approach_postures<kLevel, Space>(loop.arm, limits(), correction,
                                       [&](int joint) { return seconds * field.coeff(joint); });
      return correction(now);
    };
    return followable_fraction(loop, limits(), reference_after, tick_.joints.q, field);
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
