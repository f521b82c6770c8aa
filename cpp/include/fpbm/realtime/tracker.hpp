#pragma once

#include "fpbm/clearance/guard.hpp"
#include "fpbm/limits/limiter.hpp"
#include "fpbm/realtime/correction.hpp"
#include "fpbm/realtime/path_follower.hpp"
#include "fpbm/realtime/slow_down.hpp"
#include "fpbm/realtime/stall_detector.hpp"
#include "fpbm/realtime/tick.hpp"
#include "fpbm/scheme/set_damping.hpp"
#include "fpbm/sim/closed_loop.hpp"
#include "fpbm/sim/rk4.hpp"
#include "fpbm/task/target_filter.hpp"

/// One tick of a control loop.
///
/// After construction nothing here allocates, throws, locks, does I/O or loops without a bound, whatever numbers are
/// passed in, and the same inputs give the same bits. Where no motion can be found, the arm brakes.
namespace fpbm {

/// Moves an arm tick by tick under a scheme, within its joint limits, through singular postures, to rest.
///
/// tick() integrates the tracker's own state by RK4: commands for an arm that takes positions or velocities and follows
/// them closely. resolve_measured() answers for a measured state: the acceleration for a torque controller to realise.
/// Never pass a measured state to tick(): the feedback would act twice, and noise would enter the command.
///
/// A step of RK4 that keeps every bound is taken as it is; otherwise the tick's mean motion is limited (Limiter).
///
/// With a Guard<kLevel, N, Scalar> in place of Unguarded it also keeps clear of shapes.
template <typename Arm, typename Space, typename Scheme, typename Guard_ = Unguarded>
class Tracker {
 public:
  using Scalar = typename Arm::Scalar;
  static constexpr int N = Arm::kDof;
  static constexpr Level kLevel = Scheme::kLevel;
  static constexpr bool kGuarded = !std::is_same_v<Guard_, Unguarded>;
  using Target = Reference<Space, Scalar>;
  using JointVector = Vector<N, Scalar>;
  using JointState = State<N, Scalar>;
  using Result = Tick<Space, N, Scalar>;
  using Options = TrackerOptions<Scalar>;
  using JointLimiter = Limiter<kLevel, N, Scalar>;

  /// Starts from a state, or at rest, within the arm's own limits or given ones. Throws std::invalid_argument where an
  /// option is out of range, the scheme does not fit the arm, a limit is missing (Limits), or the state breaks one.
  Tracker(const Arm& arm, Space, const Scheme& scheme, const JointState& start, const Options& options,
          const Limits<kLevel, N, Scalar>& limits)
      : Tracker(arm, Space{}, scheme, start, options, limits, JointVector::Zero(start.q.size())) {}

  /// qdd0: acceleration of the tick before, for bounds on jerk. guard: what the arm keeps clear of.
  Tracker(const Arm& arm, Space, const Scheme& scheme, const JointState& start, const Options& options,
          const Limits<kLevel, N, Scalar>& limits, const JointVector& qdd0, const Guard_& guard = {})
      : arm_(arm),
        scheme_(scheme),
        dt_(options.dt),
        correction_(options),
        stall_(options.stall_time, options.dt),
        limiter_(limits),
        guard_(guard),
        state_(start),
        last_(qdd0),
        answer_(qdd0) {
    scheme.require_dof(arm.dof());
    validation::require_size("limits", limits.bounds().lower.size(), arm.dof());
    if (limits.tick() != dt_) {
      validation::fail("limits' tick", static_cast<double>(limits.tick()), "the tracker's dt");
    }
    validation::require_joint_vector("q0", start.q, arm.dof());
    validation::require_joint_vector("qd0", start.qd, arm.dof());
    validation::require_joint_vector("qdd0", qdd0, arm.dof());
    limits.require_viable(start, qdd0);
    set_damping(scheme_, options.singular);
    if constexpr (kGuarded) guard_.require_clear(limits, start, qdd0);
  }

  Tracker(const Arm& arm, Space space, const Scheme& scheme, const JointState& start, const Options& options = {})
      : Tracker(arm, space, scheme, start, options, Limits<kLevel, N, Scalar>(arm.limits(), options.dt)) {}

  Tracker(const Arm& arm, Space space, const Scheme& scheme, const JointVector& q0, const Options& options = {})
      : Tracker(arm, space, scheme, JointState{q0, JointVector::Zero(q0.size())}, options) {}

  /// One tick toward a reference, which continues at constant acceleration until the tick's end.
  Result tick(const Target& reference) noexcept {
    return advance([&reference](Scalar seconds) noexcept { return ahead(reference, seconds); });
  }

  /// One tick behind a path follower, whose clock advances.
  template <typename Path>
  Result tick(PathFollower<Path>& follower) noexcept {
    const Result result = advance([&follower](Scalar seconds) noexcept { return follower.ahead(seconds); });
    if (!stopping_) follower.advance(dt_);
    return result;
  }

  /// One tick behind a filter of targets, which goes on where the arm stops, too.
  Result tick(TargetFilter<Space, Scalar>& filter) noexcept {
    const Result result = advance([&filter](Scalar seconds) noexcept { return filter.ahead(seconds); });
    filter.advance();
    return result;
  }

  /// The acceleration within the limits for a measured state; the tracker's own state does not change. It never stalls:
  /// without feedback of the tip a measured arm would sag.
  [[nodiscard]] Result resolve_measured(const JointVector& q, const JointVector& qd, const Target& reference) noexcept {
    static_assert(kLevel == Level::kAcceleration, "resolve_measured() is for schemes that return accelerations");
    const JointState measured{q, qd};
    Result result = idle(measured);
    if (!moderate(measured)) {
      result.status = Status::kNotFinite;
      result.scale = Scalar(0);
      result.qdd = answer_ = fade(limiter_.limits(), answer_);
      return result;
    }
    Loop loop{arm_, scheme_, {}, measured, JointVector::Zero(q.size())};
    X dx = packed(measured);
    loop.update(dx);
    watch(loop.kinematics, reference, result);
    auto rows = guard_.rows(limiter_.limits(), measured);
    result.status = loop.resolve(correction_(reference), dx);
    if constexpr (kGuarded) guard_.bound_tip_speed(limiter_.limits(), measured, loop.qdd, rows);
    result.qdd = answer_ = limited(loop.kinematics, measured, answer_, loop.qdd, rows, result);
    if (result.status == Status::kOk) correction_.integrate();
    return result;
  }

  /// Brings every joint to rest as fast as the limits allow, whatever the reference, until resume() is called.
  void stop() noexcept { stopping_ = true; }
  void resume() noexcept {
    stopping_ = false;
    stall_.reset();
  }

  [[nodiscard]] const JointState& state() const noexcept { return state_; }
  /// Acceleration of the last tick.
  [[nodiscard]] const JointVector& acceleration() const noexcept { return last_; }
  [[nodiscard]] const Arm& arm() const noexcept { return arm_; }

  /// What the arm keeps clear of, and how near it was at the last tick's start. World shapes may be moved in it.
  [[nodiscard]] Guard_& guard() noexcept { return guard_; }
  [[nodiscard]] const Guard_& guard() const noexcept { return guard_; }

  /// Tip f(q) of the tracker's own state, where a PathFollower usually starts.
  [[nodiscard]] typename Space::template Point<Scalar> tip() const noexcept {
    Kinematics<Space, N, Scalar> kinematics;
    arm_.kinematics(state_.q, kinematics);
    return kinematics.tip;
  }

 private:
  using Twist = Vector<Space::kRows, Scalar>;
  using Loop = ClosedLoop<Arm, Scheme, Space>;
  using X = typename Loop::X;
  static constexpr bool kSecondOrder = Loop::kSecondOrder;

  [[nodiscard]] static X packed(const JointState& state) noexcept {
    X x(state.q.size(), kSecondOrder ? 2 : 1);
    x.col(0) = state.q;
    if constexpr (kSecondOrder) x.col(1) = state.qd;
    return x;
  }

  [[nodiscard]] static Result idle(const JointState& state) noexcept {
    return {state.q, state.qd, JointVector::Zero(state.q.size()), Status::kOk, Scalar(1), 0, Scalar(0), Twist::Zero()};
  }

  /// Whether a state is finite and far enough from overflow to brake from.
  [[nodiscard]] bool moderate(const JointState& state) const noexcept {
    return state.q.allFinite() && JointVector(state.qd * (Scalar(4) / dt_)).allFinite();
  }

  /// reference(seconds) is the reference that many seconds into the tick.
  template <typename References>
  Result advance(References&& reference) noexcept {
    Result result = idle(state_);
    Loop loop{arm_, scheme_, {}, state_, JointVector::Zero(state_.q.size())};
    X x = packed(state_);
    X dx = x;
    loop.update(x);
    const Target now = reference(Scalar(0));
    watch(loop.kinematics, now, result);
    auto rows = guard_.rows(limiter_.limits(), state_);
    if constexpr (kGuarded) {
      if (stall_.stalled()) stall_.wait(state_.qd.isZero(Scalar(0)), guard_.room(), loop.kinematics.length);
    }
    const auto derivative = [&](Scalar seconds, const X& stage_x, X& stage_dx) noexcept {
      return loop.evaluate(correction_(reference(seconds)), stage_x, stage_dx);
    };
    result.status = loop.resolve(correction_(now), dx);
    const JointVector field = dx.col(0);
    if (!failed(result.status)) result.status = worse(result.status, RK4::step(derivative, Scalar(0), dt_, dx, x));

    JointState next{x.col(0), state_.qd};
    if constexpr (kSecondOrder) {
      next.qd = x.col(1);
      if (limiter_.limits().bounds_jerk()) next.q = moved(JointVector((next.qd - state_.qd) / dt_));
    } else {
      next.qd = (next.q - state_.q) / dt_;
    }
    if constexpr (kGuarded) {
      if (guard_.draws_away() && !failed(result.status)) next = after(motion_to(next) + self_motion_away(next.q));
      guard_.bound_tip_speed(limiter_.limits(), state_, motion_to(next), rows);
    }
    if (!moderate(next)) result.status = Status::kNotFinite;
    if (stall_.stalled()) result.status = worse(result.status, Status::kStalled);
    if (stopping_ || result.status >= Status::kStalled || !limiter_.limits().admits(state_, next, last_) ||
        !rows.admit(motion_to(next))) {
      JointVector desired = next.qd;
      Scalar share(1);
      if constexpr (kSecondOrder) {
        desired = (next.qd - state_.qd) / dt_;
      } else if (!failed(result.status)) {
        share = slow_down(loop, limiter_.limits(), correction_(now), state_.q, field);
        if (share < Scalar(1)) desired = share * field;
      }
      // The Jacobian at the tick's middle: joints that take over then do not disturb the tip.
      const JointVector middle = (state_.q + next.q) / Scalar(2);
      arm_.kinematics(middle, loop.kinematics);
      const JointVector u = limited(loop.kinematics, state_, last_, desired, rows, result);
      if (share < Scalar(1)) {
        result.scale *= share;
        result.status = worse(result.status, Status::kSlowed);
      }
      next = after(u);
    }
    if constexpr (kGuarded) {
      const bool braking = stopping_ || failed(result.status);
      if (!guard_.empty() && (braking || !guard_.accepts(limiter_.limits(), state_, next))) {
        const JointVector qdd = guard_.stop(limiter_.limits(), state_, last_);
        next = after(kSecondOrder ? qdd : JointVector(state_.qd + dt_ * qdd));
        result.scale = Scalar(0);
        if (!braking) result.status = Status::kBlocked;
      }
    }
    result.q = next.q;
    result.qd = next.qd;
    result.qdd = last_ = (next.qd - state_.qd) / dt_;
    state_ = next;
    if (stopping_ || failed(result.status)) return result;
    if (result.status == Status::kOk) correction_.integrate();
    if (result.scale < Scalar(1) || correction_.far()) stall_.update(now.x, result.error, loop.kinematics.length);
    return result;
  }

  /// The part of the motion away from shapes that leaves the task alone, in a tick that ends at a posture.
  [[nodiscard]] JointVector self_motion_away(const JointVector& end) noexcept {
    const JointVector middle = (state_.q + end) / Scalar(2);
    Kinematics<Space, N, Scalar> kinematics;
    arm_.kinematics(middle, kinematics);
    const auto Z = null_basis<Space::kRows, N, Scalar>(jacobian_in_metres(kinematics));
    return Z.lazyProduct(Z.transpose().lazyProduct(guard_.away(state_.q)).eval());
  }

  /// The motion of a tick: its mean acceleration, or its velocity at velocity level.
  [[nodiscard]] JointVector motion_to(const JointState& next) const noexcept {
    return kSecondOrder ? JointVector((next.qd - state_.qd) / dt_) : next.qd;
  }

  /// The state after a tick of some motion.
  [[nodiscard]] JointState after(const JointVector& u) const noexcept {
    if constexpr (kSecondOrder) return {moved(u), state_.qd + dt_ * u};
    return {state_.q + dt_ * u, u};
  }

  /// The position after a tick of constant acceleration.
  [[nodiscard]] JointVector moved(const JointVector& qdd) const noexcept {
    return state_.q + dt_ * (state_.qd + dt_ / Scalar(2) * qdd);
  }

  /// The desired motion within the limits, after a tick of acceleration last; the motion to rest where the scheme
  /// failed or stop() was called.
  template <int P>
  [[nodiscard, gnu::noinline]] JointVector limited(const Kinematics<Space, N, Scalar>& kinematics,
                                                   const JointState& state, const JointVector& last,
                                                   const JointVector& desired, const Rows<N, P, Scalar>& rows,
                                                   Result& result) const noexcept {
    const bool braking = stopping_ || result.status >= Status::kStalled;
    const bool gives_way = result.status == Status::kStalled;
    const auto found = braking ? limiter_.brake(state, last, gives_way ? rows : Rows<N, P, Scalar>{})
                               : limiter_.motion(jacobian_in_metres(kinematics), state, desired, last, rows);
    result.scale = found.scale;
    result.saturated = found.joints;
    if (found.scale < Scalar(1) && !braking) {
      result.status = guard_.is_near(found.rows) ? Status::kBlocked : Status::kSlowed;
    }
    return found.u;
  }

  void watch(const Kinematics<Space, N, Scalar>& kinematics, const Target& reference, Result& result) noexcept {
    result.sigma = least_singular_value_bound(kinematics.J);
    result.error = Space::template difference<Scalar>(reference.x, kinematics.tip);
    correction_.begin(result.error, kinematics.length);
  }

  Arm arm_;
  Scheme scheme_;
  Scalar dt_;
  Correction<kLevel, Space, Scalar> correction_;
  StallDetector<Space, Scalar> stall_;
  JointLimiter limiter_;
  Guard_ guard_;
  JointState state_;
  JointVector last_;    ///< Acceleration of the last tick.
  JointVector answer_;  ///< The last one for a measured state.
  bool stopping_ = false;
};

}  // namespace fpbm
