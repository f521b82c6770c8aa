#pragma once

#include <cmath>
#include <limits>

#include "fpbm/core/level.hpp"
#include "fpbm/core/mask.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/model/kinematics.hpp"
#include "fpbm/task/reference.hpp"

namespace fpbm {

/// Watches an error from sample to sample for the step in which it grows by more than its rate explains.
///
/// From one sample to the next an error e grows by h ė at most and, where the step resolves the motion, by little more:
/// little against the way that the reference went and against the error itself, and by what a fourth-order step
/// truncates. When the arm steps over a singular posture, or the target is out of reach, it grows by as much as the
/// reference went.
template <int M, typename Scalar = double>
class ErrorWatch {
 public:
  using TaskVector = Vector<M, Scalar>;

  /// Whether e came here by its rate of h seconds ago. travel is the way of the reference in between, turn the
  /// largest step of a joint [rad], size the largest value that a joint adds to what e is a difference of, and all but
  /// turn and h [s] are in e's units.
  [[nodiscard]] Mask<Scalar> follows(const TaskVector& error, const TaskVector& rate, Scalar h, Scalar travel,
                                     Scalar turn, Scalar size) const noexcept {
    using std::sqrt;
    if (!started_) return Mask<Scalar>(true);
    const Scalar growth = error.norm() - error_.norm() - h * rate_.norm();
    const Scalar expected = Scalar(kTolerance) * (travel + error.norm() + h * rate.norm());
    const Scalar truncation = Scalar(kTruncation) * turn * (turn * turn) * (turn * turn) * size;
    const Scalar round_off = Scalar(sqrt(std::numeric_limits<Number<Scalar>>::epsilon())) * size;
    return growth <= expected + truncation + round_off;
  }

  /// From here on: e and its rate, where the reference may have stepped since follows() was asked.
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

/// Watches a rollout for the step in which the tip leaves its reference, by its position and, where the scheme is one
/// of acceleration, its velocity.
template <typename Space, int N, typename Scalar = double>
class TaskWatch {
 public:
  explicit TaskWatch(const typename Space::template Point<Scalar>& tip)
      : before_(Reference<Space, Scalar>::hold(tip)) {}

  /// Whether this sample, h seconds after the last, is where the scheme of that level was to bring the arm: arrived is
  /// what it was led to, and reference, of which qdd is the answer, where it is led from here. They differ where a
  /// path's pieces meet. Where the scheme was damped, the reference must not outrun the tip by more than one step.
  template <Level kLevel>
  [[nodiscard]] Mask<Scalar> on_course(const Kinematics<Space, N, Scalar>& kinematics,
                                       const Reference<Space, Scalar>& arrived,
                                       const Reference<Space, Scalar>& reference, const State<N, Scalar>& state,
                                       [[maybe_unused]] const Vector<N, Scalar>& qdd, Scalar h, bool damped) noexcept {
    using TaskVector = Vector<Space::kRows, Scalar>;
    const auto& [tip, J, Jd] = kinematics;
    const Scalar turn = h * state.qd.cwiseAbs().maxCoeff();
    const Scalar reach = J.cwiseAbs().maxCoeff();
    const TaskVector velocity = J.lazyProduct(state.qd);
    const TaskVector e = Space::template difference<Scalar>(arrived.x, tip);
    const TaskVector ed = reference.xd - velocity;
    const Scalar travel = Space::template difference<Scalar>(arrived.x, before_.x).norm();
    Mask<Scalar> follows = turn <= Scalar(kLargestTurn) && position_.follows(e, ed, h, travel, turn, reach);
    if (damped) {
      follows = follows && e.norm() <= undamped_error_ + Scalar(kDampedSteps) * travel;
    } else {
      undamped_error_ = e.norm();
    }
    position_.start_from(e, ed);
    if constexpr (kLevel == Level::kAcceleration) {
      const TaskVector edd = reference.xdd - J.lazyProduct(qdd) - Jd.lazyProduct(state.qd);
      const Scalar change = (arrived.xd - before_.xd).norm();
      follows = follows && velocity_.follows(arrived.xd - velocity, edd, h, change, turn, reach / h);
      velocity_.start_from(ed, edd);
    }
    before_ = reference;
    return follows;
  }

 private:
  /// How far a joint may move in one step at most, for the step to resolve the motion [rad], or [m] for a prismatic
  /// one.
  static constexpr auto kLargestTurn = static_cast<Number<Scalar>>(0.25);

  /// How far the tip may fall behind where the scheme is damped, in steps of the reference.
  static constexpr auto kDampedSteps = static_cast<Number<Scalar>>(1.1);

  Scalar undamped_error_{0};
  ErrorWatch<Space::kRows, Scalar> position_;
  ErrorWatch<Space::kRows, Scalar> velocity_;
  Reference<Space, Scalar> before_;
};

}  // namespace fpbm
