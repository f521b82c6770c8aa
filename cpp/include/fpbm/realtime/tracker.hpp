#pragma once

#include <cmath>
#include <cstdint>

#include "fpbm/integrator/closed_loop.hpp"
#include "fpbm/integrator/rk4.hpp"
#include "fpbm/realtime/course.hpp"
#include "fpbm/resolver/damping.hpp"
#include "fpbm/resolver/limits.hpp"
#include "fpbm/resolver/saturation.hpp"
#include "fpbm/resolver/yielding.hpp"

/// One tick of a control loop.
///
/// After construction nothing here allocates, throws, locks, does I/O or loops without a bound, whatever the numbers
/// that are passed in, and the same inputs give the same bits. Where no motion can be found, the arm brakes.
namespace fpbm {

template <typename Scalar = double>
struct TrackerOptions {
  Scalar dt = Scalar(1e-3);  ///< Length of a tick [s].
  /// Gain of ∫(x ⊖ f(q)) dt, added to the reference's acceleration [1/s³] or velocity [1/s²]: takes away the error that
  /// a constant bias leaves (PID feedback: Guo et al. 2018). Below k₁k₂ for stability. It waits while the task is
  /// slowed or damped, and adds integral_bound at most [m/s², rad/s²], or [m/s, rad/s].
  Scalar integral_gain = Scalar(0);
  Scalar integral_bound = Scalar(1);
  /// How far away the target may seem at most [m, rad]: a farther one, out of reach perhaps, pulls no harder.
  Scalar pull = Scalar(0.1);
  SingularDamping<Scalar> singular = SingularDamping<Scalar>();  ///< Stands in where the scheme has none.
};

/// What one tick did.
template <typename Space, int N, typename Scalar = double>
struct Tick {
  Vector<N, Scalar> q;                 ///< Command for the tick's end [rad], or [m] for a prismatic joint.
  Vector<N, Scalar> qd;                ///< Its velocity [rad/s].
  Vector<N, Scalar> qdd;               ///< Acceleration over the tick [rad/s²].
  Status status;                       ///< Where it failed, why the arm brakes.
  Scalar scale;                        ///< How much of the task the limits left: 1 all of it, 0 the arm brakes.
  std::uint32_t saturated;             ///< Bit i is set where joint i is on a bound.
  Scalar sigma;                        ///< Lower bound on σ_min(J), at most √M times too low, at the tick's start.
  Vector<Space::kRows, Scalar> error;  ///< x ⊖ f(q) at the tick's start [m, rad].
};

/// Moves an arm tick by tick under a scheme, within its joints' limits, through singular postures, to rest.
///
/// tick() integrates the tracker's own state by RK4: the command of an arm that is led by positions or velocities and
/// follows them closely. resolve_measured() answers for a state measured just now: the acceleration that a torque
/// controller is to realise. Never feed a measured state to tick(): the feedback would act twice, and noise would enter
/// the command.
///
/// Where RK4's step keeps every bound it is taken as it is. Otherwise the tick's mean motion is saturated in the null
/// space (resolver/saturation.hpp) within the box of resolver/limits.hpp.
template <typename Arm, typename Space, typename Scheme>
class Tracker {
 public:
  using Scalar = typename Arm::Scalar;
  static constexpr int N = Arm::kDof;
  static constexpr Level kLevel = Scheme::kLevel;
  using Target = Reference<Space, Scalar>;
  using Row = Vector<N, Scalar>;
  using Twist = Vector<Space::kRows, Scalar>;
  using JointState = State<N, Scalar>;
  using Result = Tick<Space, N, Scalar>;
  using Options = TrackerOptions<Scalar>;

  /// Starts from a state, or at rest, within the arm's limits or others. Throws std::invalid_argument where an option
  /// is out of range, the scheme does not fit the arm, a limit is missing (Limits), or the state breaks one.
  Tracker(const Arm& arm, Space, const Scheme& scheme, const JointState& start, const Options& options,
          const Limits<kLevel, N, Scalar>& limits)
      : arm_(arm),
        scheme_(scheme),
        options_(options),
        limits_(limits),
        state_(start),
        scale_(limits.bounds().acceleration) {
    validation::require_non_negative("integral_gain", static_cast<double>(options.integral_gain));
    validation::require_positive("integral_bound", static_cast<double>(options.integral_bound));
    validation::require_positive("pull", static_cast<double>(options.pull));
    scheme.require_dof(arm.dof());
    validation::require_size("limits", limits.bounds().lower.size(), arm.dof());
    if (limits.tick() != options.dt) {
      validation::fail("limits' tick", static_cast<double>(limits.tick()), "the tracker's dt");
    }
    validation::require_joint_vector("q0", start.q, arm.dof());
    validation::require_joint_vector("qd0", start.qd, arm.dof());
    limits_.require_viable(start);
    for (Eigen::Index i = 0; i < scale_.size(); ++i) {
      if (!std::isfinite(scale_(i))) scale_(i) = Scalar(1);
    }
    if (scheme_.singular.radius() == Scalar(0)) scheme_.singular = options.singular;
  }

  Tracker(const Arm& arm, Space space, const Scheme& scheme, const JointState& start, const Options& options = {})
      : Tracker(arm, space, scheme, start, options, Limits<kLevel, N, Scalar>(arm.limits(), options.dt)) {}

  Tracker(const Arm& arm, Space space, const Scheme& scheme, const Row& q0, const Options& options = {})
      : Tracker(arm, space, scheme, JointState{q0, Row::Zero(q0.size())}, options) {}

  /// One tick toward a reference, which goes on at constant acceleration until the tick's end.
  Result tick(const Target& reference) noexcept {
    return advance([&reference](Scalar seconds) noexcept {
      Target later = reference;
      if (seconds != Scalar(0)) {
        const Twist way = seconds * (reference.xd + seconds / Scalar(2) * reference.xdd);
        later.x = Space::template displace<Scalar>(reference.x, way);
        later.xd += seconds * reference.xdd;
      }
      return later;
    });
  }

  /// One tick along a course, whose clock goes on with it.
  template <typename Path>
  Result tick(Course<Path>& course) noexcept {
    const Result result = advance([&course](Scalar seconds) noexcept { return course.ahead(seconds); });
    if (!stopping_) course.advance(options_.dt);
    return result;
  }

  /// The acceleration within the limits for a state measured now; the tracker's own state stays as it is.
  [[nodiscard]] Result resolve_measured(const Row& q, const Row& qd, const Target& reference) noexcept {
    static_assert(kLevel == Level::kAcceleration, "resolve_measured() is for schemes that return accelerations");
    const JointState measured{q, qd};
    Result result = idle(measured);
    if (!(q.allFinite() && qd.allFinite())) {
      result.status = Status::kNotFinite;
      result.qd.setZero();
      return result;
    }
    Loop loop{arm_, scheme_, {}, measured, Row::Zero(q.size())};
    X x = packed(measured);
    X dx = x;
    loop.look(x);
    watch(loop.kinematics, reference, result);
    result.status = loop.resolve(corrected(reference, excess(result.error)), dx);
    const Box<N, Scalar> box = limits_.box(measured);
    if (stopping_ || failed(result.status)) {
      result.qdd = limits_.brake(measured, box);
      result.scale = Scalar(0);
    } else if (box.contains(loop.qdd)) {
      result.qdd = loop.qdd;
    } else {
      saturate(loop.kinematics.J, measured, box, loop.qdd, result, result.qdd);
    }
    integrate(result);
    return result;
  }

  /// Brings every joint to rest as fast as the limits allow, whatever the reference, until go_on().
  void stop() noexcept { stopping_ = true; }
  void go_on() noexcept { stopping_ = false; }

  [[nodiscard]] const JointState& state() const noexcept { return state_; }
  [[nodiscard]] const Arm& arm() const noexcept { return arm_; }

  /// Where the tip is, f(q) of the tracker's own state: where a Course starts as a rule.
  [[nodiscard]] typename Space::template Point<Scalar> tip() const noexcept {
    Kinematics<Space, N, Scalar> kinematics;
    arm_.kinematics(state_.q, kinematics);
    return kinematics.tip;
  }

 private:
  using Loop = ClosedLoop<Arm, Scheme, Space>;
  using X = typename Loop::X;

  [[nodiscard]] static X packed(const JointState& state) noexcept {
    X x(state.q.size(), Loop::kSecondOrder ? 2 : 1);
    x.col(0) = state.q;
    if constexpr (Loop::kSecondOrder) x.col(1) = state.qd;
    return x;
  }

  [[nodiscard]] static Result idle(const JointState& state) noexcept {
    return {state.q, state.qd,  Row::Zero(state.q.size()),           Status::kOk, Scalar(1),
            0,       Scalar(0), Vector<Space::kRows, Scalar>::Zero()};
  }

  /// `reference(seconds)` is the reference so far into the tick.
  template <typename References>
  Result advance(References&& reference) noexcept {
    const Scalar h = options_.dt;
    Result result = idle(state_);
    Loop loop{arm_, scheme_, {}, state_, Row::Zero(state_.q.size())};
    X x = packed(state_);
    X dx = x;
    loop.look(x);
    const Target now = reference(Scalar(0));
    watch(loop.kinematics, now, result);
    const Twist shift = excess(result.error);
    const auto derivative = [&](Scalar seconds, const X& stage_x, X& stage_dx) noexcept {
      return loop.evaluate(corrected(reference(seconds), shift), stage_x, stage_dx);
    };
    result.status = loop.resolve(corrected(now, shift), dx);
    if (!failed(result.status)) result.status = worse(result.status, RK4::step(derivative, Scalar(0), h, dx, x));

    JointState next{x.col(0), state_.qd};
    Row wanted;  // The mean acceleration, or velocity, over the tick.
    if constexpr (Loop::kSecondOrder) {
      next.qd = x.col(1);
      wanted = (next.qd - state_.qd) / h;
    } else {
      wanted = (next.q - state_.q) / h;
      next.qd = wanted;
    }
    if (!failed(result.status) && !(next.q.allFinite() && next.qd.allFinite())) result.status = Status::kNotFinite;

    if (stopping_ || failed(result.status) || !limits_.admits(state_, next)) {
      const Box<N, Scalar> box = limits_.box(state_);
      if (stopping_ || failed(result.status)) {
        wanted = limits_.brake(state_, box);
        result.scale = Scalar(0);
      } else {
        if constexpr (!Loop::kSecondOrder) wanted = braked(loop, corrected(now, shift), dx, wanted);
        // The Jacobian of the tick's middle: joints that take over then do so without a trace in the tip.
        const Row middle = (state_.q + next.q) / Scalar(2);
        arm_.kinematics(middle, loop.kinematics);
        saturate(loop.kinematics.J, state_, box, wanted, result, wanted);
      }
      if constexpr (Loop::kSecondOrder) {
        next.q = state_.q + h * (state_.qd + h / Scalar(2) * wanted);
        next.qd = state_.qd + h * wanted;
      } else {
        next.q = state_.q + h * wanted;
        next.qd = wanted;
      }
    }
    result.q = next.q;
    result.qd = next.qd;
    result.qdd = Loop::kSecondOrder ? wanted : Row((next.qd - state_.qd) / h);
    state_ = next;
    integrate(result);
    return result;
  }

  /// What is wanted, within the box; wanted and u may be one.
  [[gnu::noinline]] void saturate(const Matrix<Space::kRows, N, Scalar>& J, const JointState& state,
                                  const Box<N, Scalar>& box, const Row& wanted, Result& result, Row& u) noexcept {
    const Row rest = limits_.brake(state, box);
    Saturated<N, Scalar> found = NullSpaceSaturation<Space::kRows, N, Scalar>(J, scale_)(box, rest, wanted);
    result.scale = found.scale;
    result.saturated = found.joints;
    if (found.scale < Scalar(1)) {
      result.status = Status::kSlowed;
      yield(J, state, box, wanted, found);
    }
    u = found.u.allFinite() ? found.u : rest;
  }

  /// Where the limits leave next to nothing of the task's direction the arm would stand still for good: the less there
  /// is left, the more it yields.
  void yield(const Matrix<Space::kRows, N, Scalar>& J, const JointState& state, const Box<N, Scalar>& box,
             const Row& wanted, Saturated<N, Scalar>& found) const noexcept {
    const Twist task = J.lazyProduct(wanted);
    Scalar left = found.scale;
    if constexpr (!Loop::kSecondOrder) left = J.lazyProduct(found.u).dot(task) / task.squaredNorm();
    const Scalar share = Scalar(1) - (left > Scalar(0) ? left : Scalar(0)) / kLittle;
    if (!(share > Scalar(0))) return;
    const Scalar mu = kYieldRadius * kYieldRadius * J.squaredNorm();
    Row rest = Row::Zero(state.q.size());
    if constexpr (Loop::kSecondOrder) rest = -kYieldDamping * state.qd;
    found.u += share * share * (yielding<Space::kRows, N, Scalar>(J, task, mu, rest, box) - found.u);
  }

  /// A field of velocities that asks for greater accelerations than the joints have would make them swing: slowed until
  /// it does not.
  [[nodiscard]] Row braked(Loop& loop, const Target& reference, const X& field, const Row& wanted) const noexcept {
    const Row v = field.col(0);
    Scalar ahead = options_.dt;
    for (Eigen::Index i = 0; i < v.size(); ++i) {
      const Scalar way = std::abs(v(i)) * ahead;
      const Scalar most = limits_.bounds().velocity(i) * options_.dt;
      if (way > most) ahead *= most / way;
    }
    X later = field;
    const X x = state_.q + ahead * v;
    if (failed(loop.evaluate(reference, x, later))) return v;
    Scalar square = Scalar(1);
    for (Eigen::Index i = 0; i < v.size(); ++i) {
      const Scalar change = std::abs(later(i, 0) - v(i)) / ahead;
      if (square * change > limits_.bounds().acceleration(i)) square = limits_.bounds().acceleration(i) / change;
    }
    return square < Scalar(1) ? Row(std::sqrt(square) * v) : wanted;
  }

  void watch(const Kinematics<Space, N, Scalar>& kinematics, const Target& reference, Result& result) noexcept {
    result.sigma = least_singular_value_bound(kinematics.J);
    result.error = Space::template difference<Scalar>(reference.x, kinematics.tip);
  }

  /// By how much the error is longer than pull.
  [[nodiscard]] Twist excess(const Twist& error) const noexcept {
    const Scalar length = error.norm();
    return length > options_.pull ? Twist((Scalar(1) - options_.pull / length) * error) : Twist(Twist::Zero());
  }

  [[nodiscard]] Target corrected(Target reference, const Twist& excess) const noexcept {
    if (excess != Twist::Zero()) reference.x = Space::template displace<Scalar>(reference.x, -excess);
    if (options_.integral_gain == Scalar(0)) return reference;
    if constexpr (Loop::kSecondOrder) {
      reference.xdd += options_.integral_gain * integral_;
    } else {
      reference.xd += options_.integral_gain * integral_;
    }
    return reference;
  }

  void integrate(const Result& result) noexcept {
    if (options_.integral_gain == Scalar(0) || result.status != Status::kOk || stopping_) return;
    integral_ += options_.dt * result.error;
    const Scalar size = options_.integral_gain * integral_.norm();
    if (size > options_.integral_bound) integral_ *= options_.integral_bound / size;
  }

  static constexpr Scalar kLittle = Scalar(0.1);       ///< Scale below which the arm yields.
  static constexpr Scalar kYieldRadius = Scalar(0.1);  ///< Its damping, as a share of ‖J‖_F,
  static constexpr Scalar kYieldDamping = Scalar(10);  ///< and that of the directions lost [1/s].

  Arm arm_;
  Scheme scheme_;
  Options options_;
  Limits<kLevel, N, Scalar> limits_;
  JointState state_;
  Row scale_;  ///< What counts as one unit of each joint's motion in the null space.
  bool stopping_ = false;
  Twist integral_ = Twist::Zero();
};

}  // namespace fpbm
