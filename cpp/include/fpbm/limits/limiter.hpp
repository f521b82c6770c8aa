#pragma once

#include "fpbm/limits/box_least_squares.hpp"
#include "fpbm/limits/braking.hpp"
#include "fpbm/limits/limits.hpp"
#include "fpbm/limits/saturation.hpp"

namespace fpbm {

/// Makes any scheme keep the joint limits: takes the scheme's answer, returns a motion within the limits.
///
/// A motion within the box of Limits passes unchanged. Otherwise it is saturated in the null space, so that other
/// joints take over; where they cannot, the task is scaled down along its direction. Where the scale comes near zero
/// (at the edge of the reach, say) the arm would stand still for good; so the smaller the scale, the more the motion
/// yields to the one that still brings the tip nearer.
///
/// With bounds on jerk this is done twice: first without regard to the last tick, to find where the motion is to go;
/// then, from the last tick's acceleration toward that, as far along the task's line as the jerks allow.
template <Level kLevel, int N, typename Scalar = double>
class Limiter {
 public:
  using JointVector = Vector<N, Scalar>;
  using JointState = State<N, Scalar>;

  explicit Limiter(const Limits<kLevel, N, Scalar>& limits) : limits_(limits), unit_(limits.bounds().acceleration) {
    for (Eigen::Index i = 0; i < unit_.size(); ++i) {
      if (!std::isfinite(unit_(i))) unit_(i) = Scalar(1);
    }
  }

  [[nodiscard]] const Limits<kLevel, N, Scalar>& limits() const noexcept { return limits_; }

  /// The motion within the limits for a desired qdd, or qd at velocity level, where the state's qd is the last command.
  /// last: acceleration of the last tick, which bounds on jerk start from.
  template <int M>
  [[nodiscard]] Saturated<N, Scalar> motion(const Matrix<M, N, Scalar>& J, const JointState& state,
                                            const JointVector& last, const JointVector& desired) const noexcept {
    const Box<N, Scalar> box = limits_.box(state, last);
    if (box.contains(desired)) return {desired, Scalar(1), 0, 0};
    NullSpaceSaturation<M, N, Scalar> saturation(J, unit_);
    if (!limits_.bounds_jerk()) return within(saturation, J, state, box, desired);
    const Saturated<N, Scalar> found = within(saturation, J, state, limits_.box_in_time(state), desired);
    return toward(saturation, box, box.nearest(motions(state.qd, last)), approach(state.qd, found.u), found);
  }

  /// The motion for an arm whose last acceleration does not matter: without bounds on jerk, or at rest.
  template <int M>
  [[nodiscard]] Saturated<N, Scalar> motion(const Matrix<M, N, Scalar>& J, const JointState& state,
                                            const JointVector& desired) const noexcept {
    return motion(J, state, JointVector::Zero(state.q.size()), desired);
  }

  /// The motion that brings the arm to rest.
  [[nodiscard]] Saturated<N, Scalar> brake(const JointState& state, const JointVector& last) const noexcept {
    return {fpbm::brake(limits_, state, last), Scalar(0), 0, 0};
  }

 private:
  /// The motion within a box that does as much as possible of a desired one.
  template <int M>
  [[nodiscard]] Saturated<N, Scalar> within(NullSpaceSaturation<M, N, Scalar>& saturation,
                                            const Matrix<M, N, Scalar>& J, const JointState& state,
                                            const Box<N, Scalar>& box, const JointVector& desired) const noexcept {
    if (box.contains(desired)) return {desired, Scalar(1), 0, 0};
    const JointVector rest = brake_in_proportion(limits_, state, box);
    auto found = saturation(box, rest, desired);
    if (found.scale < Scalar(1)) yield(J, state, box, desired, found);
    if (!found.u.allFinite()) found = {rest, Scalar(0), found.joints, found.passes};
    return found;
  }

  /// From the motion of a tick without jerk as far toward a goal as a box allows. found: what the goal does of the
  /// task.
  template <int M>
  [[nodiscard]] Saturated<N, Scalar> toward(NullSpaceSaturation<M, N, Scalar>& saturation, const Box<N, Scalar>& box,
                                            const JointVector& steady, const JointVector& goal,
                                            const Saturated<N, Scalar>& found) const noexcept {
    if (box.contains(goal)) return {goal, found.scale, found.joints, found.passes};
    Saturated<N, Scalar> next = saturation(box, steady, goal);
    if (!next.u.allFinite()) return {steady, Scalar(0), next.joints, next.passes};
    next.scale *= found.scale;
    return next;
  }

  /// The motions of a tick of some accelerations.
  [[nodiscard]] JointVector motions(const JointVector& qd, const JointVector& accelerations) const noexcept {
    if constexpr (kLevel == Level::kVelocity) return qd + limits_.tick() * accelerations;
    return accelerations;
  }

  /// At velocity level, the share of a change of velocities that leaves time to let the accelerations go before its
  /// end: the same for all joints, so that the change keeps its direction.
  [[nodiscard]] JointVector approach(const JointVector& qd, const JointVector& goal) const noexcept {
    if constexpr (kLevel == Level::kAcceleration) return goal;
    Scalar share(1);
    for (Eigen::Index i = 0; i < goal.size(); ++i) {
      if (!limits_.bounds_jerk(i)) continue;
      const Scalar change = std::abs(goal(i) - qd(i));
      const Scalar most = limits_.tick() * limits_.jerk_limited(i).change(change);
      if (share * change > most) share = most / change;
    }
    return qd + share * (goal - qd);
  }

  /// Blends found with box_least_squares(): found + (1 − (s/s₀)²)² (yielded − found), where s is the scale and s₀ =
  /// kLittle the scale below which the arm yields. At velocity level s is the share of the task's velocity that is
  /// left.
  template <int M>
  void yield(const Matrix<M, N, Scalar>& J, const JointState& state, const Box<N, Scalar>& box,
             const JointVector& desired, Saturated<N, Scalar>& found) const noexcept {
    const Vector<M, Scalar> task = J.lazyProduct(desired);
    Scalar scale = found.scale;
    if constexpr (kLevel == Level::kVelocity) scale = J.lazyProduct(found.u).dot(task) / task.squaredNorm();
    const Scalar left = scale > Scalar(0) ? scale / kLittle : Scalar(0);
    if (!(left < Scalar(1))) return;
    const Scalar yields = Scalar(1) - left * left;
    const Scalar mu = kRadius * kRadius * J.squaredNorm();
    JointVector rest = JointVector::Zero(state.q.size());
    if constexpr (kLevel == Level::kAcceleration) rest = -kDamping * state.qd;
    const JointVector yielded = box_least_squares<M, N, Scalar>(J, task, mu, rest, box);
    found.u = box.nearest(found.u + yields * yields * (yielded - found.u));  // Round-off may leave the box.
  }

  static constexpr Scalar kLittle = Scalar(0.1);  ///< s₀, the scale below which the arm yields.
  static constexpr Scalar kRadius = Scalar(0.1);  ///< Damping of the least squares, as a share of ‖J‖_F.
  static constexpr Scalar kDamping = Scalar(10);  ///< Damping of what the least squares leave free [1/s].

  Limits<kLevel, N, Scalar> limits_;
  JointVector unit_;  ///< Unit of each joint's motion in the null space.
};

}  // namespace fpbm
