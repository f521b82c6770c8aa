#pragma once

#include <type_traits>

#include "fpbm/model/detail/continuous_joints.hpp"
#include "fpbm/realtime/detail/account.hpp"
#include "fpbm/realtime/detail/desire.hpp"
#include "fpbm/realtime/detail/limit.hpp"
#include "fpbm/realtime/detail/measured_limiter.hpp"
#include "fpbm/realtime/detail/prove.hpp"
#include "fpbm/realtime/detail/reference_sources.hpp"
#include "fpbm/realtime/detail/require_stable.hpp"
#include "fpbm/realtime/detail/tick_references.hpp"
#include "fpbm/realtime/tick.hpp"
#include "fpbm/scheme/detail/set_damping.hpp"
#include "fpbm/singular/detail/damped_gram.hpp"

namespace fpbm {

/// Moves an arm tick by tick with a scheme, within its joint limits and through singular postures (docs/realtime.md).
///
/// tick() advances the tracker's own state (docs/tick.md, A tick). The result of tick() is a command for an arm
/// that accepts positions or velocities and follows them closely. resolve_measured() computes the acceleration for a
/// measured state, for a torque controller. Never pass a measured state to tick(): the feedback would act twice, and
/// noise would enter the command.
/// After construction, no function allocates, throws, locks or does I/O. Equal inputs give equal bits.
template <typename Arm, typename Space, typename Scheme, typename Bounds_ = Bounds<>>
class Tracker {
 public:
  using Scalar = typename Arm::Scalar;
  static constexpr int N = Arm::kDof;
  static_assert(require_members<Scheme, Space, N, Scalar>());
  static constexpr Level kLevel = Scheme::kLevel;
  static constexpr bool kBounded = !std::is_same_v<Bounds_, Bounds<>>;
  using Target = Reference<Space, Scalar>;
  using References = TickReferences<Space, Scalar>;
  using JointVector = Vector<N, Scalar>;
  using JointState = State<N, Scalar>;
  using Result = Tick<Space, N, Scalar>;
  using Options = TrackerOptions<Scalar>;

  /// Starts from a state, or at rest, within the limits of the arm or given limits. Throws std::invalid_argument if an
  /// option is out of range, the scheme does not suit the arm or the tick, a limit is missing (Limits), or the state
  /// violates a limit and options.recover_start is false. The damping of the options is for schemes without damping.
  Tracker(const Arm& arm, Space, const Scheme& scheme, const JointState& start, const Options& options,
          const Limits<kLevel, N, Scalar>& limits)
      : Tracker(arm, Space{}, scheme, start, options, limits, filled<JointVector>(start.q.size())) {}

  /// qdd0: acceleration of the previous tick, for bounds on jerk. bounds: further bounds.
  Tracker(const Arm& arm, Space, const Scheme& scheme, const JointState& start, const Options& options,
          const Limits<kLevel, N, Scalar>& limits, const JointVector& qdd0, const Bounds_& bounds = {})
      : arm_(arm),
        scheme_(scheme),
        state_(options, limits, start, qdd0, bounds, continuous_joints(arm, limits.bounds())),
        measured_(limits, options.measured_delay),
        last_command_(qdd0) {
    scheme.require_dof(arm.dof());
    state_.require_start(options, arm.dof());
    const auto kinematics = this->kinematics();
    give_damping(scheme_, options.damping(arm.dof(), first_rows(kinematics).rows(), state_.continuous));
    require_stable(scheme_, TickOfGains<Scalar>{options.dt, options.integral_gain});
    state_.require_bounds();
    if (!state_.returning) state_.progress.begin_at(start.q, kinematics.tip, kinematics.length);
  }

  Tracker(const Arm& arm, Space space, const Scheme& scheme, const JointState& start, const Options& options = {})
      : Tracker(arm, space, scheme, start, options, Limits<kLevel, N, Scalar>(arm.limits(), options.dt)) {}

  Tracker(const Arm& arm, Space space, const Scheme& scheme, const JointVector& q0, const Options& options = {})
      : Tracker(arm, space, scheme, JointState{q0, filled<JointVector>(q0.size())}, options) {}

  /// One tick toward a reference, which continues at constant acceleration until the end of the tick.
  Result tick(const Target& reference) noexcept {
    return advance(References::of([&](Scalar t) noexcept { return ahead(reference, t); }, state_.dt()));
  }

  /// One tick with a source of references: a PathFollower, whose clock advances unless the arm stops, or a
  /// TargetFilter, which continues. For a stack, pass a source for each task in the order of the stack, or References.
  template <typename... Sources>
  Result tick(Sources&... sources) noexcept {
    (set_source_speed(sources, state_.speed), ...);
    (look_ahead(sources, state_.stopping, state_.bounds, state_.tick.joints.q), ...);
    if constexpr (kLevel == Level::kAcceleration) (take_planned_state(sources, state_.planned), ...);
    const Result result = advance(references_of(Space{}, state_.dt(), sources...));
    (advance_source(sources, state_.dt(), kLevel, state_.stopping, result.path_fraction), ...);
    return result;
  }

  /// One tick with TickReferences or PathReferences. approach(): state of a kept path that the null space approaches.
  void approach(const JointState& planned) noexcept { state_.planned = planned; }
  template <typename References_>
  Result advance(const References_& references) noexcept {
    Result result = state_.idle(state_.tick.joints);
    const auto desired = desire(arm_, scheme_, state_, references, result);
    finish_tick(desired, state_.rows(desired.u), result);
    return result;
  }

  /// For a tick whose desired motion u is computed elsewhere (TrackerBatch). begin(): error at the start of the tick.
  /// Returns whether corrected() must replace the references before the motion is computed. finish(): desire_given().
  bool begin(const Vector<Space::kRows, Scalar>& error, Scalar length) noexcept {
    begin_correction(arm_, state_, error, length);
    return state_.correction.active();
  }
  [[nodiscard]] Target corrected(const Target& reference) const noexcept { return state_.correction(reference); }
  Status finish(const Target& now, const References& references, const JointVector& u) noexcept {
    Result result = state_.idle(state());
    result.error = state_.correction.error();
    auto rows = state_.rows(u);
    const auto desired = desire_given(arm_, scheme_, state_, now, references, u, rows);
    finish_tick(desired, rows, result);
    return result.status;
  }

  /// Acceleration within the limits for a measured state that is at most options.measured_delay ticks old. The
  /// tracker's own state does not change. Never stalls: without feedback of the tip, a measured arm would sag.
  [[nodiscard]] Result resolve_measured(const JointVector& q, const JointVector& qd, const Target& reference) noexcept {
    static_assert(kLevel == Level::kAcceleration, "resolve_measured() is for schemes that return accelerations");
    const JointState measured{q, qd};
    Result result = state_.idle(measured);
    if (!state_.is_brakable(measured)) {
      result.status = Status::kNotFinite;
      multiply_scale(result, Scalar(0));
      result.qdd = last_command_ = fade(state_.limits(), last_command_);
      return result;
    }
    const auto desired = desire_measured(arm_, scheme_, state_, measured, reference, result);
    result.qdd = last_command_ = limit_measured(state_, measured_, desired, last_command_, result);
    if (result.status == Status::kOk) state_.correction.integrate(result);
    report_levels(desired.loop.kinematics, reference.x, result);
    return result;
  }

  /// Sets the speed of all followers and filters of the following ticks. Returns false if it is not in (0, 1].
  bool set_speed(Scalar fraction) noexcept { return state_.set_speed(fraction); }

  /// Brings every joint to rest as fast as the limits allow, for any reference, until resume() is called. With
  /// options.keep_first_level, the joints stop in the null space of the first level.
  void stop() noexcept { state_.stopping = true; }
  void resume() noexcept { state_.resume(); }

  [[nodiscard]] const JointState& state() const noexcept { return state_.tick.joints; }
  /// Acceleration of the last tick, and its change from the tick before.
  [[nodiscard]] const JointVector& acceleration() const noexcept { return state_.tick.last; }
  [[nodiscard]] const JointVector& acceleration_change() const noexcept { return state_.tick.change; }
  [[nodiscard]] const Arm& arm() const noexcept { return arm_; }
  [[nodiscard]] const Scheme& scheme() const noexcept { return scheme_; }  ///< With the damping of the options.
  /// Bits of the continuous joints.
  [[nodiscard]] JointBits continuous() const noexcept { return state_.continuous; }
  /// Enables or disables level k > 0 of a stack, within all bounds. If there is no level k, returns false.
  bool enable(int k, bool on) noexcept {
    static_assert(kIsProduct<Space>, "only a stack has levels to enable");
    if (!arm_.enable(k, on)) return false;
    state_.lower_levels.release();
    return true;
  }

  /// Stack::reorder() of levels of the same type: level k becomes the former level order[k], with its references.
  template <typename Order>
  bool reorder(const Order& order) noexcept {
    static_assert(kIsProduct<Space>, "only a stack has levels to reorder");
    if (!arm_.reorder(order)) return false;
    state_.reordered();
    return true;
  }

  /// Bounds::get() returns the bound of a type, for example the Clearance, whose obstacles can move.
  [[nodiscard]] Bounds_& bounds() noexcept { return state_.bounds; }
  [[nodiscard]] const Bounds_& bounds() const noexcept { return state_.bounds; }

  /// Lower bound on σ_min(J) of the first level in the tracker's own state, tight within a factor √M.
  [[nodiscard]] Scalar sigma() const noexcept { return least_singular_value_bound(first_rows(kinematics())); }
  /// Tip f(q) of the tracker's own state, the usual start of a PathFollower.
  [[nodiscard]] typename Space::template Point<Scalar> tip() const noexcept { return kinematics().tip; }

 private:
  [[nodiscard]] Kinematics<Space, N, Scalar> kinematics() const noexcept {
    Kinematics<Space, N, Scalar> kinematics;
    arm_.kinematics(state().q, kinematics);
    return kinematics;
  }

  template <typename Desired_, typename Rows_>
  void finish_tick(const Desired_& desired, const Rows_& rows, Result& result) noexcept {
    const bool damped = result.status == Status::kDamped;
    const JointVector u = limit(state_, desired, rows, result);
    JointState next = prove(state_, desired, rows, u, result);
    report_path(state_, desired, rows, next, result);
    account(state_, desired, std::move(next), damped, result);
  }

  Arm arm_;
  Scheme scheme_;
  TrackerState<kLevel, Space, N, Scalar, Bounds_> state_;
  std::conditional_t<kLevel == Level::kAcceleration, MeasuredLimiter<N, Scalar>, NoMeasuredLimiter> measured_;
  JointVector last_command_;  ///< Last command for a measured state.
};

}  // namespace fpbm
