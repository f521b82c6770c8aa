#pragma once

#include "fpbm/core/mask.hpp"
#include "fpbm/linalg/entrywise.hpp"
#include "fpbm/linalg/product.hpp"
#include "fpbm/model/kinematics.hpp"
#include "fpbm/task/reference.hpp"
#include "fpbm/task/stack_kinematics.hpp"
#include "fpbm/task/task_gains.hpp"
#include "fpbm/task/task_rows.hpp"
#include "fpbm/task/tick_feedback.hpp"

namespace fpbm {

/// Prepares the middle of a tick that continues the acceleration of the previous tick (docs/equations.md, A tick with
/// one acceleration): J ← J + h'J̇, and the acceleration of the reference changes, so that the law of a scheme with the
/// gains k₁ and k₂,
///
///   J qdd = xdd − J̇ qd + k₁ (xd − J qd) + k₂ (x ⊖ f(q)),
///
/// becomes the law of TickFeedback. kinematics: in the middle. reference: in the middle. h: length of the tick [s].
/// change: e' − e, the change of the error since the start of the tick. before.qd: in the middle.
template <typename Space, int N, typename Scalar>
void continue_tick(Kinematics<Space, N, Scalar>& kinematics, Reference<Space, Scalar>& reference,
                   const TaskGains<Scalar>& gains, const Scalar& h, const Vector<Space::kRows, Scalar>& change,
                   const TickBefore<N, Scalar>& before) noexcept {
  using Twist = Vector<Space::kRows, Scalar>;
  const TickFeedback<Scalar> feedback(gains.k1, gains.k2, h);
  const Twist error = Space::template difference<Scalar>(reference.x, kinematics.tip);
  const Vector<N, Scalar> of_rows = entrywise(before.qd, [&](Eigen::Index i) {
    return feedback.previous_weight * before.qdd.coeff(i) + gains.k1 * before.qd.coeff(i);
  });
  const Vector<N, Scalar> of_rates = entrywise(before.qd, [&](Eigen::Index i) {
    return (feedback.previous_weight + gains.k1 * feedback.lead) * before.qd.coeff(i) +
           feedback.lead * before.qdd.coeff(i) - feedback.correction * before.change.coeff(i);
  });
  const Twist rows = product(kinematics.J, of_rows);
  const Twist rates = product(kinematics.Jd, of_rates);
  const Twist error_rate = [&]() -> Twist {
    if constexpr (TickFeedback<Scalar>::kByPositions) {
      return entrywise(change, [&](Eigen::Index i) { return Scalar(2) / h * change.coeff(i); });
    } else {
      const Twist xd = product(kinematics.J, before.qd);
      return entrywise(xd, [&](Eigen::Index i) { return reference.xd.coeff(i) - xd.coeff(i); });
    }
  }();
  reference.xdd = entrywise(error, [&](Eigen::Index i) {
    return (Scalar(1) - feedback.previous_weight) * reference.xdd.coeff(i) + feedback.velocity_gain * error_rate.coeff(i) -
           gains.k1 * reference.xd.coeff(i) + (feedback.position_gain - gains.k2) * error.coeff(i) + rows.coeff(i) +
           rates.coeff(i);
  });
  for (Eigen::Index j = 0; j < kinematics.J.cols(); ++j) {
    for (Eigen::Index i = 0; i < kinematics.J.rows(); ++i) {
      kinematics.J.coeffRef(i, j) += feedback.lead * kinematics.Jd.coeff(i, j);
    }
  }
}

/// For a stack: each task has its gains.
template <typename... Levels, int N, typename Scalar>
void continue_tick(Kinematics<StackSpace<Levels...>, N, Scalar>& kinematics, const Reference<StackSpace<Levels...>, Scalar>&,
                   const TaskGains<Scalar>&, const Scalar& h, const Vector<StackSpace<Levels...>::kRows, Scalar>& change,
                   const TickBefore<N, Scalar>& before) noexcept {
  kinematics.continue_tick(h, change, before);
}

}  // namespace fpbm
