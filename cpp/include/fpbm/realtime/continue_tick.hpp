#pragma once

#include <cmath>
#include <cstddef>
#include <tuple>

#include "fpbm/core/level.hpp"
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

/// Prepares the middle of a tick that continues the acceleration of the previous tick (docs/equations.md, A tick). The
/// acceleration of the reference changes, so that the law of a scheme with the gains k₁ and k₂,
///
///   J qdd = xdd − J̇ qd + k₁ (xd − J qd) + k₂ (x ⊖ f(q)),
///
/// becomes the law of TickFeedback for the rows J + h'J̇. The term h'J̇ qdd has the acceleration a' + δ' that the last
/// two ticks predict, so that the null space is that of J. kinematics: in the middle. reference: in the middle. h:
/// length of the tick [s]. change: e' − e, the change of the error since the start of the tick. before.qd: in the
/// middle.
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
    return feedback.previous_weight * before.qd.coeff(i) -
           (feedback.lead + feedback.correction) * before.change.coeff(i);
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
}

/// For a stack: each task has its gains.
template <typename... Levels, int N, typename Scalar>
void continue_tick(Kinematics<StackSpace<Levels...>, N, Scalar>& kinematics, Reference<StackSpace<Levels...>, Scalar>&,
                   const TaskGains<Scalar>&, const Scalar& h,
                   const Vector<StackSpace<Levels...>::kRows, Scalar>& change,
                   const TickBefore<N, Scalar>& before) noexcept {
  kinematics.continue_tick(h, change, before);
}

/// Prepares the middle of a tick at velocity level that continues the velocity u' of the previous tick. The velocity of
/// the reference changes, so that the law of a scheme with the gain k, J u = xd + k (x ⊖ f(q)), becomes
///
///   (J + hJ̇/2) u = xd + (1 − e^(−kh))/h e + J u' + hJ̇u'/4 − 2(x' − x₀)/h.
///
/// The error then decays by e^(−kh) in each tick (docs/equations.md, A tick). The term hJ̇u/2 has the velocity
/// u' + h q̈' that the last two ticks predict. start_error: e, at the start of the tick. moved: x' − x₀, displacement of
/// the tip to the middle. before.qd: u'. before.qdd: q̈'. In float, 2(x' − x₀)/h is mostly round-off error. Therefore,
/// J u' − hJ̇u'/2 is used instead.
template <typename Space, int N, typename Scalar>
void continue_tick_of_velocity(Kinematics<Space, N, Scalar>& kinematics, Reference<Space, Scalar>& reference,
                               const TaskGains<Scalar>& gains, const Scalar& h,
                               const Vector<Space::kRows, Scalar>& start_error,
                               const Vector<Space::kRows, Scalar>& moved,
                               const TickBefore<N, Scalar>& before) noexcept {
  using Twist = Vector<Space::kRows, Scalar>;
  constexpr bool kByPositions = TickFeedback<Scalar>::kByPositions;
  const Scalar rate = mean_decay(gains.k2, h);
  const Twist error = Space::template difference<Scalar>(reference.x, kinematics.tip);
  const Vector<N, Scalar> of_rates = entrywise(before.qd, [&](Eigen::Index i) {
    return (kByPositions ? h / Scalar(-4) : Scalar(0)) * before.qd.coeff(i) - h * h / Scalar(2) * before.qdd.coeff(i);
  });
  const Twist rates = product(kinematics.Jd, of_rates);
  const Twist rows = product(kinematics.J, before.qd);
  reference.xd = entrywise(error, [&](Eigen::Index i) {
    const Scalar deviation = kByPositions ? rows.coeff(i) - Scalar(2) / h * moved.coeff(i) : Scalar(0);
    return reference.xd.coeff(i) + rate * start_error.coeff(i) + deviation + rates.coeff(i) - gains.k2 * error.coeff(i);
  });
}

/// J ← J + h'J̇, the rows with which limits keep the task: of the whole tick.
template <Level kLevel, typename Space, int N, typename Scalar>
void add_lead(Kinematics<Space, N, Scalar>& kinematics, const TaskGains<Scalar>& gains, const Scalar& h) noexcept {
  const Scalar lead =
      kLevel == Level::kAcceleration ? TickFeedback<Scalar>(gains.k1, gains.k2, h).lead : Scalar(h / Scalar(2));
  for (Eigen::Index j = 0; j < kinematics.J.cols(); ++j) {
    for (Eigen::Index i = 0; i < kinematics.J.rows(); ++i) {
      kinematics.J.coeffRef(i, j) += lead * kinematics.Jd.coeff(i, j);
    }
  }
}

/// For a stack: continue_tick() adds the lead, so that lower levels do not disturb higher levels.
template <Level kLevel, typename... Levels, int N, typename Scalar>
void add_lead(Kinematics<StackSpace<Levels...>, N, Scalar>&, const TaskGains<Scalar>&, const Scalar&) noexcept {}

/// For a stack: each task has its gain.
template <typename... Levels, int N, typename Scalar>
void continue_tick_of_velocity(Kinematics<StackSpace<Levels...>, N, Scalar>& kinematics,
                               Reference<StackSpace<Levels...>, Scalar>& reference, const TaskGains<Scalar>&,
                               const Scalar& h, const Vector<StackSpace<Levels...>::kRows, Scalar>& start_error,
                               const Vector<StackSpace<Levels...>::kRows, Scalar>& moved,
                               const TickBefore<N, Scalar>& before) noexcept {
  StackSpace<Levels...>::each([&](auto space, auto i, int row) noexcept {
    using Part = decltype(space);
    auto& gain = std::get<decltype(i)::value>(kinematics.tasks).feedback.position_gain;
    const Scalar rate = mean_decay(gain, h);
    gain = Scalar(0);
    for (int j = row; j < row + Part::kRows; ++j) {
      reference.xd.coeffRef(j) += rate * start_error.coeff(j);
      if (TickFeedback<Scalar>::kByPositions) reference.xd.coeffRef(j) -= Scalar(2) / h * moved.coeff(j);
    }
  });
  kinematics.tick = h;
  std::apply([&](auto&... level) { (level.continue_velocity(h, before.qd), ...); }, kinematics.levels);
}

}  // namespace fpbm
