#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "fpbm/core/level.hpp"
#include "fpbm/core/mask.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/model/kinematics.hpp"
#include "fpbm/task/reference.hpp"

namespace fpbm {

/// Detects the step in which an error grows by more than its rate explains.
///
/// From one sample to the next an error e grows by about h ė. Where the step resolves the motion, the rest is small
/// compared with the reference's travel and with the error, and of the order of a fourth-order truncation. When the arm
/// steps over a singular posture, or the target is out of reach, the error grows by the reference's travel.
template <int M, typename Scalar = double>
class ErrorWatch {
 public:
  using TaskVector = Vector<M, Scalar>;

  /// By how much e is larger than its rate of h seconds ago explains; 0 at first.
  [[nodiscard]] Scalar growth(const TaskVector& error, Scalar h) const noexcept {
    return started_ ? Scalar(error.norm() - error_.norm() - h * rate_.norm()) : Scalar(0);
  }

  /// Whether a growth of e is small enough. travel: the reference's displacement since the last sample; step: the
  /// largest step of a joint [rad]; size: the largest contribution of a joint to the quantities whose difference e is.
  /// travel and size are in the units of e.
  [[nodiscard]] Mask<Scalar> follows(Scalar growth, const TaskVector& error, const TaskVector& rate, Scalar h,
                                     Scalar travel, Scalar step, Scalar size) const noexcept {
    using std::sqrt;
    if (!started_) return Mask<Scalar>(true);
    const Scalar expected = Scalar(kTolerance) * (travel + error.norm() + h * rate.norm());
    const Scalar truncation = Scalar(kTruncation) * step * (step * step) * (step * step) * size;
    const Scalar round_off = Scalar(sqrt(std::numeric_limits<Number<Scalar>>::epsilon())) * size;
    return growth <= expected + truncation + round_off;
  }

  /// Sets e and its rate for the next step; the reference may have jumped since follows().
  void start_from(const TaskVector& error, const TaskVector& rate) noexcept {
    error_ = error;
    rate_ = rate;
    started_ = true;
  }

 private:
  static constexpr auto kTolerance = static_cast<Number<Scalar>>(0.1);
  static constexpr auto kTruncation = static_cast<Number<Scalar>>(0.05);

  bool started_ = false;
  TaskVector error_ = TaskVector::Zero();
  TaskVector rate_ = TaskVector::Zero();
};

/// Detects the step of a rollout in which the tip leaves its reference, by position and, at acceleration level, by
/// velocity; and the sample from which on the tip error is more than the scheme explains.
///
/// The second is an estimate without any further evaluation. What all steps so far have added to the error beyond its
/// rate, and, at acceleration level, to its rate, which goes on since, bounds the error that they made where nothing
/// makes it smaller. Feedback does: so the error itself is a bound as well, and the lesser of both is judged. Where a
/// wrong start velocity makes a larger error, that of the steps may be missed.
template <typename Space, int N, typename Scalar = double>
class TaskWatch {
 public:
  explicit TaskWatch(const typename Space::template Point<Scalar>& tip)
      : before_(Reference<Space, Scalar>::hold(tip)) {}

  /// Whether this sample, h seconds after the last, is where the scheme had to bring the arm. arrived: the reference
  /// that the step ended on; reference: the one that the next step starts from, which qdd answers. They differ where
  /// two pieces of a path meet. Where the scheme was damped, the reference must not outrun the tip by more than one
  /// step.
  template <Level kLevel>
  [[nodiscard]] Mask<Scalar> follows_reference(const Kinematics<Space, N, Scalar>& kinematics,
                                               const Reference<Space, Scalar>& arrived,
                                               const Reference<Space, Scalar>& reference, const State<N, Scalar>& state,
                                               [[maybe_unused]] const Vector<N, Scalar>& qdd, Scalar h,
                                               bool damped) noexcept {
    using std::max;
    using std::min;
    using TaskVector = Vector<Space::kRows, Scalar>;
    const auto& J = kinematics.J;
    const Scalar step = h * state.qd.cwiseAbs().maxCoeff();
    const Scalar reach = J.cwiseAbs().maxCoeff();
    const TaskVector velocity = J.lazyProduct(state.qd);
    const TaskVector e = Space::template difference<Scalar>(arrived.x, kinematics.tip);
    const TaskVector ed = reference.xd - velocity;
    const Scalar travel = Space::template difference<Scalar>(arrived.x, before_.x).norm();
    const Scalar growth = position_.growth(e, h);
    Mask<Scalar> follows = step <= Scalar(kLargestStep) && position_.follows(growth, e, ed, h, travel, step, reach);
    if (damped) {
      follows = follows && e.norm() <= undamped_error_ + Scalar(kDampedSteps) * travel;
    } else {
      undamped_error_ = e.norm();
      made_ += max(growth, Scalar(0));
    }
    position_.start_from(e, ed);
    if constexpr (kLevel == Level::kAcceleration) {
      const TaskVector edd = reference.xdd - J.lazyProduct(qdd) - kinematics.Jd.lazyProduct(state.qd);
      const Scalar change = (arrived.xd - before_.xd).norm();
      const TaskVector ed_before = arrived.xd - velocity;
      const Scalar faster = velocity_.growth(ed_before, h);
      follows = follows && velocity_.follows(faster, ed_before, edd, h, change, step, reach / h);
      if (!damped) {
        made_ += h * made_rate_;
        made_rate_ += max(faster, Scalar(0));
      }
      velocity_.start_from(ed, edd);
    }
    before_ = reference;
    accurate_ = min(e.norm(), made_) <= Scalar(kAccuracy) * reach;
    return follows;
  }

  /// Whether the steps have made less than an error that counts, at the last sample. Damping excuses an error.
  [[nodiscard]] const Mask<Scalar>& accurate() const noexcept { return accurate_; }

 private:
  /// Largest step of a joint that still resolves the motion [rad], or [m] for a prismatic joint.
  static constexpr auto kLargestStep = static_cast<Number<Scalar>>(0.25);

  /// Largest lag of the tip where the scheme is damped, in steps of the reference.
  static constexpr auto kDampedSteps = static_cast<Number<Scalar>>(1.1);

  /// Tip error that counts, in lever arms of the joints: 0.1 mm on an arm of 1 m.
  static constexpr auto kAccuracy = static_cast<Number<Scalar>>(1e-4);

  Mask<Scalar> accurate_ = Mask<Scalar>(true);
  Scalar made_{0};       ///< Error that the steps made, at most.
  Scalar made_rate_{0};  ///< Error of velocity that the steps made, at most.
  Scalar undamped_error_{0};
  ErrorWatch<Space::kRows, Scalar> position_;
  ErrorWatch<Space::kRows, Scalar> velocity_;
  Reference<Space, Scalar> before_;
};

}  // namespace fpbm
