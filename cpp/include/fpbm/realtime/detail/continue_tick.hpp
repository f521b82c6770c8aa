#pragma once

#include <cmath>
#include <cstddef>
#include <tuple>

#include "fpbm/core/detail/mask.hpp"
#include "fpbm/linalg/detail/entrywise.hpp"
#include "fpbm/linalg/detail/product.hpp"
#include "fpbm/model/kinematics.hpp"
#include "fpbm/path/reference.hpp"
#include "fpbm/task/detail/stack_kinematics.hpp"
#include "fpbm/task/detail/task_gains.hpp"
#include "fpbm/task/detail/task_rows.hpp"
#include "fpbm/task/detail/tick_feedback.hpp"

namespace fpbm {

/// (1 − e^(−kh))/h: the mean decay in a tick of an error that decays with the gain k.
template <typename Scalar>
[[nodiscard]] Scalar mean_decay(const Scalar& k, const Scalar& h) noexcept {
  using std::expm1;
  if constexpr (kInLanes<Scalar>) {
    return Scalar([&](auto lane) { return -std::expm1(-k[lane] * h[lane]) / h[lane]; });
  } else {
    return -expm1(-k * h) / h;
  }
}

/// Prepares the middle of a tick that continues the acceleration of the previous tick (docs/tick.md, A tick,
/// Acceleration level): J ← J + h'J̇, and the acceleration of the reference changes, so that the law of a scheme with
/// the gains k₁ and k₂,
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
    return (Scalar(1) - feedback.previous_weight) * reference.xdd.coeff(i) +
           feedback.velocity_gain * error_rate.coeff(i) - gains.k1 * reference.xd.coeff(i) +
           (feedback.position_gain - gains.k2) * error.coeff(i) + rows.coeff(i) + rates.coeff(i);
  });
  kinematics.lead = feedback.lead;
  add_lead(kinematics.J, kinematics.lead, kinematics.Jd);
}

/// For a stack: each task has its gains.
template <typename... Levels, int N, typename Scalar>
void continue_tick(Kinematics<StackSpace<Levels...>, N, Scalar>& kinematics, Reference<StackSpace<Levels...>, Scalar>&,
                   const TaskGains<Scalar>&, const Scalar& h,
                   const Vector<StackSpace<Levels...>::kRows, Scalar>& change,
                   const TickBefore<N, Scalar>& before) noexcept {
  kinematics.continue_tick(h, change, before);
}

/// Prepares the middle of a tick at velocity level that continues the velocity u' of the previous tick: J ← J + hJ̇/2,
/// and the velocity of the reference changes, so that the law of a scheme with the gain k, J u = xd + k (x ⊖ f(q)),
/// becomes
///
///   (J + hJ̇/2) u = xd + (1 − e^(−kh))/h e + J u' + hJ̇u'/4 − 2(x' − x₀)/h.
///
/// The error then decays by e^(−kh) in each tick, up to terms of h⁴ (docs/tick.md, A tick, Velocity level).
/// error: e at the start of the tick. moved: x' − x₀, displacement of the tip to the middle. In float, 2(x' − x₀)/h is
/// mostly round-off error. Therefore, J u' − hJ̇u'/4 is used instead.
template <typename Space, int N, typename Scalar>
void continue_tick_of_velocity(Kinematics<Space, N, Scalar>& kinematics, Reference<Space, Scalar>& reference,
                               const TaskGains<Scalar>& gains, const Scalar& h,
                               const Vector<Space::kRows, Scalar>& start_error,
                               const Vector<Space::kRows, Scalar>& moved, const Vector<N, Scalar>& u) noexcept {
  using Twist = Vector<Space::kRows, Scalar>;
  constexpr bool kByPositions = TickFeedback<Scalar>::kByPositions;
  const Scalar rate = mean_decay(gains.k2, h);
  const Twist error = Space::template difference<Scalar>(reference.x, kinematics.tip);
  const Twist rates = product(kinematics.Jd, u);
  const Twist rows = product(kinematics.J, u);
  reference.xd = entrywise(error, [&](Eigen::Index i) {
    const Scalar offset = kByPositions ? rows.coeff(i) + h / Scalar(4) * rates.coeff(i) - Scalar(2) / h * moved.coeff(i)
                                       : h / Scalar(2) * rates.coeff(i);
    return reference.xd.coeff(i) + rate * start_error.coeff(i) + offset - gains.k2 * error.coeff(i);
  });
  kinematics.lead = h / Scalar(2);
  add_lead(kinematics.J, kinematics.lead, kinematics.Jd);
}

/// For a stack: each task has its gain.
template <typename... Levels, int N, typename Scalar>
void continue_tick_of_velocity(Kinematics<StackSpace<Levels...>, N, Scalar>& kinematics,
                               Reference<StackSpace<Levels...>, Scalar>& reference, const TaskGains<Scalar>&,
                               const Scalar& h, const Vector<StackSpace<Levels...>::kRows, Scalar>& start_error,
                               const Vector<StackSpace<Levels...>::kRows, Scalar>& moved,
                               const Vector<N, Scalar>& u) noexcept {
  StackSpace<Levels...>::each([&](auto space, auto i, int row) noexcept {
    using Part = decltype(space);
    auto& feedback = std::get<decltype(i)::value>(kinematics.tasks).feedback;
    const Scalar rate = mean_decay(feedback.position_gain, h);
    feedback.position_gain = Scalar(0);
    feedback.lead = h / Scalar(2);
    for (int j = row; j < row + Part::kRows; ++j) {
      reference.xd.coeffRef(j) += rate * start_error.coeff(j);
      if (TickFeedback<Scalar>::kByPositions) reference.xd.coeffRef(j) -= Scalar(2) / h * moved.coeff(j);
    }
  });
  kinematics.tick = h;
  std::apply([&](auto&... level) { (level.continue_velocity(h, u), ...); }, kinematics.levels);
}

}  // namespace fpbm
