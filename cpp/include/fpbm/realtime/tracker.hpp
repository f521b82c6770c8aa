#pragma once

#include <array>

#include "fpbm/realtime/held_level.hpp"
#include "fpbm/realtime/joint_approach.hpp"
#include "fpbm/realtime/limited_state.hpp"
#include "fpbm/realtime/measured_limiter.hpp"
#include "fpbm/realtime/measured_tick.hpp"
#include "fpbm/realtime/no_lower_levels.hpp"
#include "fpbm/realtime/reference_sources.hpp"
#include "fpbm/realtime/require_stable.hpp"
#include "fpbm/realtime/tick.hpp"
#include "fpbm/realtime/tick_references.hpp"
#include "fpbm/realtime/turns.hpp"
#include "fpbm/scheme/set_damping.hpp"
#include "fpbm/sim/closed_loop.hpp"
#include "fpbm/singular/damped_gram.hpp"

/// One tick of a control loop.
///
/// After construction, no function of a tracker allocates, throws, locks, does I/O or loops without a bound, for any
/// input. The same inputs give the same bits. If no motion can be computed, the arm brakes.
namespace fpbm {

/// Moves an arm tick by tick with a scheme, within its joint limits and through singular postures, until the arm is at
/// rest (docs/realtime.md).
///
/// tick() advances the tracker's own state (docs/tick.md, A tick). The result of tick() is a command for an arm
/// that accepts positions or velocities and follows them closely. resolve_measured() computes the acceleration for a
/// measured state, for a torque controller. Never pass a measured state to tick(): the feedback would act twice, and
/// noise would enter the command.
///
/// A tick has one motion: the motion of the scheme in the middle of the tick, within the limits (Limiter).
///
/// With a Guard<kLevel, N, Scalar> instead of Unguarded, the arm avoids self-collision and obstacles.
template <typename Arm, typename Space, typename Scheme, typename Guard_ = Unguarded>
class Tracker {
 public:
  using Scalar = typename Arm::Scalar;
  static constexpr int N = Arm::kDof;
  static constexpr Level kLevel = Scheme::kLevel;
  static constexpr bool kGuarded = !std::is_same_v<Guard_, Unguarded>;
  static constexpr bool kHasLevels = kLevelsOf<Space> != 1;
  using Target = Reference<Space, Scalar>;
  using References = TickReferences<Space, Scalar>;
  using JointVector = Vector<N, Scalar>;
  using JointState = State<N, Scalar>;
  using Result = Tick<Space, N, Scalar>;
  using Options = TrackerOptions<Scalar>;
  using JointLimiter = Limiter<kLevel, N, Scalar>;

  /// Starts from a state, or at rest, within the limits of the arm or given limits. Throws std::invalid_argument if an
  /// option is out of range, the scheme does not suit the arm, its gains are too high for the tick, a limit is missing
  /// (Limits), or the state violates a limit and options.recover_start is false. If the scheme has no damping, the
  /// tracker sets the damping of the options.
  Tracker(const Arm& arm, Space, const Scheme& scheme, const JointState& start, const Options& options,
          const Limits<kLevel, N, Scalar>& limits)
      : Tracker(arm, Space{}, scheme, start, options, limits, filled<JointVector>(start.q.size())) {}

  /// qdd0: acceleration of the previous tick, for bounds on jerk. guard: shapes to avoid.
  Tracker(const Arm& arm, Space, const Scheme& scheme, const JointState& start, const Options& options,
          const Limits<kLevel, N, Scalar>& limits, const JointVector& qdd0, const Guard_& guard = {})
      : arm_(arm),
        scheme_(scheme),
        continuous_(continuous_joints(arm, limits.bounds())),
        limited_(options, limits, start, qdd0, guard, continuous_),
        lower_levels_(options.stall_time, options.dt),
        measured_(limits, options.measured_delay),
        last_command_(qdd0) {
    scheme.require_dof(arm.dof());
    validation::require_size("limits", limits.bounds().lower.size(), arm.dof());
    if (limits.tick() != options.dt) {
      validation::fail("limits' tick", limits.tick(), "the tracker's dt = ", options.dt);
    }
    validation::require_joint_vector("q0", start.q, arm.dof());
    validation::require_joint_vector("qd0", start.qd, arm.dof());
    validation::require_joint_vector("qdd0", qdd0, arm.dof());
    if (options.recover_start) {
      limits.require_accelerations(start, qdd0);
    } else {
      limits.require_viable(start, qdd0);
    }
    validation::require_non_negative("null_damping", options.null_damping);
    Kinematics<Space, N, Scalar> kinematics;
    arm_.kinematics(start.q, kinematics);
    DefaultDamping<Scalar> damping = options.damping(arm.dof(), first_rows(kinematics).rows());
    damping.continuous = continuous_;
    give_damping(scheme_, damping);
    require_stable(scheme_, TickOfGains<Scalar>{options.dt, options.integral_gain});
    if constexpr (kGuarded) limited_.guard().require_clear(limits, start, qdd0);
    limited_.begin_at(kinematics.tip, kinematics.length);
  }

  Tracker(const Arm& arm, Space space, const Scheme& scheme, const JointState& start, const Options& options = {})
      : Tracker(arm, space, scheme, start, options, Limits<kLevel, N, Scalar>(arm.limits(), options.dt)) {}

  Tracker(const Arm& arm, Space space, const Scheme& scheme, const JointVector& q0, const Options& options = {})
      : Tracker(arm, space, scheme, JointState{q0, filled<JointVector>(q0.size())}, options) {}

  /// One tick toward a reference, which continues at constant acceleration until the end of the tick.
  Result tick(const Target& reference) noexcept {
    return advance(References::of([&](Scalar t) noexcept { return ahead(reference, t); }, limited_.dt()));
  }

  /// One tick with a source of references: a PathFollower, whose clock advances unless the arm stops, or a
  /// TargetFilter, which continues. For a stack, pass a source for each task in the order of the stack, or References.
  template <typename... Sources>
  Result tick(Sources&... sources) noexcept {
    const Result result =
        advance(References::of([&](Scalar t) noexcept { return joined(Space{}, t, sources...); }, limited_.dt()));
    (advance_source(sources, limited_.dt(), limited_.stopping()), ...);
    return result;
  }

  /// One tick with references.
  Result advance(References references) noexcept {
    const JointState& state = limited_.state();
    const auto& correction = limited_.correction();
    Result result = limited_.idle(state);
    Loop loop{arm_, scheme_, {}, state, filled<JointVector>(state.q.size())};
    points(state.q, loop.kinematics);
    remove_turns(arm_, loop.kinematics.tip, continuous_, references.stages);
    if constexpr (kHasLevels) {
      if (limited_.keeps_stopping()) held_level_.hold(references, loop.kinematics.tip, loop.kinematics.length);
    }
    measure_error(loop.kinematics, references.stages[0], result);
    if (lower_levels_.hold(references, loop.kinematics, result.error, limited_.correction())) {
      begin_correction(task_error(loop.kinematics, references.stages[0].x), correction.length());
    }
    const Target now = references.stages[0];
    if (correction.active()) {
      for (Target& stage : references.stages) stage = correction(stage);
    }
    const auto rows = limited_.rows();
    JointState next = state;
    resolve(loop, limited_.tick().update_middle(loop, references, gains_of<Scalar>(scheme_)), result);
    if (!failed(result.status)) next = limited_.tick().after(loop.motion());
    if (lower_levels_.rests() && !failed(result.status)) next = limited_.tick().slowed();
    limited_.finish_tick(loop, now, rows, next, result);
    lower_levels_.report(result);
    report_levels(loop.kinematics, now.x, result);
    lower_levels_.end_tick(!limited_.stopping() && !failed(result.status), limited_.state().qd,
                           Scalar(guard().near_distance_sum()), correction.length());
    return result;
  }

  /// For a tick whose desired motion is computed elsewhere (TrackerBatch). begin(): error at the start of the tick.
  /// Returns whether corrected() must replace the references before the motion is computed. finish(): `now` is the
  /// reference at the start of the tick, not corrected. `references` are corrected. `next` is the state after the
  /// desired motion.
  bool begin(const Vector<Space::kRows, Scalar>& error, Scalar length) noexcept {
    begin_correction(error, length);
    return limited_.correction().active();
  }
  [[nodiscard]] Target corrected(const Target& reference) const noexcept { return limited_.correction()(reference); }
  Status finish(const Target& now, const References& references, const JointState& next) noexcept {
    Result result = limited_.idle(state());
    result.error = limited_.correction().error();
    Loop loop{arm_, scheme_, {}, state(), filled<JointVector>(state().q.size())};
    const auto rows = limited_.rows();
    if (!limited_.is_free(rows, next)) {
      points(state().q, loop.kinematics);
      (void)limited_.tick().update_middle(loop, references, gains_of<Scalar>(scheme_));
    }
    limited_.finish_tick(loop, now, rows, next, result);
    return result.status;
  }

  /// Acceleration of the last tick and its change from the tick before (TickState).
  [[nodiscard]] const TickState<kLevel, Space, N, Scalar>& tick_state() const noexcept { return limited_.tick(); }

  /// Acceleration within the limits for a measured state that is at most options.measured_delay ticks old. The
  /// tracker's own state does not change. Never stalls: without feedback of the tip, a measured arm would sag.
  [[nodiscard]] Result resolve_measured(const JointVector& q, const JointVector& qd, const Target& reference) noexcept {
    static_assert(kLevel == Level::kAcceleration, "resolve_measured() is for schemes that return accelerations");
    const JointState measured{q, qd};
    Result result = limited_.idle(measured);
    if (!limited_.is_brakable(measured)) {
      result.status = Status::kNotFinite;
      multiply_scale(result, Scalar(0));
      result.qdd = last_command_ = fade(limited_.limits(), last_command_);
      return result;
    }
    Loop loop{arm_, scheme_, {}, measured, filled<JointVector>(q.size())};
    loop.update(Loop::packed(measured));
    std::array<Target, 1> now{reference};
    remove_turns(arm_, loop.kinematics.tip, continuous_, now);
    measure_error(loop.kinematics, now[0], result);
    resolve(loop, limited_.correction()(now[0]), result);
    result.qdd = last_command_ = limit_measured(loop, measured_, limited_, measured, last_command_, result);
    report_levels(loop.kinematics, reference.x, result);
    return result;
  }

  /// Brings every joint to rest as fast as the limits allow, for any reference, until resume() is called. With
  /// options.keep_first_level, the joints stop in the null space of the first level.
  void stop() noexcept { limited_.stop(); }
  void resume() noexcept {
    limited_.resume();
    held_level_.release();
    lower_levels_.release();
  }

  [[nodiscard]] const JointState& state() const noexcept { return limited_.state(); }
  /// Acceleration of the last tick.
  [[nodiscard]] const JointVector& acceleration() const noexcept { return limited_.last(); }
  [[nodiscard]] const Arm& arm() const noexcept { return arm_; }
  /// Bits of the continuous joints.
  [[nodiscard]] JointBits continuous() const noexcept { return continuous_; }
  /// Enables or disables level k of a stack, counted from 0. The first level is always enabled. The commands stay
  /// within all bounds. If there is no lower level k, returns false without an effect.
  bool enable(int k, bool on) noexcept {
    static_assert(kIsProduct<Space>, "only a stack has levels to enable");
    if (!arm_.enable(k, on)) return false;
    lower_levels_.release();
    return true;
  }

  /// Reorders levels of the same type: level k becomes the former level order[k], with its references. The integrals
  /// start at zero. The commands stay within all bounds. Returns false without an effect in the cases of
  /// Stack::reorder().
  template <typename Order>
  bool reorder(const Order& order) noexcept {
    static_assert(kIsProduct<Space>, "only a stack has levels to reorder");
    if (!arm_.reorder(order)) return false;
    limited_.correction().reset_integrals(0, Space::kRows);
    held_level_.release();
    lower_levels_.release();
    return true;
  }

  /// The guard: shapes to avoid, and their distances at the start of the last tick. Move shapes of the world with the
  /// functions of the guard.
  [[nodiscard]] Guard_& guard() noexcept { return limited_.guard(); }
  [[nodiscard]] const Guard_& guard() const noexcept { return limited_.guard(); }

  /// Tip f(q) of the tracker's own state, the usual start of a PathFollower.
  [[nodiscard]] typename Space::template Point<Scalar> tip() const noexcept {
    Kinematics<Space, N, Scalar> kinematics;
    arm_.kinematics(state().q, kinematics);
    return kinematics.tip;
  }

 private:
  using Loop = ClosedLoop<Arm, Scheme, Space>;
  using Measured = std::conditional_t<kLevel == Level::kAcceleration, MeasuredLimiter<N, Scalar>, NoMeasuredLimiter>;
  using X = typename Loop::X;

  /// Points of the tasks at q, without derivatives of J.
  void points(const JointVector& q, Kinematics<Space, N, Scalar>& kinematics) const noexcept {
    points_of(arm_, q, kinematics, 0);
  }

  void measure_error(const Kinematics<Space, N, Scalar>& kinematics, const Target& reference, Result& result) noexcept {
    result.error = task_error(kinematics, reference.x);
    begin_correction(result.error, kinematics.length);
  }
  void begin_correction(const Vector<Space::kRows, Scalar>& error, Scalar length) noexcept {
    limited_.correction().begin(error, length);
    approach_postures<kLevel, Space>(arm_, limited_.limits(), limited_.correction(), [](int) { return Scalar(0); });
  }

  /// Motion of the scheme after update(). σ is from the factorisation of the scheme, or from a factorisation of JJᵀ if
  /// the scheme does not report σ.
  static void resolve(Loop& loop, const Target& reference, Result& result) noexcept {
    X dx = Loop::packed(loop.state);
    result.sigma = Scalar(-1);
    result.status = loop.resolve(reference, dx, &result.sigma);
    if (result.sigma < Scalar(0)) result.sigma = least_singular_value_bound(first_rows(loop.kinematics));
  }

  Arm arm_;
  Scheme scheme_;
  JointBits continuous_;  ///< Bits of the continuous joints.
  LimitedState<kLevel, Space, N, Scalar, Guard_> limited_;
  typename LowerLevelsOf<Space, Scalar>::type lower_levels_;
  std::conditional_t<kHasLevels, HeldLevel<Space, Scalar>, NoHeldLevel> held_level_;
  Measured measured_;
  JointVector last_command_;  ///< Last command for a measured state.
};

}  // namespace fpbm
