#pragma once

#include "fpbm/clearance/clearance.hpp"
#include "fpbm/limits/limits.hpp"
#include "fpbm/limits/rows.hpp"

namespace fpbm {

/// What the tip's velocity along n gains by each joint's, where the clearance is placed: nᵀJ.
template <int N, typename Scalar>
[[nodiscard]] Vector<N, Scalar> tip_row(const Clearance<N, Scalar>& clearance, const Vector<3, Scalar>& n) noexcept {
  const auto& links = clearance.links();
  const auto& frames = clearance.frames();
  const Transform<Scalar>& last = frames[static_cast<std::size_t>(links.count())];
  const Vector<3, Scalar> tip = last.R * clearance.tip() + last.p;
  typename Clearance<N, Scalar>::ChainVector row(links.count());
  for (Eigen::Index k = 0; k < links.count(); ++k) {
    const Transform<Scalar>& frame = frames[static_cast<std::size_t>(k + 1)];
    const Vector<3, Scalar> z = frame.R.col(2);
    row(k) = links.turns(k) ? z.dot(cross(Vector<3, Scalar>(tip - frame.p), n)) : z.dot(n);
  }
  return links.by_drive(row);
}

/// Adds the row n · v ≤ tip_speed() where a tick's motion u would take the tip's velocity v beyond it, with n along v:
/// at the tick's end, or once the acceleration has been let go, which it takes `late` ticks for. So the speed is kept
/// but for what the direction changes in a tick, and for what other rows and the joints' limits leave no room for.
template <Level kLevel, int N, int P, typename Scalar>
void bound_tip_speed(Clearance<N, Scalar>& clearance, const Limits<kLevel, N, Scalar>& limits,
                     const State<N, Scalar>& state, Scalar late, const Vector<N, Scalar>& u,
                     Rows<N, P, Scalar>& rows) noexcept {
  if (!std::isfinite(clearance.tip_speed()) || rows.count == P) return;
  // qd + g u is the velocity then.
  const Scalar h = limits.tick();
  const Scalar g = kLevel == Level::kAcceleration ? late * h : late;
  const Vector<N, Scalar> left = kLevel == Level::kAcceleration ? state.qd : (Scalar(1) - late) * state.qd;
  const Vector<N, Scalar> then = left + g * u;
  clearance.place(state.q + h / Scalar(2) * (state.qd + then));
  Vector<3, Scalar> v;
  for (int axis = 0; axis < 3; ++axis) {
    v(axis) = tip_row(clearance, Vector<3, Scalar>(Vector<3, Scalar>::Unit(axis))).dot(then);
  }
  const Scalar speed = v.norm();
  if (!(speed > clearance.tip_speed())) return;
  const Vector<N, Scalar> row = tip_row(clearance, Vector<3, Scalar>(v / speed));
  rows.g.col(rows.count) = g * row;
  rows.b(rows.count++) = clearance.tip_speed() - row.dot(left);
}

}  // namespace fpbm
