#pragma once

#include "fpbm/bound/clearance.hpp"
#include "fpbm/limits/detail/rows.hpp"
#include "fpbm/limits/limits.hpp"

namespace fpbm {

/// Adds a row n·v ≤ most for each speed bound that the motion u would exceed.
///
/// v is the velocity of the body after the tick and after the acceleration is reduced to zero. The joint velocities are
/// then q̇ + acting_ticks h u, or q̇ + acting_ticks (u − q̇) at velocity level. n is the direction of v. The speed may
/// still exceed the bound because the direction changes within the tick, or if the other rows and the joint limits
/// admit no motion within the bound. placed: memory for the bodies in the middle of the tick.
template <Level kLevel, typename Clearance, int N, int P, typename Scalar>
void bound_speeds(const Clearance& clearance, typename Clearance::Placement& placed,
                  const Limits<kLevel, N, Scalar>& limits, const State<N, Scalar>& state, Scalar acting_ticks,
                  const Vector<N, Scalar>& u, Rows<N, P, Scalar>& rows) noexcept {
  if (clearance.speed_bounds().empty()) return;
  // The joint velocities after the tick are `constant` + g u.
  const Scalar h = limits.tick();
  const Scalar g = kLevel == Level::kAcceleration ? acting_ticks * h : acting_ticks;
  const Vector<N, Scalar> constant = kLevel == Level::kAcceleration ? state.qd : (Scalar(1) - acting_ticks) * state.qd;
  const Vector<N, Scalar> final = constant + g * u;
  clearance.place(state.q + h / Scalar(2) * (state.qd + final), placed);
  for (std::size_t i = 0; i < placed.speed_points.size(); ++i) {
    const auto& bound = clearance.speed_bounds()[i];
    const auto gradient = [&](const Vector<3, Scalar>& n) noexcept {
      const Vector<3, Scalar>& x = placed.speed_points[i];
      typename Clearance::AllJoints gradients[2];
      placed.set_gradients(n, x, x, clearance.robot().moved_by(bound.body.link), bound.body.is_direction, gradients);
      return clearance.robot().drives().by_drive(gradients[0]);
    };
    Vector<3, Scalar> v = Vector<3, Scalar>::Zero();
    for (int axis = 0; axis < 3; ++axis) {
      if (!bound.rows[static_cast<std::size_t>(axis)]) continue;
      v(axis) = gradient(Vector<3, Scalar>::Unit(axis)).dot(final);
    }
    const Scalar speed = v.norm();
    if (!(speed > bound.most) || rows.count == P) continue;
    const Vector<N, Scalar> row = gradient(v / speed);
    rows.g.col(rows.count) = g * row;
    rows.b(rows.count++) = bound.most - row.dot(constant);
  }
}

}  // namespace fpbm
