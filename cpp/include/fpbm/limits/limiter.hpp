#pragma once

#include "fpbm/limits/box_least_squares.hpp"
#include "fpbm/limits/limits.hpp"
#include "fpbm/limits/saturation.hpp"

namespace fpbm {

/// Makes any scheme keep the joint limits: takes the scheme's answer, returns a motion within the limits.
///
/// A motion within the box of Limits passes unchanged. Otherwise it is saturated in the null space, so that other
/// joints take over; where they cannot, the task is scaled down along its direction. Where the scale comes near zero
/// (at the edge of the reach, say) the arm would stand still for good; so the smaller the scale, the more the motion
/// yields to the one that still brings the tip nearer.
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
  template <int M>
  [[nodiscard]] Saturated<N, Scalar> motion(const Matrix<M, N, Scalar>& J, const JointState& state,
                                            const JointVector& desired) const noexcept {
    const Box<N, Scalar> box = limits_.box(state);
    if (box.contains(desired)) return {desired, Scalar(1), 0, 0};
    const JointVector rest = limits_.brake(state, box);
    auto found = NullSpaceSaturation<M, N, Scalar>(J, unit_)(box, rest, desired);
    if (found.scale < Scalar(1)) yield(J, state, box, desired, found);
    if (!found.u.allFinite()) found = {rest, Scalar(0), found.joints, found.passes};
    return found;
  }

  /// The motion that brings the arm to rest.
  [[nodiscard]] Saturated<N, Scalar> brake(const JointState& state) const noexcept {
    return {limits_.brake(state, limits_.box(state)), Scalar(0), 0, 0};
  }

 private:
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
