#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "fpbm/core/detail/mask.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/model/kinematics.hpp"
#include "fpbm/path/reference.hpp"
#include "fpbm/simulate/detail/first_level.hpp"

namespace fpbm {

/// Detects a step in which an error grows by more than its rate predicts.
///
/// From one sample to the next, an error e grows by about h ė. If the step resolves the motion, the additional growth
/// is small compared with the displacement of the reference and with the error, and of the order of the truncation
/// error of a fourth-order method. If the arm steps over a singular posture, or the target is unreachable, the error
/// grows by the displacement of the reference.
template <int M, typename Scalar = double>
class ErrorWatch {
 public:
  using TaskVector = Vector<M, Scalar>;

  /// Growth of |e| since the last sample, minus h |ė| at the last sample. 0 for the first sample.
  [[nodiscard]] Scalar growth(const TaskVector& error, Scalar h) const noexcept {
    return started_ ? Scalar(error.norm() - error_.norm() - h * rate_.norm()) : Scalar(0);
  }

  /// Whether a growth of e is small enough. travel: displacement of the reference since the last sample. step: largest
  /// step of a joint [rad]. size: largest contribution of a joint to the two quantities whose difference is e. travel
  /// and size are in the units of e.
  [[nodiscard]] Mask<Scalar> follows(Scalar growth, const TaskVector& error, const TaskVector& rate, Scalar h,
                                     Scalar travel, Scalar step, Scalar size) const noexcept {
    using std::sqrt;
    if (!started_) return Mask<Scalar>(true);
    const Scalar expected = Scalar(kTolerance) * (travel + error.norm() + h * rate.norm());
    const Scalar truncation = Scalar(kTruncation) * step * (step * step) * (step * step) * size;
    const Scalar round_off = Scalar(sqrt(std::numeric_limits<Number<Scalar>>::epsilon())) * size;
    return growth <= expected + truncation + round_off;
  }

  /// Sets e and its rate for the next step. The reference may be discontinuous between follows() and start_from().
  void start_from(const TaskVector& error, const TaskVector& rate) noexcept {
    error_ = error;
    rate_ = rate;
    started_ = true;
  }

 private:
  /// Largest growth of the error while the tip follows its reference, as a fraction of the displacement of the
  /// reference and of the error. If the target is unreachable, the fraction is 1. `fpbm_tests
  /// --gtest_filter='*Failure*:StepLength*'` passes with 0.01 to 0.1, and fails with 0.3.
  static constexpr auto kTolerance = static_cast<Number<Scalar>>(0.1);
  /// Six times the truncation error θ⁵/120 of RK4 for a rotation by θ. `*Failure*:StepLength*` passes with 0 to 0.1,
  /// and fails with 1.
  static constexpr auto kTruncation = static_cast<Number<Scalar>>(0.05);

  bool started_ = false;
  TaskVector error_ = filled<TaskVector>(M == Eigen::Dynamic ? 0 : M);
  TaskVector rate_ = error_;
};

/// Detects the step of a rollout in which the tip leaves its reference, in position and, at acceleration level, in
/// velocity. Also estimates whether the discretisation error of the tip is significant (accurate()).
///
/// The estimate needs no additional evaluations. made_ is the sum of the positive growth() of the tip error over all
/// steps. At acceleration level, made_ also contains the integral of made_rate_, the same sum for the velocity error.
/// Without feedback, made_ is an upper bound on the discretisation error. With feedback, the tip error is another upper
/// bound. The smaller bound is used. If a wrong start velocity causes a larger error, a discretisation error may be
/// missed.
template <typename Space, int N, typename Scalar = double>
class TaskWatch {
  static constexpr int kRows = kRowsOfFirst<Space, N, Scalar>;
  using TaskVector = Vector<kRows, Scalar>;

 public:
  explicit TaskWatch(const typename Space::template Point<Scalar>& tip)
      : before_(Reference<Space, Scalar>::hold(tip)) {}

  /// Whether the tip followed the reference in the step of h seconds to this sample. arrived: the reference at the end
  /// of the step. reference: the reference at the start of the next step, for which qdd was computed. The two
  /// references differ at the boundary between two pieces of a path. If the scheme was damped, the tip error may exceed
  /// the last error without damping by at most kDampedSteps steps of the reference.
  template <Level kLevel>
  [[nodiscard]] Mask<Scalar> follows_reference(const Kinematics<Space, N, Scalar>& kinematics,
                                               const Reference<Space, Scalar>& arrived,
                                               const Reference<Space, Scalar>& reference, const State<N, Scalar>& state,
                                               [[maybe_unused]] const Vector<N, Scalar>& qdd, Scalar h,
                                               bool damped) noexcept {
    using std::max;
    using std::min;
    const auto& J = first_rows(kinematics);
    const auto rows = [&](const Vector<Space::kRows, Scalar>& twist) -> TaskVector {
      return twist_of_first(kinematics, twist);
    };
    const Scalar step = h * state.qd.cwiseAbs().maxCoeff();
    const Scalar largest_entry = J.cwiseAbs().maxCoeff();
    const TaskVector velocity = J.lazyProduct(state.qd);
    const Vector<Space::kRows, Scalar> error = Space::template difference<Scalar>(arrived.x, kinematics.tip);
    const TaskVector e = rows(error);
    const TaskVector ed = rows(reference.xd) - velocity;
    const Scalar travel = rows(Space::template difference<Scalar>(arrived.x, before_.x)).norm();
    const Scalar growth = position_.growth(e, h) - error_selection_.of_error(kinematics, error);
    Mask<Scalar> follows =
        step <= Scalar(kLargestStep) && position_.follows(growth, e, ed, h, travel, step, largest_entry);
    if (damped) {
      follows = follows && e.norm() <= undamped_error_ + Scalar(kDampedSteps) * travel;
    } else {
      undamped_error_ = e.norm();
      made_ += max(growth, Scalar(0));
    }
    position_.start_from(e, ed);
    if constexpr (kLevel == Level::kAcceleration) {
      const TaskVector edd = rows(reference.xdd) - J.lazyProduct(qdd) - first_rates(kinematics).lazyProduct(state.qd);
      const Scalar change = rows(arrived.xd - before_.xd).norm();
      const TaskVector ed_before = rows(arrived.xd) - velocity;
      const Scalar faster = velocity_.growth(ed_before, h) - rate_selection_.of_rate(kinematics, arrived.xd);
      follows = follows && velocity_.follows(faster, ed_before, edd, h, change, step, largest_entry / h);
      if (!damped) {
        made_ += h * made_rate_;
        made_rate_ += max(faster, Scalar(0));
      }
      velocity_.start_from(ed, edd);
    }
    before_ = reference;
    accurate_ = min(e.norm(), made_) <= Scalar(kAccuracy) * largest_entry;
    return follows;
  }

  /// Whether the discretisation error at the last sample is not significant. Errors due to damping do not count.
  [[nodiscard]] const Mask<Scalar>& accurate() const noexcept { return accurate_; }

 private:
  /// Largest step of a joint that resolves the motion [rad], or [m] for a prismatic joint. The truncation error of this
  /// step in ErrorWatch is 4.9e-5 of the lever arm, half of kAccuracy.
  static constexpr auto kLargestStep = static_cast<Number<Scalar>>(0.25);

  /// Largest lag of a damped tip, in steps of the reference: 1 for a tip that stops, and the tolerance of ErrorWatch.
  static constexpr auto kDampedSteps = static_cast<Number<Scalar>>(1.1);

  /// Smallest significant tip error, relative to the largest lever arm of a joint: 0.1 mm for a lever arm of 1 m.
  /// kAccuracy defines the status kCoarse (rollout()).
  static constexpr auto kAccuracy = static_cast<Number<Scalar>>(1e-4);

  Mask<Scalar> accurate_ = Mask<Scalar>(true);
  Scalar made_{0};       ///< Upper bound on the discretisation error.
  Scalar made_rate_{0};  ///< Upper bound on the discretisation error of the velocity.
  Scalar undamped_error_{0};
  SelectionGrowth<Space, N, Scalar> error_selection_;
  SelectionGrowth<Space, N, Scalar> rate_selection_;
  ErrorWatch<kRows, Scalar> position_;
  ErrorWatch<kRows, Scalar> velocity_;
  Reference<Space, Scalar> before_;
};

}  // namespace fpbm
